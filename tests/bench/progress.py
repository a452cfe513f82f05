# SPDX-License-Identifier: MIT
"""What does it cost to show progress? Bakes that say nothing against those that show progress as lines, as JSON and on a terminal.

    python3 tests/bench/progress.py [--runs 15] [--threads 1] [-- SCENE.glb [OPTION ...]]      default: samples/pillar-room.glb

By user seconds: each turn bakes every way once, in another order each time, so that whatever else the machine does falls on all. A
way's cost is the median over turns of its seconds against those of the quiet bake of the same turn; what that may be off by is two
standard errors of such a median, and what a second quiet bake of each turn seems to cost shows whether to believe it.

By instructions, since a busy machine's seconds differ by more than the goal of 1 %: a coarse bake of a small room under valgrind's
callgrind, whose counts of two runs differ by 1e-5. There a bake takes some fifty times as long, and what is paced by a clock comes
fifty times as often for the same work; so a cost below the goal there is one below it anywhere. It is taken against instructions of
the program itself, without those of Mesa and LLVM and of loading them. --runs 0: by instructions alone.

Exit status 1: the goal is missed; by instructions where valgrind is there, else by seconds, beyond what they may be off by.
"""

import argparse
import os
import pty
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading

from instructions import instructions
from small_room import small_room

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
GOAL = 0.01
# Small enough for half a minute under callgrind.
COARSE = ("--quality", "draft", "--element-size", "0.5", "--patch-size", "1", "--threads", "1")
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


def by_seconds(asked, folder):
    """Prints a table; the worst way, its cost, and what that may be off by."""
    seconds, said = {way: [] for way in WAYS}, {way: [] for way in WAYS}
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
        print(f"| {way} | {statistics.median(seconds[way]):.3f} | {100 * share:+.2f} % | {100 * noise:.2f} % | "
              f"{statistics.median(said[way]):.0f} |")
    return max(((way, *costs[way]) for way in SHOWN), key=lambda one: one[1])


def by_instructions(folder):
    """Prints a table; the worst way and its cost."""
    counts, said = {}, {}
    room = os.path.join(folder, "room.glb")
    small_room(room)
    out = os.path.join(folder, "callgrind")
    for way, options in WAYS.items():
        # Without threads of Mesa, which would wait by spinning.
        valgrind = ["env", "LP_NUM_THREADS=0", "valgrind", "--quiet", "--tool=callgrind", f"--callgrind-out-file={out}"]
        bake = [HEMIBAKE, "bake", room, "-o", os.path.join(folder, "out.glb"), *COARSE, *options]
        _, said[way] = run([*valgrind, *bake], way, folder)
        counts[way] = instructions(out, os.path.realpath(HEMIBAKE))
    own = counts[QUIET]["own"]
    costs = {way: (counts[way]["all"] - counts[QUIET]["all"]) / own for way in WAYS}
    print("\nunder callgrind, against the quiet bake's instructions of the program itself\n"
          "| progress | own, 1e6 | all, 1e6 | cost | said, bytes |\n|---|---:|---:|---:|---:|")
    for way in WAYS:
        print(f"| {way} | {counts[way]['own'] / 1e6:.2f} | {counts[way]['all'] / 1e6:.2f} | {100 * costs[way]:+.3f} % | {said[way]} |")
    return max(((way, costs[way]) for way in SHOWN), key=lambda one: one[1])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("bake", nargs="*", default=[os.path.join(ROOT, "samples/pillar-room.glb")])
    asked = parser.parse_args()
    missed = False
    with tempfile.TemporaryDirectory() as folder:
        if asked.runs > 0:
            way, share, noise = by_seconds(asked, folder)
            missed = share > GOAL + noise
            verdict = "missed" if missed else "not decided by this machine" if noise > GOAL else "met"
            print(f"{way} costs most, {100 * share:+.2f} % of user seconds, give or take {100 * noise:.2f} %; "
                  f"goal {100 * GOAL:.0f} %: {verdict}")
        if shutil.which("valgrind"):
            way, share = by_instructions(folder)
            missed = share > GOAL
            print(f"{way} costs most, {100 * share:+.3f} % of instructions; goal {100 * GOAL:.0f} %: {'missed' if missed else 'met'}")
    return missed


if __name__ == "__main__":
    sys.exit(main())
