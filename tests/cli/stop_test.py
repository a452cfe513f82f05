# SPDX-License-Identifier: MIT
"""What does a bake leave that was stopped before it converged? A whole output that says so."""

import json
import os
import shutil
import signal
import subprocess

import command
import gltf_file
from command import DONE, INTERRUPTED, NOT_CONVERGED


class Stop(command.CommandCase):
    # Fine enough that no machine finishes before it is stopped.
    ENDLESS = ("--element-size", "0.02", "--patch-size", "0.05", "--unshot", "1e-8", "--report", "out.json", "--preview",
               "out.png", "--size", "64x48")

    def setUp(self):
        super().setUp()
        shutil.copy(os.path.join(command.SAMPLES, "pillar-room.glb"), self.path("room.glb"))

    def check_outputs(self):
        """The asset, the report and the picture are whole; the report says that it did not converge."""
        self.assertEqual(self.left(), ["out.glb", "out.json", "out.png", "room.glb"])
        asset = gltf_file.Asset(self.path("out.glb"))
        self.assertIn("COLOR_0", asset.primitives("floor")[0]["attributes"])
        report = json.loads(self.read("out.json"))
        self.assertIs(report["solver"]["converged"], False)
        self.assertGreater(report["solver"]["unshot_fraction"], 0.0)
        self.assertLess(abs(report["energy"]["residual_fraction"]), 1e-9)
        self.succeed("render", "out.glb", "-o", "again.png", "--size", "64x48")

    def test_time_ends_with_4_and_an_output(self):
        ran = self.bake("room.glb", "out.glb", "--time", "0.01", *self.ENDLESS, status=NOT_CONVERGED)
        self.assertIn("before it converged", ran.stdout)
        self.check_outputs()

    def test_time_that_is_never_reached_changes_nothing(self):
        self.bake("room.glb", "free.glb", "--quality", "draft")
        self.bake("room.glb", "timed.glb", "--quality", "draft", "--time", "10000")
        self.assertEqual(self.read("free.glb"), self.read("timed.glb"))

    def test_an_interrupt_ends_with_130_and_an_output(self):
        bake = subprocess.Popen(
            [command.HEMIBAKE, "bake", "room.glb", "-o", "out.glb", "--progress", "json", *self.ENDLESS],
            cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(bake.kill)
        first = bake.stderr.readline()
        self.assertIn("fraction", json.loads(first))
        bake.send_signal(signal.SIGINT)
        out, err = bake.communicate(timeout=command.PATIENCE_S)
        self.check_sanitizers(err)
        self.assertEqual(bake.returncode, INTERRUPTED, err)
        self.assertIn("before it converged", out)
        self.check_outputs()

    def test_a_termination_ends_with_143_and_leaves_nothing(self):
        bake = subprocess.Popen(
            [command.HEMIBAKE, "bake", "room.glb", "-o", "out.glb", "--progress", "json", *self.ENDLESS],
            cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(bake.kill)
        bake.stderr.readline()
        bake.send_signal(signal.SIGTERM)
        out, err = bake.communicate(timeout=command.PATIENCE_S)
        self.check_sanitizers(err)
        self.assertEqual(bake.returncode, 143, err)
        self.assertEqual([line for line in err.splitlines() if not line.startswith("{")],
                         ["hemibake: room.glb: stopped from outside (SIGTERM); nothing is written"])
        self.assertEqual((out, self.left()), ("", ["room.glb"]))

    def test_a_second_interrupt_ends_at_once(self):
        """Without an output; what was begun may stay."""
        bake = subprocess.Popen(
            [command.HEMIBAKE, "bake", "room.glb", "-o", "out.glb", "--progress", "json", *self.ENDLESS],
            cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(bake.kill)
        bake.stderr.readline()
        for _ in range(1000):
            bake.send_signal(signal.SIGINT)
            try:
                bake.wait(timeout=0.02)
                break
            except subprocess.TimeoutExpired:
                pass
        bake.stderr.close()
        self.assertIn(bake.wait(timeout=command.PATIENCE_S), (-signal.SIGINT, INTERRUPTED))

    def test_a_loose_target_converges_sooner(self):
        shots = []
        for target in ("0.5", "0.01"):
            self.bake("room.glb", "out.glb", "--quality", "draft", "--unshot", target, "--report", "out.json", status=DONE)
            report = json.loads(self.read("out.json"))
            self.assertLessEqual(report["solver"]["unshot_fraction"], float(target))
            shots.append(report["solver"]["shots"])
        self.assertLess(shots[0], shots[1])

    def test_an_error_target_stops_below_it_and_sooner(self):
        unshot = []
        for target in ((), ("--error", "0.2")):
            self.bake("room.glb", "out.glb", "--quality", "draft", *target, "--report", "out.json", status=DONE)
            report = json.loads(self.read("out.json"))
            self.assertLessEqual(report["error"]["estimate"], 0.2)
            unshot.append(report["solver"]["unshot_fraction"])
        self.assertLess(unshot[0], unshot[1])

    def test_an_error_target_that_is_not_met_is_not_called_converged(self):
        """Draft elements alone are farther off than a thousandth."""
        ran = self.run_hemibake("bake", "room.glb", "-o", "out.glb", "--quality", "draft", "--error", "0.001", "--report", "out.json")
        report = json.loads(self.read("out.json"))
        self.assertGreater(report["error"]["estimate"], 0.001)
        self.assertIs(report["solver"]["converged"], False)
        self.assertEqual(ran.returncode, NOT_CONVERGED, ran.stdout)


if __name__ == "__main__":
    command.main()
