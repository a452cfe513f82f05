# SPDX-License-Identifier: MIT
"""Does the command line forgive what people type, and never take a guess for what they mean?"""

import json
import re
import shutil
import subprocess
import unittest

import command
import gltf_file
from command import DONE, USAGE


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
                             (["bake", "--qualty=draft"], "--quality"), (["bake", "--no-darco"], "--no-draco"), (["help", "expsure"], "exposure")):
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

    def test_bash_completes_commands_options_and_words(self):
        if not shutil.which("bash"):
            self.skipTest("no bash")
        def completed(*words):
            script = ('source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _hemibake; printf "%s\\n" "${COMPREPLY[@]}"')
            return subprocess.run(["bash", "-c", script, command.ROOT + "/plugin/hosts/cli/hemibake.bash", *words], cwd=self.folder,
                                  capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(completed("hemibake", "ba"), ["bake"])
        self.assertEqual(completed("hemibake", "bake", "room.glb", "--qual"), ["--quality"])
        self.assertEqual(completed("hemibake", "bake", "--quality", ""), ["draft", "medium", "high", "reference"])
        self.assertEqual(completed("hemibake", "bake", "roo"), ["room.glb"])
        options = {option["name"] for option in json.loads(self.succeed("help", "--json").stdout)["commands"]["bake"]["options"]}
        self.assertEqual(set(completed("hemibake", "bake", "-")) - {"--help"}, options)


if __name__ == "__main__":
    command.main()
