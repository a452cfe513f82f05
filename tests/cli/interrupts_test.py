# SPDX-License-Identifier: MIT
"""Is Ctrl-C answered whatever a bake is busy with, and does its progress move all the time?

    python3 tests/cli/interrupts_test.py --moments 20        all of it, minutes: a table; ends with how many were late

As a test it tries a few moments, with bounds that a busy machine keeps.
"""

import json
import os
import queue
import random
import signal
import subprocess
import sys
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


def lines_of(stream):
    """Each line with its moment; the last item is None."""
    out = queue.Queue()

    def read():
        for line in stream:
            out.put((time.monotonic(), line))
        out.put(None)

    threading.Thread(target=read, daemon=True).start()
    return out


def try_moment(folder, scene, options, moment_s):
    """Ctrl-C after so many seconds: (stage, seconds until it had ended, longest stillness before, status, output, words)."""
    output = os.path.join(folder, "out.glb")
    if os.path.exists(output):
        os.remove(output)
    process = subprocess.Popen([command.HEMIBAKE, "bake", scene, "-o", output, "--progress", "json", *options],
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    begin = last = time.monotonic()
    lines, stage, still, words, sent = lines_of(process.stderr), "start", 0.0, [], None
    while True:
        left = begin + moment_s - time.monotonic()
        if sent is None and left <= 0:
            sent = time.monotonic()
            process.send_signal(signal.SIGINT)
        try:
            item = lines.get(timeout=max(left, 0.0) if sent is None else command.PATIENCE_S)
        except queue.Empty:
            continue
        if item is None:
            break
        if item[1].startswith("{"):
            if sent is None:
                still, last, stage = max(still, item[0] - last), item[0], json.loads(item[1])["stage"]
        else:
            words.append(item[1].strip())
    status = process.wait()
    process.stdout.close()
    process.stderr.close()
    return stage, time.monotonic() - (sent or time.monotonic()), still, status, os.path.exists(output), words


class Interrupts(command.CommandCase):
    def check(self, scene, options, moment_s):
        stage, took, still, status, is_written, words = try_moment(self.folder, scene, options, moment_s)
        at = f"{scene} {options} after {moment_s} s, in {stage}: {took:.2f} s, still for {still:.2f} s, {status}, {words}"
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


def run_long(moments):
    late = 0
    random.seed(1)
    with_apartment = [(APARTMENT, (), 25.0), (APARTMENT, SUN, 40.0)] if os.path.exists(APARTMENT) else []
    print(f"{'scene':<12} {'at':>6} {'stage':<12} {'ended in':>8} {'still':>6} {'status':>6} written")
    for scene, options, longest in [(PAVILION, (), 60.0), *with_apartment]:
        for _ in range(moments):
            moment = random.uniform(0.05, longest)
            stage, took, still, status, is_written, _ = try_moment("/tmp", scene, options, moment)
            late += took > ANSWER_S or still > STILL_S
            print(f"{os.path.basename(scene)[:-4]:<12} {moment:6.2f} {stage:<12} {took:8.2f} {still:6.2f} {status:6d} {is_written}", flush=True)
    print(f"{late} late")
    return late


if __name__ == "__main__":
    if "--moments" in sys.argv:
        sys.exit(run_long(int(sys.argv[sys.argv.index("--moments") + 1])) > 0)
    command.main()
