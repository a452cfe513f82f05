# SPDX-License-Identifier: MIT
"""What does a bake leave that was stopped before it converged? A whole output that says so."""

import json
import os
import shutil
import signal
import subprocess
import time

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

    def test_a_mesh_that_time_is_too_short_for_is_made_as_it_comes(self):
        """Boxes by the thousand, each half in the next: nobody looks for that with 0.1 s for all, which is said, and the light is there."""
        scene = gltf_file.room()
        at, of = [], []
        for i in range(1000):
            x, z = 0.06 * (i % 40) - 1.2, 0.1 * (i // 40) - 1.2
            points, faces = gltf_file.box((x, 0.2, z), (x + 0.09, 0.3, z + 0.05))
            of += [tuple(k + len(at) for k in face) for face in faces]
            at += points
        scene.add_mesh("boxes", (at, of), 0)
        self.write("boxes.glb", scene.glb())
        crossing, said = {}, {}
        for seconds, status in (("1000", DONE), ("0.1", NOT_CONVERGED)):
            ran = self.bake("boxes.glb", "out.glb", "--quality", "draft", "--method", "rows", "--time", seconds, "--report", "out.json",
                            status=status)
            report = json.loads(self.read("out.json"))
            crossing[seconds] = report["scene"]["crossing_surfaces"]
            said[seconds] = [line for line in report["warnings"] if "more than there is time for" in line]
            self.assertEqual("more than there is time for" in ran.stderr, bool(said[seconds]))
        self.assertGreater(crossing["1000"], 100)
        self.assertEqual((crossing["0.1"], said["1000"], len(said["0.1"])), (0, [], 1))
        self.assertIn("COLOR_0", gltf_file.Asset(self.path("out.glb")).primitives("boxes")[0]["attributes"])

    # ---- from outside ----------------------------------------------------------------------------------------------

    # Soon good, not converged for long, and small enough to be written within the second that an interrupt leaves a busy machine.
    LONG = ("--element-size", "0.15", "--patch-size", "0.25", "--unshot", "1e-9", *ENDLESS[6:])

    def start(self, *more, sizes=ENDLESS, **popen):
        """A bake that no machine finishes before it is stopped; its progress is JSON on stderr."""
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **popen}
        bake = subprocess.Popen([command.HEMIBAKE, "bake", "room.glb", "-o", "out.glb", "--progress", "json", *sizes, *more],
                                cwd=self.folder, text=True, **streams)
        self.addCleanup(bake.wait)
        self.addCleanup(bake.kill)
        return bake

    def wait_for(self, bake, is_reached):
        for line in bake.stderr:
            if is_reached(json.loads(line)):
                return
        self.fail("the bake ended by itself")

    def end(self, bake):
        """What it printed but for its progress."""
        out, err = bake.communicate(timeout=command.PATIENCE_S)
        self.check_sanitizers(err or "")
        return out, [line for line in (err or "").splitlines() if not line.startswith("{")]

    def test_an_interrupt_of_a_good_answer_ends_with_130_and_an_output(self):
        bake = self.start(sizes=self.LONG)
        self.wait_for(bake, lambda p: p["unshot_fraction"] < 0.05)
        bake.send_signal(signal.SIGINT)
        out, said = self.end(bake)
        self.assertEqual(bake.returncode, INTERRUPTED, said)
        self.assertIn("interrupted before it converged", out)
        self.check_outputs()
        report = json.loads(self.read("out.json"))
        self.assertIs(report["solver"]["interrupted"], True)
        self.assertLessEqual(report["error"]["estimate"], 0.25)

    def interrupt_in_refinement(self):
        """Of rows, which have an answer from then on; and 0.6 s go by in which nothing can be done. Its status."""
        bake = self.start("--method", "rows", "--refine-levels", "8", "--refine-error", "1e-6", sizes=("--element-size", "0.3"))
        self.wait_for(bake, lambda p: p["stage"] == "refine")
        bake.send_signal(signal.SIGINT)
        time.sleep(0.01)  # until it is taken
        bake.send_signal(signal.SIGSTOP)
        time.sleep(0.6)
        bake.send_signal(signal.SIGCONT)
        self.end(bake)
        return bake.returncode

    def test_an_interrupt_of_refinement_leaves_time_for_what_rows_know(self):
        """A busy machine may take the rest of the second, but hardly so often."""
        for _ in range(8):
            self.assertEqual(self.interrupt_in_refinement(), INTERRUPTED)
            if "out.glb" in self.left():
                return
        self.fail("no answer was waited for")

    def test_an_interrupt_of_a_poor_answer_leaves_the_old_output(self):
        for name in ("out.glb", "out.json", "out.png"):
            self.write(name, b"good and old")
        bake = self.start()
        self.wait_for(bake, lambda p: True)
        bake.send_signal(signal.SIGINT)
        out, said = self.end(bake)
        self.assertEqual((bake.returncode, out), (INTERRUPTED, ""), said)
        self.assertEqual(len(said), 1, said)
        self.assertRegex(said[0], r"\Ahemibake: room\.glb: interrupted; nothing is written")
        self.assertEqual(self.left(), ["out.glb", "out.json", "out.png", "room.glb"])
        for name in ("out.glb", "out.json", "out.png"):
            self.assertEqual(self.read(name), b"good and old")

    def test_converged_is_never_said_after_an_interrupt(self):
        """Whenever it comes: written with 130 it is interrupted and did not converge, with 0 it came too late."""
        for wait in (0.0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.2):
            bake = subprocess.Popen([command.HEMIBAKE, "bake", "room.glb", "-o", "out.glb", "--quality", "draft", "--report", "out.json"],
                                    cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.addCleanup(bake.kill)
            try:
                bake.wait(timeout=0.02 + wait)
            except subprocess.TimeoutExpired:
                bake.send_signal(signal.SIGINT)
            self.end(bake)
            self.assertIn(bake.returncode, (DONE, INTERRUPTED, -signal.SIGINT))
            self.assertEqual("out.glb" in self.left(), "out.json" in self.left())
            if "out.json" not in self.left():
                continue
            solver = json.loads(self.read("out.json"))["solver"]
            self.assertIs(solver.get("interrupted", False), bake.returncode == INTERRUPTED)
            self.assertIs(solver["converged"], bake.returncode == DONE)
            os.remove(self.path("out.json"))
            os.remove(self.path("out.glb"))

    SIGNALS = {"SIGTERM": 143, "SIGHUP": 129, "SIGQUIT": 131, "SIGXCPU": 152}

    def test_other_signals_end_at_once_with_128_and_their_number_and_leave_nothing(self):
        for name, status in self.SIGNALS.items():
            with self.subTest(name):
                bake = self.start()
                self.wait_for(bake, lambda p: True)
                bake.send_signal(getattr(signal, name))
                self.assertEqual(bake.wait(timeout=5), status)
                out, said = self.end(bake)
                self.assertEqual(len(said), 1, said)
                self.assertRegex(said[0], rf"\Ahemibake: room\.glb: [^\n]*{name}[^\n]*nothing is written\Z")
                self.assertEqual((out, self.left()), ("", ["room.glb"]))

    def test_nohup_is_heard(self):
        bake = self.start(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.wait_for(bake, lambda p: True)
        bake.send_signal(signal.SIGHUP)
        self.wait_for(bake, lambda p: True)
        bake.send_signal(signal.SIGTERM)
        self.end(bake)
        self.assertEqual(bake.returncode, 143)

    def test_a_second_interrupt_ends_at_once_and_leaves_nothing(self):
        bake = self.start(stdout=subprocess.DEVNULL)
        self.wait_for(bake, lambda p: True)
        for _ in range(1000):
            bake.send_signal(signal.SIGINT)
            try:
                bake.wait(timeout=0.002)
                break
            except subprocess.TimeoutExpired:
                pass
        self.end(bake)
        self.assertEqual(bake.returncode, INTERRUPTED)
        self.assertIn(self.left(), (["room.glb"], ["out.glb", "out.json", "out.png", "room.glb"]))

    def test_nobody_listens_on_stderr(self):
        """A closed pipe, or none at all: the bake goes on, and an error line goes nowhere, least of all into an output."""
        scene = self.read("room.glb")
        for redirect in ("2>&-", "2>&1 >out.txt | true", "0<&- 2>&-"):
            script = f'"$0" bake room.glb -o out.glb --quality draft --progress json {redirect}'
            subprocess.run(["sh", "-c", script, command.HEMIBAKE], cwd=self.folder, stdout=subprocess.DEVNULL,
                           timeout=command.PATIENCE_S, check=True)
            self.assertEqual(self.read("out.glb")[:4], b"glTF", redirect)
            self.assertEqual([n for n in self.left() if n != "out.txt"], ["out.glb", "room.glb"])
            os.remove(self.path("out.glb"))
        self.assertEqual(self.read("room.glb"), scene)

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
