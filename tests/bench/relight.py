# SPDX-License-Identifier: MIT
"""What does it cost to light a scene anew on rows that were kept? Processor seconds of whole processes: a bake, one that keeps its
rows, one by other lights on these, one of other lights from nothing; their estimates, and how large the rows are.

    python3 tests/bench/relight.py [--quality draft] [SCENE.glb ...]     of ../shared/scenes unless named
"""

import argparse
import json
import os
import resource
import subprocess
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
SCENES = os.path.join(ROOT, "..", "shared", "scenes")
FIRST = ("--environment", "1,1,1")
OTHER = ("--environment", "0.1,0.1,0.2", "--sun", "150,40,5", "--emissive-scale", "2")


def bake(folder, scene, *options):
    """Processor seconds, and the estimate."""
    report = os.path.join(folder, "report.json")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([HEMIBAKE, "bake", scene, "-o", os.path.join(folder, "out.glb"), "--report", report, "--quiet", "--method", "rows",
                    *options], check=True, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(report) as f:
        estimate = json.load(f)["error"]["estimate"]
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, estimate


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quality", default="draft")
    parser.add_argument("scenes", nargs="*")
    asked = parser.parse_args()
    scenes = asked.scenes or [os.path.join(SCENES, f"{name}.glb") for name in ("living-room", "bedroom", "office", "zdm2")]
    if not all(map(os.path.exists, scenes)):
        print("skipped: the shared scenes are not there; name some")
        return
    print("| scene | bake, s | keeping rows, s | lit anew, s | share of the bake | estimate | of other lights from nothing, s | estimate | rows, MB |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for scene in scenes:
        with tempfile.TemporaryDirectory() as folder:
            rows, quality = os.path.join(folder, "scene.rows"), ("--quality", asked.quality)
            plain, _ = bake(folder, scene, *quality, *FIRST)
            kept, _ = bake(folder, scene, *quality, *FIRST, "--rows", rows)
            size = os.path.getsize(rows) / 1e6
            relit, estimate = bake(folder, scene, *quality, *OTHER, "--rows", rows)
            other, estimate_of_other = bake(folder, scene, *quality, *OTHER)
            name = os.path.splitext(os.path.basename(scene))[0]
            print(f"| {name} | {plain:.1f} | {kept:.1f} | {relit:.2f} | {100 * relit / plain:.0f} % | {100 * estimate:.1f} % | {other:.1f} | "
                  f"{100 * estimate_of_other:.1f} % | {size:.0f} |", flush=True)


if __name__ == "__main__":
    main()
