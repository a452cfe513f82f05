# SPDX-License-Identifier: MIT
"""Does a bake keep to the time that it is given? A table of scenes that are there and of crowds that are made here, on both roads.

    python3 tests/bench/time_limit.py [--seconds 2,5,10] [--methods rows,hybrid] [--only PART_OF_A_NAME] [--processor]

--processor: on a busy machine. One thread, and the clock of a bake is what it has had of a processor (processor_clock.c): it does as on
a machine with one processor that nobody else uses, and that time is what is taken.

taken and worked: seconds of the whole command, by the clock and of processors. late: by how much more than was asked it took. waited: of
those after the limit, what its main thread stood ready to run while others had the processors: on a busy machine that is not the bake's.
Ends with the number of bakes that were more than SHARE late after what they waited, and its exit status says whether any was.
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(ROOT, "tests", "cli"))
import gltf_file  # noqa: E402
import command  # noqa: E402

SHARE = 0.15
CLOCK = os.environ.get("HEMIBAKE_CLOCK", os.path.join(ROOT, "build/release/tests/processor_clock.so"))
SAMPLES, SHARED = os.path.join(ROOT, "samples"), os.path.join(os.path.dirname(ROOT), "shared", "scenes")
THERE = [os.path.join(SAMPLES, "pavilion", "pavilion.glb"), os.path.join(SAMPLES, "pillar-room.glb")] + [
    os.path.join(SHARED, name + ".glb")
    for name in ("slot", "office", "living-room-lamps", "living-room", "bedroom", "garage", "zdm2", "apartment")]


def room(scene, half):
    scene.add_mesh("room", gltf_file.box((-half, 0, -half), (half, 4, half), True), scene.add_material("grey", (0.5, 0.5, 0.5)))


def lamp(scene):
    scene.add_mesh("lamp", gltf_file.lamp(0.4, 3.98), scene.add_material("lamp", (0, 0, 0), (20, 20, 20)))


def triangles(count, dice, low, high, size):
    """Triangles at random places, the corners of each no further than size from its middle."""
    points = [[dice.uniform(a, b) + dice.uniform(-size, size) for a, b in zip(low, high)] for _ in range(count)]
    corners = [[x + dice.uniform(-size, size) for x in p] for p in points for _ in range(3)]
    return corners, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)]


def shine(scene, light, places):
    """A punctual light at each of these places."""
    scene.json["extensionsUsed"] = ["KHR_lights_punctual"]
    scene.json["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
    for place in places:
        scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]))
        scene.json["nodes"].append({**place, "extensions": {"KHR_lights_punctual": {"light": 0}}})


def crossing(scene, dice):
    room(scene, 2), lamp(scene)
    scene.add_mesh("crossing", triangles(5000, dice, (0, 1, 0), (0, 1, 0), 1), scene.add_material("c", (0.5, 0.5, 0.5)))


def glowing(scene, dice):
    room(scene, 10)
    scene.add_mesh("glow", triangles(35000, dice, (-9, 1, -9), (9, 3.9, 9), 0.03), scene.add_material("g", (0, 0, 0), (20, 20, 20)))


def bumpy(scene, dice):
    """A million triangles in one sheet."""
    n = 707
    room(scene, 2), lamp(scene)
    at = [[3 * i / n - 1.5, 0.3 + 0.2 * math.sin(9 * i / n) * math.cos(7 * j / n) + dice.uniform(0, 0.002), 3 * j / n - 1.5]
          for i in range(n + 1) for j in range(n + 1)]
    quads = [i * (n + 1) + j for i in range(n) for j in range(n)]
    scene.add_mesh("sheet", (at, [t for a in quads for t in ((a, a + 1, a + n + 2), (a, a + n + 2, a + n + 1))]),
                   scene.add_material("s", (0.5, 0.5, 0.5)))


def town(scene, dice):
    """80,000 boxes under a sun."""
    count = 80000
    half = 1.5 * math.sqrt(count)
    at, of = [], []
    for _ in range(count):
        x, z = dice.uniform(-half, half), dice.uniform(-half, half)
        points, faces = gltf_file.box((x, 0, z), (x + 1, dice.uniform(0.5, 4), z + 1))
        of += [tuple(i + len(at) for i in face) for face in faces]
        at += points
    grey = scene.add_material("grey", (0.5, 0.5, 0.5))
    scene.add_mesh("ground", ([[-half, 0, -half], [-half, 0, half], [half, 0, half], [half, 0, -half]], [(0, 1, 2), (0, 2, 3)]), grey)
    scene.add_mesh("boxes", (at, of), grey)
    shine(scene, {"type": "directional", "intensity": 3}, [{"rotation": [-0.5, 0.2, 0, 0.84]}])


def lit(count):
    def make(scene, dice):
        room(scene, 10)
        for i in range(20):
            x, z = dice.uniform(-8, 8), dice.uniform(-8, 8)
            scene.add_mesh(f"b{i}", gltf_file.box((x, 0, z), (x + 1, dice.uniform(0.5, 2.5), z + 1)), 0)
        shine(scene, {"type": "point", "intensity": 5000 / count},
              [{"translation": [dice.uniform(-9.5, 9.5), dice.uniform(2.6, 3.9), dice.uniform(-9.5, 9.5)]} for _ in range(count)])
    return make


MADE = {"crossing-5000": crossing, "glowing-35000": glowing, "sheet-1000000": bumpy, "boxes-80000": town, "lights-1000": lit(1000),
        "lights-100000": lit(100000)}


def used(pid):
    """Seconds that a process worked on processors, and that its main thread waited for one; None: it has ended."""
    try:
        with open(f"/proc/{pid}/stat") as f:
            ticks = f.read().rsplit(")", 1)[1].split()
        with open(f"/proc/{pid}/schedstat") as f:
            waited = int(f.read().split()[1]) * 1e-9
    except (OSError, IndexError):
        return None
    return None if ticks[0] == "Z" else (sum(map(int, ticks[11:13])) / os.sysconf("SC_CLK_TCK"), waited)


def bake(path, method, seconds, output, by_processor):
    """(taken, worked, waited after the limit, estimate) or what it said."""
    arguments = [command.HEMIBAKE, "bake", path, "-o", output, "--time", str(seconds), "--method", method, "--report", output + ".json"]
    env = dict(os.environ, LD_PRELOAD=CLOCK) if by_processor else None
    arguments += ["--threads", "1"] * by_processor
    begin = time.monotonic()
    process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=env)
    at_limit = last = (0.0, 0.0)
    while (now := used(process.pid)) is not None:
        last = now
        if time.monotonic() - begin < seconds:
            at_limit = now
        time.sleep(0.01)
    said = process.stderr.read()
    _, status, all_of_it = os.wait4(process.pid, 0)
    taken = time.monotonic() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (command.DONE, command.NOT_CONVERGED):
        return said.strip().splitlines()[-1:] or [str(process.returncode)]
    worked = all_of_it.ru_utime + all_of_it.ru_stime
    with open(output + ".json", encoding="utf-8") as f:
        estimate = json.load(f)["error"]["estimate"]
    return (worked, worked, 0.0, estimate) if by_processor else (taken, worked, last[1] - at_limit[1], estimate)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--seconds", default="2,5,10")
    parser.add_argument("--methods", default="rows,hybrid")
    parser.add_argument("--only", default="")
    parser.add_argument("--processor", action="store_true")
    asked = parser.parse_args()
    late = 0
    print("| scene | method | asked, s | taken, s | worked, s | late | waited, s | estimate |\n|---|---|---:|---:|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory(prefix="hemibake time ") as folder:
        for what in [*THERE, *MADE]:
            name = what if what in MADE else os.path.basename(what)[:-4]
            if asked.only not in name or (what not in MADE and not os.path.exists(what)):
                continue
            path = os.path.join(folder, name + ".glb") if what in MADE else what
            if what in MADE:
                scene = gltf_file.Scene()
                MADE[what](scene, random.Random(name))
                with open(path, "wb") as f:
                    f.write(scene.glb())
            for method in asked.methods.split(","):
                for seconds in map(float, asked.seconds.split(",")):
                    found = bake(path, method, seconds, os.path.join(folder, "out.glb"), asked.processor)
                    if len(found) == 1:
                        late += 1
                        print(f"| {name} | {method} | {seconds:g} | failed: {found[0]} |", flush=True)
                        continue
                    taken, worked, waited, estimate = found
                    share = (taken - seconds) / seconds
                    late += share - waited / seconds > SHARE
                    print(f"| {name} | {method} | {seconds:g} | {taken:.2f} | {worked:.2f} | {share:+.0%} | {waited:.2f} | "
                          f"{estimate:.1%} |", flush=True)
            if what in MADE:
                os.remove(path)
    print(f"\n{late} more than {SHARE:.0%} late, load {os.getloadavg()[0]:.1f}")
    return min(late, 1)


if __name__ == "__main__":
    sys.exit(main())
