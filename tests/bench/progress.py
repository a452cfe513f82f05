# SPDX-License-Identifier: MIT
"""What does it cost to show progress? User seconds of bakes that say nothing and of those that show progress as lines, as JSON and on a
terminal, by turns.

    python3 tests/bench/progress.py [--runs 15] [--threads 1] [-- SCENE.glb [OPTION ...]]      default: samples/pillar-room.glb

Each turn bakes every way once, in another order each time, so that whatever else the machine does falls on all. A way's cost is the
median over turns of its seconds against those of the quiet bake of the same turn; what that may be off by is two standard errors of
such a median, and what a second quiet bake of each turn seems to cost shows whether to believe it. Exit status 1 if a way costs more
than 1 % beyond what it may be off by; nothing is proved by a machine on which that is more than 1 % itself, which is said.
"""

import argparse
import os
import pty
import resource
import statistics
import subprocess
import sys
import tempfile
import threading

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
GOAL = 0.01
QUIET, AGAIN = "quiet", "quiet again"
SHOWN = {"plain": ("--progress", "plain"), "json": ("--progress", "json"), "terminal": ("--progress", "auto")}
WAYS = {QUIET: ("--quiet",), **SHOWN, AGAIN: ("--quiet",)}


def drain(terminal, said):
    """What a terminal does: reads until nobody writes any more."""
    try:
        while True:
            said.append(len(os.read(terminal, 65536)))
    except OSError:
        pass


def run(command, way, folder):
    """(user seconds, bytes said on stderr) of a bake in one way."""
    before, said = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, []
    if way == "terminal":
        ours, its = pty.openpty()
        reader = threading.Thread(target=drain, args=(ours, said))
        reader.start()
        subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=its, check=True)
        os.close(its)
        reader.join()
        os.close(ours)
    else:
        path = os.path.join(folder, "said")
        with open(path, "wb") as f:
            subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=f, check=True)
        said.append(os.path.getsize(path))
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, sum(said)


def cost(seconds, quiet):
    """Median of what is paid on top, and two standard errors of it, from the median deviation as of a normal distribution."""
    shares = [a / b - 1 for a, b in zip(seconds, quiet)]
    middle = statistics.median(shares)
    deviation = 1.4826 * statistics.median(abs(share - middle) for share in shares)
    return middle, 2 * 1.2533 * deviation / len(shares) ** 0.5


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("bake", nargs="*", default=[os.path.join(ROOT, "samples/pillar-room.glb")])
    asked = parser.parse_args()
    seconds, said = {way: [] for way in WAYS}, {way: [] for way in WAYS}
    with tempfile.TemporaryDirectory() as folder:
        bake = [HEMIBAKE, "bake", *asked.bake, "-o", os.path.join(folder, "out.glb"), "--threads", str(asked.threads)]
        run([*bake, *WAYS[QUIET]], QUIET, folder)  # what is cached on disk is there for all
        ways = list(WAYS)
        for turn in range(asked.runs):
            for way in ways[turn % len(ways):] + ways[:turn % len(ways)]:
                took, size = run([*bake, *WAYS[way]], way, folder)
                seconds[way].append(took)
                said[way].append(size)
    print(f"{os.path.basename(asked.bake[0])}, {asked.threads} threads, {asked.runs} turns, load {os.getloadavg()[0]:.1f}")
    print("| progress | user, s | against quiet | give or take | said, bytes |\n|---|---:|---:|---:|---:|")
    costs = {way: cost(seconds[way], seconds[QUIET]) for way in WAYS}
    for way, (share, noise) in costs.items():
        print(f"| {way} | {statistics.median(seconds[way]):.3f} | {100 * share:+.2f} % | {100 * noise:.2f} % | {statistics.median(said[way]):.0f} |")
    way, (share, noise) = max(((way, costs[way]) for way in SHOWN), key=lambda item: item[1][0])
    verdict = "missed" if share > GOAL + noise else "not decided by this machine" if noise > GOAL else "met"
    print(f"{way} costs most, {100 * share:+.2f} %, give or take {100 * noise:.2f} %; goal {100 * GOAL:.0f} %: {verdict}")
    return verdict == "missed"


if __name__ == "__main__":
    sys.exit(main())
