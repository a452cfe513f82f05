# SPDX-License-Identifier: MIT
"""Are many assets baked into one folder, each once, whatever becomes of the others?"""

import functools
import json
import os
import signal
import struct
import subprocess
import time

import command
import gltf_file
from command import BAD_INPUT, DONE, INTERRUPTED, NOT_CONVERGED, OUTPUT, USAGE


class Many(command.CommandCase):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("assets"))
        for name in ("a.glb", "b c.glb"):
            self.write("assets/" + name, gltf_file.room().glb())

    def many(self, *arguments, status=DONE, inputs=("assets/a.glb", "assets/b c.glb")):
        return self.succeed("bake", *inputs, "-o", "out/", "--quality", "draft", *arguments, status=status)

    def counts(self, ran):
        """Of the last line: (baked, unchanged, failed)."""
        words = ran.stdout.splitlines()[-1].replace(",", "").split()
        return tuple(int(words[i]) for i in (0, 2, 4))

    def test_each_is_the_bake_that_it_is_alone(self):
        ran = self.many("--jobs", 2)
        self.assertEqual(self.counts(ran), (2, 0, 0))
        self.assertEqual(len(ran.stdout.splitlines()), 3, ran.stdout)
        self.assertRegex(ran.stdout, r"(?m)^baked     assets/b c\.glb -> out/b c\.glb: error about [\d.]+ %, [\d.]+ kB, [\d.]+ s$")
        self.succeed("bake", "assets/a.glb", "-o", "alone.glb", "--quality", "draft")
        of_many, alone = (gltf_file.Asset(self.path(name)) for name in ("out/a.glb", "alone.glb"))
        self.assertRegex(of_many.json["asset"]["extras"]["hemibake"].pop("input_sha256"), r"\A[0-9a-f]{64}\Z")
        self.assertEqual((of_many.json, of_many.bin), (alone.json, alone.bin))

    def test_what_is_unchanged_is_passed_over(self):
        self.many()
        before = os.stat(self.path("out/a.glb")).st_ino
        os.utime(self.path("assets/a.glb"))
        self.assertEqual(self.counts(self.many("--jobs", 2)), (0, 2, 0))
        self.assertEqual(os.stat(self.path("out/a.glb")).st_ino, before)
        self.assertEqual(self.counts(self.many("--force")), (2, 0, 0))
        self.assertEqual(self.counts(self.many("--exposure", 1)), (2, 0, 0))
        self.assertEqual(self.counts(self.many("--exposure", 1)), (0, 2, 0))
        self.write("assets/a.glb", gltf_file.room(emission=(9, 9, 9)).glb())
        ran = self.many("--exposure", 1)
        self.assertEqual(self.counts(ran), (1, 1, 0))
        self.assertIn("unchanged assets/b c.glb -> out/b c.glb\n", ran.stdout)

    def test_a_pattern_may_be_one_asset(self):
        """What is said for many goes into a folder, though the shell finds one."""
        ran = self.succeed("bake", "assets/a.glb", "-o", "baked", "--quality", "draft", "--jobs", 4)
        self.assertEqual(self.counts(ran), (1, 0, 0))
        self.assertTrue(os.path.exists(self.path("baked/a.glb")))

    def test_files_beside_an_asset_count(self):
        os.mkdir(self.path("two"))
        data = gltf_file.room().glb()
        size = struct.unpack_from("<I", data, 12)[0]
        document, buffer = json.loads(data[20 : 20 + size]), bytearray(data[28 + size :])
        document["buffers"][0]["uri"] = "s%20s.bin"
        self.write("two/s.gltf", json.dumps(document).encode())
        self.write("two/s s.bin", buffer)
        one = functools.partial(self.many, inputs=["two/s.gltf"])
        self.assertEqual([self.counts(one()) for _ in range(2)], [(1, 0, 0), (0, 1, 0)])
        self.write("two/s s.bin", buffer + b"\0")
        self.assertEqual([self.counts(one()) for _ in range(2)], [(1, 0, 0), (0, 1, 0)])
        os.remove(self.path("out/s.bin"))
        self.assertEqual([self.counts(one()) for _ in range(2)], [(1, 0, 0), (0, 1, 0)])

    def test_reports_pictures_and_depfiles_go_into_folders(self):
        self.many("--report", "said/", "--preview", "seen/", "--depfile", "on/", "--size", "8x8", "--jobs", 2)
        self.assertEqual(json.loads(self.read("said/b c.json"))["input"]["path"], "assets/b c.glb")
        self.assertTrue(self.read("seen/a.png").startswith(b"\x89PNG"))
        self.assertTrue(self.read("on/a.d").startswith(b"out/a.glb:"))
        os.remove(self.path("seen/a.png"))
        again = self.many("--report", "said/", "--preview", "seen/", "--depfile", "on/", "--size", "8x8")
        self.assertEqual(self.counts(again), (1, 1, 0))

    def test_one_that_fails_leaves_the_others_baked(self):
        self.write("assets/bad.glb", b"nothing")
        ran = self.many("--jobs", 2, inputs=["assets/a.glb", "assets/bad.glb", "assets/b c.glb", "assets/lost.glb"], status=BAD_INPUT)
        self.assertEqual(self.counts(ran), (2, 0, 2))
        self.assertEqual(sorted(line.split(":")[1] for line in ran.stderr.splitlines()), [" assets/bad.glb", " assets/lost.glb"])
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["a.glb", "b c.glb"])

    def test_what_cannot_be_meant(self):
        os.mkdir(self.path("more"))
        self.write("more/a.gltf", b"{}")
        for status, words, *arguments in (
            (USAGE, "another input has this name too", "assets/a.glb", "more/a.gltf", "-o", "out"),
            (USAGE, "go into a folder", "assets/a.glb", "assets/b c.glb", "-o", "x.glb"),
            (USAGE, "--report names a folder", "assets/a.glb", "assets/b c.glb", "-o", "out", "--report", "r.json"),
            (USAGE, "--layer is of one stage", "assets/a.glb", "-o", "out/", "--layer", "l.usda"),
            (OUTPUT, "Not a directory", "assets/a.glb", "-o", "assets/a.glb/out/"),
        ):
            ran = self.run_hemibake("bake", *arguments)
            self.assertEqual(ran.returncode, status, ran.stderr)
            self.assertIn(words, ran.stderr)
            self.assertEqual(ran.stderr.count("\n"), 1)
        self.assertEqual(self.left(), ["assets", "assets/a.glb", "assets/b c.glb", "more", "more/a.gltf"])
        before = self.read("assets/a.glb")
        ran = self.run_hemibake("bake", "assets/a.glb", "-o", "assets", "--quality", "draft")
        self.assertEqual((ran.returncode, self.read("assets/a.glb")), (BAD_INPUT, before))
        self.assertIn("written onto itself", ran.stderr)

    def test_quiet_says_nothing_and_what_is_stopped_is_said_in_the_status(self):
        ran = self.many("-q")
        self.assertEqual((ran.stdout, ran.stderr), ("", ""))
        ran = self.many("--time", "1e-3", status=NOT_CONVERGED)
        self.assertIn("2 stopped before converged", ran.stdout)

    def test_ctrl_c_reaches_all_and_what_was_begun_is_made_again(self):
        inputs = [f"assets/{i}.glb" for i in range(4)]
        for name in inputs:
            self.write(name, gltf_file.room().glb())
        child = subprocess.Popen([command.HEMIBAKE, "bake", *inputs, "-o", "out", "--quality", "reference", "--element-size", "0.004", "--jobs", "2"],
                                 cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
        time.sleep(1.0)
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=command.PATIENCE_S)
        self.assertEqual(child.returncode, INTERRUPTED, out + err)
        self.assertRegex(out.splitlines()[-1], r"not begun")
        self.assertFalse([name for name in os.listdir(self.path("out")) if name.startswith(".hemibake")])
        for name in os.listdir(self.path("out")):
            self.assertNotIn("input_sha256", gltf_file.Asset(self.path("out/" + name)).json["asset"]["extras"]["hemibake"])


if __name__ == "__main__":
    command.main()
