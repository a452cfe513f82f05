# SPDX-License-Identifier: MIT
"""Does a bake that was killed go on to the same bytes, and with nothing that is of another bake?"""

import os
import resource
import shutil
import signal
import subprocess
import time

import command
import gltf_file
from command import BAD_INPUT, DONE, INTERRUPTED, USAGE

QUICK = ("--quality", "draft", "--element-size", "0.3")


class Checkpoint(command.CommandCase):
    def setUp(self):
        super().setUp()
        self.write("room.glb", gltf_file.room().glb())

    def start(self, *arguments, **more):
        return subprocess.Popen([command.HEMIBAKE, "bake", "room.glb", "-o", "out.glb", "--quiet", *arguments], cwd=self.folder,
                                stderr=subprocess.PIPE, text=True, **more)

    def kill_at(self, size, *arguments, by=signal.SIGKILL):
        """Ends a bake as soon as its checkpoint is so large; its status."""
        process = self.start("--checkpoint", "kept", *arguments)
        while process.poll() is None and not (os.path.exists(self.path("kept")) and os.path.getsize(self.path("kept")) > size):
            time.sleep(0.005)
        process.send_signal(by)
        process.communicate()
        return process.returncode

    def fail_to_resume(self, *arguments, said, status=BAD_INPUT, room="room.glb"):
        ran = self.run_hemibake("bake", room, "-o", "out.glb", *arguments)
        self.assertEqual(ran.returncode, status, ran.stderr)
        self.assertEqual(ran.stderr.count("\n"), 1, ran.stderr)
        self.assertIn(said, ran.stderr)
        self.assertFalse(os.path.exists(self.path("out.glb")))

    def test_what_was_killed_anywhere_goes_on_to_the_same_bytes_by_either_road(self):
        for method in ("hybrid", "rows"):
            options = (*QUICK, "--method", method)
            self.bake("room.glb", "whole.glb", *options)
            for size in (600, 50_000, 500_000):
                self.kill_at(size, *options)
                kept = os.path.getsize(self.path("kept")) if os.path.exists(self.path("kept")) else 0
                self.assertGreater(kept, size, "it ended before it was killed")
                self.bake("room.glb", "out.glb", "--resume", "kept", "--threads", "1", *options)
                self.assertEqual(self.read("out.glb"), self.read("whole.glb"), f"{method}, {size}")
                self.assertNotIn("kept", self.left())

    def test_lights_without_size_and_a_sky_too(self):
        options = (*QUICK, "--method", "hybrid", "--sun", "150,40,80000", "--environment", "1,1,2")
        self.bake("room.glb", "whole.glb", *options)
        self.kill_at(50_000, *options)
        self.bake("room.glb", "out.glb", "--resume", "kept", *options)
        self.assertEqual(self.read("out.glb"), self.read("whole.glb"))

    def test_results_are_found_and_not_worked_out_again(self):
        self.kill_at(300_000, *QUICK, "--method", "rows")
        before = self.read("kept")
        process = self.start("--resume", "kept", *QUICK, "--method", "rows")
        while process.poll() is None and os.path.getsize(self.path("kept")) < len(before) + 1000:
            time.sleep(0.005)
        process.kill()
        process.communicate()
        # The same results once more would stand behind them.
        again = self.read("kept")
        self.assertEqual(again[: len(before) - 200_000], before[:-200_000])

    def test_signals_leave_what_was_found(self):
        self.bake("room.glb", "whole.glb", *QUICK, "--method", "rows")
        for number, status in ((signal.SIGTERM, 143), (signal.SIGINT, INTERRUPTED)):
            self.assertEqual(self.kill_at(1_000_000, *QUICK, "--method", "rows", by=number), status)
            self.bake("room.glb", "out.glb", "--resume", "kept", *QUICK, "--method", "rows")
            self.assertEqual(self.read("out.glb"), self.read("whole.glb"))

    # ---- what is refused -------------------------------------------------------------------------------------------

    def test_another_input_other_options_and_damage_are_refused_with_a_line(self):
        self.kill_at(300_000, *QUICK)
        kept = self.read("kept")
        self.fail_to_resume("--resume", "kept", "--quality", "high", said="other options: there --quality draft, here")
        self.fail_to_resume("--resume", "kept", *QUICK, "--memory", "1000", said="here --memory 1000")
        shutil.copy(os.path.join(command.SAMPLES, "pillar-room.glb"), self.path("room.glb"))
        self.fail_to_resume("--resume", "kept", *QUICK, said="is of another input")
        self.write("room.glb", gltf_file.room().glb())
        for at in (0, 9, 40, 300, len(kept) // 2):
            damaged = bytearray(kept)
            damaged[at] ^= 4
            self.write("kept", damaged)
            said = "is no checkpoint" if at < 8 else "damaged" if at != 40 else "kept"
            self.fail_to_resume("--resume", "kept", *QUICK, said=said)
        self.write("kept", kept[:3])
        self.fail_to_resume("--resume", "kept", *QUICK, said="is no checkpoint")
        self.fail_to_resume("--resume", "lost", *QUICK, said="lost: No such file")
        os.mkfifo(self.path("fifo"))
        self.fail_to_resume("--resume", "fifo", *QUICK, said="is no plain file")

    def test_another_table_of_a_configuration_is_another_input(self):
        with open(os.path.join(command.ROOT, "color", "hemibake.ocio"), "rb") as f:
            look = b"looks:\n  - !<Look> {name: l, process_space: scene_linear, transform: !<FileTransform> {src: t.cube}}\n"
            self.write("c.ocio", f.read().replace(b'search_path: ""', b"search_path: .") + look)
        table = b"LUT_1D_SIZE 2\n0 0 0\n1 1 1\n"
        self.write("t.cube", table)
        self.kill_at(50_000, *QUICK, "--ocio", "c.ocio")
        self.write("t.cube", table.replace(b"1 1 1", b"1 1 0"))
        self.fail_to_resume("--resume", "kept", *QUICK, "--ocio", "c.ocio", said="is of another input")
        self.write("t.cube", table)
        self.bake("room.glb", "out.glb", "--resume", "kept", *QUICK, "--ocio", "c.ocio")

    def test_another_version_is_refused(self):
        self.kill_at(50_000, *QUICK)
        shutil.copy(command.HEMIBAKE, self.path("another"))
        with open(self.path("another"), "ab") as program:
            program.write(b"changed")
        ran = subprocess.run([self.path("another"), "bake", "room.glb", "-o", "out.glb", *QUICK, "--resume", "kept"], cwd=self.folder,
                             capture_output=True, text=True, check=False)
        self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
        self.assertRegex(ran.stderr, r"\Ahemibake: kept: is of another version, [^\n]*\n\Z")

    def test_nothing_of_others_is_written_over(self):
        self.write("precious", b"not a checkpoint")
        self.fail_to_resume("--checkpoint", "precious", *QUICK, said="is not written over")
        self.assertEqual(self.read("precious"), b"not a checkpoint")
        self.fail_to_resume("--checkpoint", "room.glb", *QUICK, said="a file of its own", status=USAGE)
        self.fail_to_resume("--checkpoint", "a", "--resume", "b", *QUICK, said="the file that --resume names", status=USAGE)

    def test_the_clock_and_several_assets_are_refused(self):
        self.fail_to_resume("--checkpoint", "kept", "--time", "5", said="leave out '--time'", status=USAGE)
        ran = self.run_hemibake("bake", "room.glb", "-o", "folder/", "--checkpoint", "kept")
        self.assertEqual(ran.returncode, USAGE)
        self.assertIn("a checkpoint is of one bake", ran.stderr)

    def test_a_checkpoint_that_is_full_is_no_reason_to_stop(self):
        """The disk, as it were: no file may become larger than this."""
        most = 3 << 19
        self.bake("room.glb", "whole.glb", *QUICK, "--method", "rows")
        process = self.start("--checkpoint", "kept", *QUICK, "--method", "rows",
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
        while process.poll() is None and not (os.path.exists(self.path("kept")) and os.path.getsize(self.path("kept")) > most // 4):
            time.sleep(0.005)
        process.kill()
        process.communicate()
        if process.returncode == DONE:  # it was faster than the file grew, which goes then
            self.assertEqual(self.read("out.glb"), self.read("whole.glb"))
            return
        self.assertLessEqual(os.path.getsize(self.path("kept")), most)
        self.bake("room.glb", "out.glb", "--resume", "kept", *QUICK, "--method", "rows")
        self.assertEqual(self.read("out.glb"), self.read("whole.glb"))


if __name__ == "__main__":
    command.main()
