# SPDX-License-Identifier: MIT
"""Do processes that mpirun starts share a bake? One, two and four of them write the bytes that one alone does, once; what fails says so
once, whoever of them it was.

Needs Open MPI, and the command linked with it, which the build makes where that is; skipped without them.
"""

import json
import os
import subprocess
import time
import unittest

import command
import gltf_file

BY_MPI, MPIRUN = os.environ.get("HEMIBAKE_BY_MPI"), os.environ.get("HEMIBAKE_MPIRUN")


def is_open_mpi():
    if not BY_MPI or not MPIRUN or not os.path.exists(BY_MPI):
        return False
    said = subprocess.run([MPIRUN, "--version"], capture_output=True, text=True)
    return "Open" in said.stdout + said.stderr


@unittest.skipUnless(is_open_mpi(), "needs Open MPI: apt-get install libopenmpi-dev openmpi-bin, and a build that found it")
class Processes(command.CommandCase):
    def share(self, count, *arguments, of_each=()):
        """of_each: arguments of each process, where they differ."""
        # Four on two cores, as whoever is logged in here.
        environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                           OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_btl_vader_single_copy_mechanism="none",
                           OMPI_MCA_mpi_yield_when_idle="1")
        # Quiet: what mpirun says of its own comes into the middle of lines.
        command_line = [MPIRUN, "--quiet", "--bind-to", "none"]
        for i, own in enumerate(of_each or [()]):
            command_line += [":"] if i else []
            command_line += ["-n", "1" if of_each else str(count), BY_MPI, *map(str, arguments), *map(str, own)]
        return subprocess.run(command_line, cwd=self.folder, env=environment, capture_output=True, text=True,
                              timeout=command.PATIENCE_S)

    def test_one_two_and_four_write_what_one_alone_does(self):
        scene = os.path.join(command.ROOT, "tests/accuracy/truth/cornell-box.glb")
        options = ("--method", "rows", "--quality", "draft", "--element-size", "0.15", "--threads", "1")
        self.bake(scene, "alone.glb", *options)
        for count in (1, 2, 4):
            ran = self.share(count, "bake", scene, "-o", f"{count}.glb", *options, "--report", f"{count}.json")
            self.assertEqual(ran.returncode, command.DONE, ran.stderr)
            self.assertEqual(self.read(f"{count}.glb"), self.read("alone.glb"), f"{count} processes")
            self.assertEqual(ran.stdout.count(f"{count}.glb"), 1, ran.stdout)
            self.assertEqual(json.loads(self.read(f"{count}.json"))["solver"]["processes"], count)
            self.assertFalse([name for name in self.left() if "part" in name])

    def test_bad_input_is_one_line(self):
        self.write("bad.glb", b"nothing")
        ran = self.share(2, "bake", "bad.glb", "-o", "out.glb")
        self.assertEqual(ran.returncode, command.BAD_INPUT, ran.stderr)
        self.assertEqual(ran.stderr.count("hemibake: bad.glb"), 1, ran.stderr)
        self.assertNotIn("out.glb", self.left())

    def test_one_that_fails_alone_says_so_and_nobody_waits(self):
        self.write("good.glb", gltf_file.room().glb())
        begin = time.monotonic()
        ran = self.share(2, "bake", "--method", "rows", "--quality", "draft",
                         of_each=[("good.glb", "-o", "out.glb"), ("missing.glb", "-o", "out.glb")])
        self.assertNotEqual(ran.returncode, command.DONE)
        self.assertIn("process 1: hemibake: missing.glb", ran.stderr)
        self.assertNotIn("out.glb", self.left())
        self.assertLess(time.monotonic() - begin, command.PATIENCE_S)

    def test_what_cannot_be_shared_is_refused(self):
        self.write("good.glb", gltf_file.room().glb())
        for more in (("--time", "5"), ("--checkpoint", "kept")):
            ran = self.share(2, "bake", "good.glb", "-o", "out.glb", *more)
            self.assertEqual(ran.returncode, command.USAGE, ran.stderr)
            self.assertEqual(ran.stderr.count("processes that share a bake"), 1, ran.stderr)


if __name__ == "__main__":
    command.main()
