# SPDX-License-Identifier: MIT
"""Does the command line forgive what people type, and never take a guess for what they mean?"""

import fcntl
import json
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import termios
import unittest

import command
import gltf_file
from command import BAD_INPUT, DONE, USAGE


class Words(command.CommandCase):
    def refused(self, *arguments):
        ran = self.run_hemibake(*arguments)
        self.assertEqual(ran.returncode, USAGE, ran.stderr)
        self.assertRegex(ran.stderr, r"\Ahemibake: [^\n]+\n\Z")
        return ran.stderr

    def setUp(self):
        super().setUp()
        self.write("room.glb", gltf_file.room().glb())

    def test_what_was_meant_is_asked(self):
        for typed, meant in ((["bak"], "bake"), (["rendre"], "render"), (["bake", "--qualty", "draft"], "--quality"),
                             (["bake", "--qualty=draft"], "--quality"), (["bake", "--no-darco"], "--no-draco"), (["help", "expsure"], "exposure"),
                             (["--hlep"], "--help"), (["hlep"], "help"), (["--verison"], "--version")):
            self.assertIn(f"(did you mean '{meant}'?)", self.refused(*typed))
        for typed in (["frobnicate"], ["bake", "--frobnicate"], ["bake", "-z"], ["help", "frobnicate"], ["x" * 5000], ["bake", "--" + "y" * 5000]):
            self.assertNotIn("did you mean", self.refused(*typed))
        self.assertIn("'hemibake bake room.glb -o OUT' bakes a file", self.refused("room.glb"))

    def test_names_that_other_programs_have(self):
        ran = self.succeed("bake", "room.glb", "--output", "a.glb", "-q", "--quality", "draft")
        self.assertEqual((ran.stdout, ran.stderr), ("", ""))
        self.succeed("bake", "room.glb", "--output=b.glb", "--quiet", "--quality=draft")
        self.assertEqual(self.read("a.glb"), self.read("b.glb"))
        self.assertEqual(self.succeed("-V").stdout, self.succeed("--version").stdout)

    def test_shares_as_percentages_and_times_with_their_unit(self):
        self.succeed("bake", "room.glb", "-o", "a.glb", "-q", "--quality", "draft", "--unshot", "0.5%", "--time", "2m")
        self.succeed("bake", "room.glb", "-o", "b.glb", "-q", "--quality", "draft", "--unshot", "0.005", "--time", "120")
        a, b = (gltf_file.Asset(self.path(name)) for name in ("a.glb", "b.glb"))
        self.assertEqual(a.bin, b.bin)
        for option, value in (("--error", "500%"), ("--error", "5 %"), ("--error", "%"), ("--error", "5%%"), ("--time", "10x"), ("--time", "s"), ("--time", "1hs"),
                              ("--element-size", "5%"), ("--threads", "50%"), ("--time", "10%")):
            self.assertIn(f"{option}: '{value}' is not what it takes", self.refused("bake", "room.glb", "-o", "c.glb", option, value))

    def test_help_about_a_command_or_an_option(self):
        self.assertEqual(self.succeed("help", "bake").stdout, self.succeed("bake", "--help").stdout)
        for word in ("quality", "--quality"):
            told = self.succeed("help", word).stdout
            self.assertIn("draft|medium|high|reference", told)
            self.assertIn("hemibake bake;", told)

    def test_the_input_is_not_written_over_unless_that_is_said(self):
        before = self.read("room.glb")
        for name in ("room.glb", "./room.glb"):
            self.assertIn("is the input itself", self.refused("bake", "room.glb", "-o", name))
        self.assertEqual(self.read("room.glb"), before)
        self.succeed("bake", "room.glb", "-o", "room.glb", "--force", "--quality", "draft")
        self.assertNotEqual(self.read("room.glb"), before)

    def test_sizes_of_columns_are_said_to_choose_them(self):
        def said(*arguments):
            ran = self.bake("room.glb", "out.glb", "--quality", "draft", "--report", "out.json", *arguments)
            with open(self.path("out.json")) as f:
                report = json.load(f)
            lines = [line for line in ran.stderr.splitlines() if "--method rows" in line]
            self.assertEqual(len(lines), sum("--method rows" in line for line in report["warnings"]))
            return report["solver"]["method"], lines

        sky = ("--environment", "1,1,1")
        method, lines = said(*sky)
        if method != "rows":
            self.skipTest("this build has no rays")
        self.assertEqual(lines, [])
        for asked in (("--uniform",), ("--patch-size", "0.5"), ("--hemicube", "64")):
            method, (line,) = said(*sky, *asked)
            self.assertEqual(method, "hybrid")
            self.assertIn(f"{asked[0]} is for columns", line)
            self.assertEqual(said(*sky, *asked, "--method", "hybrid")[1], [], "who asks for columns knows")
        self.assertEqual(said("--uniform")[1], [], "a room by its lamp is solved by columns anyway")

    def test_a_preview_is_what_its_name_says(self):
        for name, magic in (("p.png", b"\x89PNG"), ("p.jpg", b"\xff\xd8\xff"), ("p.JPEG", b"\xff\xd8\xff")):
            self.bake("room.glb", "out.glb", "--quality", "draft", "--preview", name)
            self.assertTrue(self.read(name).startswith(magic))
        self.succeed("render", "out.glb", "-o", "r.jpg")
        self.assertTrue(self.read("r.jpg").startswith(b"\xff\xd8\xff"))

    def test_help_about_quality_says_what_each_gives_and_costs(self):
        told = self.succeed("help", "quality").stdout
        figures = re.findall(r"^ +([\w-]+) +(draft|medium|high) +(\d+) +([\d.]+) % +([\d.]+) +(\d+) MiB +(\d+) kB$", told, re.M)
        self.assertEqual(len({one[0] for one in figures}), 3, told)
        for scene in {one[0] for one in figures}:
            own = [one for one in figures if one[0] == scene]
            self.assertEqual([one[1] for one in own], ["draft", "medium", "high"])
            errors, seconds = ([float(one[k]) for one in own] for k in (3, 4))
            self.assertEqual((errors, seconds), (sorted(errors, reverse=True), sorted(seconds)), "more time, less error")
        self.assertNotIn("MiB", self.succeed("help", "exposure").stdout)

    def test_the_times_that_the_summary_names_are_all_of_the_total(self):
        told = self.bake("room.glb", "out.glb", "--quality", "draft", "--preview", "p.png").stdout
        total, parts = re.search(r"^time +([\d.]+) s: (.*?);", told, re.M).groups()
        named = {name: float(seconds) for name, seconds in re.findall(r"(\w[\w ]*?) ([\d.]+)", parts)}
        self.assertEqual(list(named), ["reading", "mesh", "light", "form factors", "solving", "refining", "fitting", "colour", "writing",
                                       "pictures", "the rest"])
        self.assertAlmostEqual(sum(named.values()), float(total), delta=0.01 * len(named), msg="each is rounded to 0.01")
        self.assertGreater(named["pictures"], 0, "the preview")

    def at_a_prompt(self, shell, begin, *typed):
        """Which arguments `hemibake` gets of each line, typed in a shell of its own at a terminal, of which \\t is the key Tab."""
        lead, follow = pty.openpty()
        fcntl.ioctl(follow, termios.TIOCSWINSZ, struct.pack("HHHH", 50, 200, 0, 0))
        environment = {**os.environ, "PS1": "", "TERM": "dumb", "HOME": self.folder, "HISTFILE": ""}
        began = "stty -echo\n" + begin + '\nhemibake() { printf "<"; printf "%s|" "$@"; printf ">\\n"; }\necho ready\n'
        self.write("begin.sh", began.encode())
        with subprocess.Popen(shell, cwd=self.folder, env=environment, stdin=follow, stdout=follow, stderr=follow, start_new_session=True) as ran:
            try:
                os.close(follow)
                os.write(lead, b". ./begin.sh\n")
                self.read_until(lead, rb"ready\r?\n")
                said = []
                for line in typed:
                    os.write(lead, ("hemibake " + line + "\n").encode())
                    said.append(self.read_until(lead, rb"<([^<>]*)\|>").decode().split("|"))
                return said
            finally:
                ran.kill()
                os.close(lead)

    def read_until(self, terminal, pattern):
        said, patience = b"", 60
        while not (found := re.search(pattern, said)):
            if not select.select([terminal], [], [], patience)[0]:
                self.fail(f"the shell says no more than {said!r}")
            said += os.read(terminal, 65536)
        return found[found.re.groups]

    # What is typed, and what it becomes.
    TYPED = (("ba\troom.g\t", ["bake", "room.glb"]), ("bake room.glb --qual\tdr\t", ["bake", "room.glb", "--quality", "draft"]),
             ("bake --quality=me\troom.g\t", ["bake", "--quality=medium", "room.glb"]), ("bake --exposure au\troom.g\t", ["bake", "--exposure", "auto", "room.glb"]),
             ("bake two\t", ["bake", "two words.glb"]), ("bake --error ro\t", ["bake", "--error", "ro"]), ("view --bef\troom.g\t", ["view", "--before", "room.glb"]),
             ("render --turn\t3", ["render", "--turntable", "3"]), ("hel\tmerg\t", ["help", "merge-error"]))

    def test_bash_completes_commands_options_words_and_files(self):
        if not shutil.which("bash"):
            self.skipTest("no bash")
        self.write("two words.glb", b"")
        begin = f". {command.ROOT}/plugin/hosts/cli/hemibake.bash\nbind 'set enable-bracketed-paste off'"
        said = self.at_a_prompt(["bash", "--norc", "--noprofile", "-i"], begin, *(typed for typed, _ in self.TYPED))
        self.assertEqual(said, [becomes for _, becomes in self.TYPED])

    def test_zsh_completes_commands_options_words_and_files(self):
        if not shutil.which("zsh"):
            self.skipTest("no zsh (apt install zsh)")
        self.write("two words.glb", b"")
        begin = (f"fpath=({command.ROOT}/plugin/hosts/cli $fpath)\nautoload -U compinit\ncompinit -u -D\nunsetopt beep\n"
                 "unsetopt zle_bracketed_paste 2>/dev/null; unset zle_bracketed_paste\nPROMPT= PROMPT_EOL_MARK=")
        said = self.at_a_prompt(["zsh", "-f", "-i"], begin, *(typed for typed, _ in self.TYPED))
        # Zsh writes --quality=draft, which is two words as well.
        self.assertEqual(*([re.split("[=|]", "|".join(words)) for words in lines] for lines in (said, [becomes for _, becomes in self.TYPED])))

    def test_bash_completes_every_option(self):
        if not shutil.which("bash"):
            self.skipTest("no bash")
        def completed(*words):
            script = ('source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _hemibake; printf "%s\\n" "${COMPREPLY[@]}"')
            return subprocess.run(["bash", "-c", script, command.ROOT + "/plugin/hosts/cli/hemibake.bash", *words], cwd=self.folder,
                                  capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(completed("hemibake", "bake", "--quality", ""), ["draft", "medium", "high", "reference"])
        for name, each in json.loads(self.succeed("help", "--json").stdout)["commands"].items():
            options = {option["name"] for option in each["options"]}
            self.assertEqual(set(completed("hemibake", name, "-")) - {"--help", "--output", "-q"}, options)

    def test_a_line_on_stderr_leaves_in_one_piece(self):
        """A pipe of packets keeps apart what was written apart."""
        read, write = os.pipe2(os.O_DIRECT)
        with os.fdopen(read, "rb", 0) as packets:
            with os.fdopen(write, "wb", 0) as stderr:
                ran = subprocess.run([command.HEMIBAKE, "bake", "none.glb", "-o", "out.glb"], cwd=self.folder, stderr=stderr, check=False)
            self.assertEqual(ran.returncode, BAD_INPUT)
            self.assertRegex(packets.read(65536), rb"\Ahemibake: none\.glb: [^\n]+\n\Z")
            self.assertEqual(packets.read(65536), b"")


if __name__ == "__main__":
    command.main()
