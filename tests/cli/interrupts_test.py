# SPDX-License-Identifier: MIT
"""Is Ctrl-C answered whatever a bake is busy with, and does its progress move all the time?

    python3 tests/cli/interrupts_test.py --moments 20 [pavilion|apartment|... [OPTION ...]]
                                         minutes: a table; ends with the longest answer; options, as --method hybrid, are the bake's

Beside the seconds from Ctrl-C to the end stand those of processors that the process took in them, and so with the longest stillness:
where these are few, it was the machine that was busy, and not the process; what is late is so by both. As a test it tries a few moments,
with bounds that a busy machine keeps.
"""

import json
import os
import queue
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time

import command
from command import DONE, INTERRUPTED

PAVILION = os.path.join(command.SAMPLES, "pavilion", "pavilion.glb")
APARTMENT = os.path.join(os.path.dirname(command.ROOT), "shared", "scenes", "apartment.glb")
SUN = ("--sun", "150,40,80000")

ANSWER_S, STILL_S = 1.0, 0.5

# What a machine may be slower by that does other things meanwhile.
BUSY = 6.0


def processor_s(pid):
    """User and system seconds of a process so far."""
    with open(f"/proc/{pid}/stat") as f:
        ticks = f.read().rsplit(")", 1)[1].split()[11:13]
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


def lines_of(process):
    """Each line of its stderr with its moment, as (seconds, of processors by then, line); the last item is None."""
    out = queue.Queue()

    def read():
        for line in process.stderr:
            out.put((time.monotonic(), processor_s(process.pid), line))
        out.put(None)

    threading.Thread(target=read, daemon=True).start()
    return out


