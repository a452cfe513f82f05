# SPDX-License-Identifier: MIT
"""How near is what 'hemibake inspect' forecasts to what a bake then takes? Prints a table in Markdown, one line a scene and quality.

    python3 tests/accuracy/forecast.py [--quality draft,medium] [--factor 2] [--any-time] [SCENE.glb[:OPTION,OPTION] ...]

Without scenes: the two with truth here, and the shared ones where they are. Times are processor time, since clocks say how busy a machine is.
HEMIBAKE: the program. Exit status 1: a forecast of elements, time or memory is off by more than the factor; with --any-time, as a
machine beside other work asks for, of elements or memory.
"""

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
SHARED = os.path.join(ROOT, "../shared/scenes")

# Lit from outside; the others have lamps.
UNDER_SKY = ("living-room", "bedroom", "zdm2", "apartment", "garage")


def scenes():
    for name in ("pillar-room", "cornell-box"):
        yield os.path.join(ROOT, "tests/accuracy/truth", name + ".glb"), []
    for name in ("slot", "office", "bedroom", "garage", "living-room", "living-room-lamps", "zdm2", "apartment"):
        path = os.path.join(SHARED, name + ".glb")
        if os.path.exists(path):
            yield path, ["--environment", "1,1,1"] if name in UNDER_SKY else []


def forecast(path, options):
    ran = subprocess.run([HEMIBAKE, "inspect", path, "--json", *options], check=True, capture_output=True, text=True)
    f = json.loads(ran.stdout)["forecast"]
    return f["method"], (f["elements"], f["processor_s"], f["memory_bytes"] / 2**20)


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def bake(path, options):
    with tempfile.TemporaryDirectory() as folder:
        report, begin = os.path.join(folder, "r.json"), processor_s()
        subprocess.run([HEMIBAKE, "bake", path, "-o", os.path.join(folder, "o.glb"), "--report", report, "-q", *options], check=True)
        taken = processor_s() - begin
        with open(report) as f:
            told = json.load(f)
    return told["scene"]["elements"], taken, told["memory"]["peak_bytes"] / 2**20


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--factor", type=float, default=2.0)
    parser.add_argument("--any-time", action="store_true")
    parser.add_argument("scenes", nargs="*")
    asked = parser.parse_args()
    given = [(path, [o for o in options.split(",") if o]) for path, _, options in (scene.partition(":") for scene in asked.scenes)]
    worst = 1.0
    print("| scene | quality | method | elements: forecast | baked | processor s: forecast | baked | MiB: forecast | baked |")
    print("|---|---|---|---:|---:|---:|---:|---:|---:|")
    for quality in asked.quality.split(","):
        for path, options in given or scenes():
            method, told = forecast(path, ["--quality", quality, *options])
            found = bake(path, ["--quality", quality, *options])
            judged = [pair for i, pair in enumerate(zip(told, found)) if i != 1 or not asked.any_time]
            worst = max([worst, *(math.exp(abs(math.log(t / f))) for t, f in judged)])
            cells = [f"{x:,.0f}" if i != 1 else f"{x:.2f}" for pair in zip(told, found) for i, x in [(0, pair[0]), (0, pair[1])]]
            cells[2:4] = [f"{told[1]:.2f}", f"{found[1]:.2f}"]
            print("|", " | ".join([os.path.basename(path), quality, method, *cells]), "|", flush=True)
    print(f"\nthe worst is off by a factor {worst:.2f}; {asked.factor:g} is allowed")
    return 0 if worst <= asked.factor else 1


if __name__ == "__main__":
    sys.exit(main())
