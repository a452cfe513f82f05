# SPDX-License-Identifier: MIT
"""Does a bake keep to the memory that --memory allows? Prints a table in Markdown: scene, what was allowed, what it took at its peak or the
line that refused it, elements, and what it says it did without.

    python3 tests/accuracy/memory.py [--quality draft] [--asked 1000,400,250,180,130] [--threads N] [SCENE.glb[:OPTION,OPTION] ...]

Without scenes: the sample, and the shared ones where they are. HEMIBAKE: the program. Exit status: how many bakes took more than a tenth
above what was allowed, or ended otherwise than as a bake or in one line that says memory.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile

from forecast import HEMIBAKE, scenes


def bake(path, asked, options):
    """Status, peak of the process in MiB, the report or None, what it said."""
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, "r.json")
        command = [HEMIBAKE, "bake", path, "-o", os.path.join(folder, "o.glb"), "--report", report, "--memory", str(asked), *options]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        said = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        told = None
        if status == 0:
            with open(report, encoding="utf-8") as f:
                told = json.load(f)
        return os.waitstatus_to_exitcode(status), used.ru_maxrss / 1024, told, said


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--asked", default="1000,400,250,180,130")
    parser.add_argument("--threads", default="2")
    parser.add_argument("scenes", nargs="*")
    given = parser.parse_args()
    named = [(path, [o for o in options.split(",") if o]) for path, _, options in (scene.partition(":") for scene in given.scenes)]
    short = refused = baked = 0
    print("| scene | allowed, MiB | peak, MiB | peak / allowed | elements | what it did without |\n|---|---:|---:|---:|---:|---|")
    for path, options in named or scenes():
        for asked in given.asked.split(","):
            status, peak, told, said = bake(path, asked, ["--quality", given.quality, "--threads", given.threads, *options])
            lines = [line.partition(": ")[2] for line in said.splitlines()]
            fewer = " ".join(re.findall(r"leaves (\d+ % of the rays)", said))
            ends_well = status == 0 or (status == 1 and len(lines) == 1 and re.search(r"MiB|memory", said))
            refused, baked = refused + (status == 1), baked + (status == 0)
            is_short = not ends_well or peak > 1.1 * float(asked)
            short += is_short
            print(f"| {os.path.basename(path)} | {asked} | {peak:.0f} | {peak / float(asked):.2f}{' SHORT' if is_short else ''} | "
                  f"{told['scene']['elements'] if told else ''} | {fewer if told else 'refused: ' + ' '.join(lines)} |", flush=True)
    print(f"\n{baked} baked, {refused} refused, {short} fell short")
    return min(short, 76)


if __name__ == "__main__":
    sys.exit(main())