def try_moment(folder, scene, options, moment_s):
    """Ctrl-C after so many seconds: (stage, seconds until it had ended, of processors in them, longest stillness before, of processors in
    the one that had most, status, output, words)."""
    output = os.path.join(folder, "out.glb")
    if os.path.exists(output):
        os.remove(output)
    process = subprocess.Popen([command.HEMIBAKE, "bake", scene, "-o", output, "--progress", "json", *options],
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    begin = time.monotonic()
    lines, stage, words, sent, before = lines_of(process), "start", [], None, 0.0
    last, still = (begin, 0.0), [0.0, 0.0]
    while True:
        left = begin + moment_s - time.monotonic()
        if sent is None and left <= 0:
            sent, before = time.monotonic(), processor_s(process.pid)
            process.send_signal(signal.SIGINT)
        try:
            item = lines.get(timeout=max(left, 0.0) if sent is None else command.PATIENCE_S)
        except queue.Empty:
            continue
        if item is None:
            break
        if item[2].startswith("{"):
            if sent is None:
                still, last, stage = [max(s, n - l) for s, n, l in zip(still, item, last)], item[:2], json.loads(item[2])["stage"]
        else:
            words.append(item[2].strip())
    _, waited, used = os.wait4(process.pid, 0)
    process.returncode = status = os.waitstatus_to_exitcode(waited)
    process.stdout.close()
    process.stderr.close()
    took = time.monotonic() - (sent or time.monotonic())
    return stage, took, used.ru_utime + used.ru_stime - before if sent else 0.0, *still, status, os.path.exists(output), words


class Interrupts(command.CommandCase):
    def check(self, scene, options, moment_s):
        stage, took, worked, still, _, status, is_written, words = try_moment(self.folder, scene, options, moment_s)
        at = (f"{scene} {options} after {moment_s} s, in {stage}: {took:.2f} s, {worked:.2f} of processors, still for {still:.2f} s, "
              f"{status}, {words}")
        self.assertIn(status, (DONE, INTERRUPTED), at)
        self.assertLess(took, BUSY * ANSWER_S, at)
        self.assertLess(still, BUSY * STILL_S, at)
        if not is_written:
            self.assertTrue(any("interrupted; nothing is written" in word for word in words), at)

    def test_shooting_and_refinement_of_the_pavilion(self):
        for moment in (0.3, 2.0, 4.0):
            self.check(PAVILION, ("--method", "hybrid", "--quality", "draft"), moment)

    def test_the_sun_and_the_mesh_of_many_triangles(self):
        if not os.path.exists(APARTMENT):
            self.skipTest("shared/scenes is not there")
        for moment in (1.5, 4.0):
            self.check(APARTMENT, (*SUN, "--quality", "draft"), moment)


def fault_of(folder, status, is_written, words):
    """What an interrupted bake did that is not promised; None: nothing."""
    left = sorted(os.listdir(folder))
    if status == -signal.SIGINT and not left:
        return None  # nothing of ours had been run yet
    if status not in (DONE, INTERRUPTED):
        return f"status {status}"
    if left != ["out.glb"] * is_written:
        return f"left {left}"
    if not is_written:
        return None if status == INTERRUPTED and any("nothing is written" in word for word in words) else f"said {words}"
    with open(os.path.join(folder, "out.glb"), "rb") as f:
        data = f.read()
    return None if len(data) >= 12 and int.from_bytes(data[8:12], "little") == len(data) else "torn output"


def moments_of(scene, options, count, longest_s):
    """Moments while the bake runs, and what came of each: where it had ended sooner, moments are drawn from what it took."""
    while count > 0:
        moment, begin = random.uniform(0.05, longest_s), time.monotonic()
        with tempfile.TemporaryDirectory(prefix="hemibake test ") as folder:
            found = try_moment(folder, scene, options, moment)
            took = time.monotonic() - begin
            if took < moment:
                longest_s = took
                continue
            count -= 1
            yield moment, found, fault_of(folder, *found[5:])


def run_long(moments, only, more):
    late = faults = 0
    answers = {}
    random.seed(1)
    shared = [("living-room", (), 30.0), ("living-room-lamps", (), 30.0), ("office", (), 30.0), ("garage", (), 40.0), ("zdm2", (), 60.0),
              ("apartment", (), 60.0), ("apartment", SUN, 60.0)]
    shared = [(os.path.join(os.path.dirname(APARTMENT), name + ".glb"), *rest) for name, *rest in shared]
    print(f"{'scene':<15} {'at':>6} {'stage':<12} {'ended in':>8} {'worked':>6} {'still':>6} {'worked':>6} {'status':>6} {'written':<7} "
          "fault")
    for scene, options, longest in [(PAVILION, (), 60.0), *shared]:
        if only not in scene or not os.path.exists(scene):
            continue
        name = " ".join((os.path.basename(scene)[:-4], *options[:1]))
        for moment, found, fault in moments_of(scene, (*options, *more), moments, longest):
            stage, took, worked, still, still_worked, status, is_written, _ = found
            late += min(took, worked) > ANSWER_S or min(still, still_worked) > STILL_S
            faults += fault is not None
            answers[name] = max(answers.get(name, (0.0, "")), (took, f"{took:.2f} s in {stage}, {worked:.2f} of processors"))
            print(f"{name:<15} {moment:6.2f} {stage:<12} {took:8.2f} {worked:6.2f} {still:6.2f} {still_worked:6.2f} {status:6d} "
                  f"{is_written!s:<7} {fault or '-'}", flush=True)
    if not answers:
        print(f"skipped: no scene {only}")
        return 0
    for name, (_, longest) in answers.items():
        print(f"{name}: at most {longest}")
    print(f"{late} late, {faults} faults, load {os.getloadavg()[0]:.1f}; longest {max(answers.values())[1]}, goal {ANSWER_S:.0f} s")
    return late + faults


if __name__ == "__main__":
    if "--moments" in sys.argv:
        # Whoever runs this in the background may have had it ignore Ctrl-C, and bakes with it until they listen themselves.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        asked = sys.argv[sys.argv.index("--moments") + 1:]
        sys.exit(run_long(int(asked[0]), "".join(asked[1:2]), asked[2:]) > 0)
    command.main()
