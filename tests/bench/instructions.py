# SPDX-License-Identifier: MIT
"""Has a bake become more expensive? Counts the instructions of a few small bakes on one thread, under valgrind's callgrind, and
compares them with instructions.json. Seconds depend on what else a machine does; instructions of one program do not.

    python3 tests/bench/instructions.py [--hemibake build/release/bin/hemibake]
    python3 tests/bench/instructions.py --renew       after a change that costs more for a reason, or that saves

Two numbers a bake: `own`, what hemibake's own code executes, and `all`, with Mesa, LLVM and the C library, which shows hemi-cubes
drawn in vain. Exit status 1: a bake costs more than it may; 77: skipped, there is no valgrind.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from small_room import small_room

FOLDER = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(FOLDER))
STORED = os.path.join(FOLDER, "instructions.json")
SKIPPED = 77

# Two runs of one program differ by 1e-5 (a clock is read while workers work), once Mesa has its shaders on disk. The rest is for small changes that nobody wants to
# account for. `all` is wider because Mesa compiles its shaders for the processor it finds.
MAY_GROW = {"own": 1.05, "all": 1.10}

# Another compiler makes other instructions of the same source, by up to a fifth between major versions of GCC.
OTHER_COMPILER = 1.25

# Small enough for a quarter of a minute in all, and together through each of the ways that light comes.
BAKES = {
    "lamp": ("room", "--quality", "draft", "--element-size", "0.5", "--patch-size", "1"),
    "analytic": ("room", "--quality", "draft", "--method", "analytic", "--element-size", "0.6", "--patch-size", "1.2"),
    "sun and sky": ("terrace", "--quality", "draft", "--element-size", "0.8", "--patch-size", "1.6", "--sun", "150,40,80000",
                    "--environment", "0.3,0.4,0.6"),
}


def compiler_of(hemibake):
    """As the compiler wrote it into the program."""
    text = subprocess.run(["readelf", "-p", ".comment", hemibake], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    found = re.findall(r"GCC: \(.*\) (\d+)\.|clang version (\d+)", text)
    return "clang " + found[0][1] if found and found[0][1] else "gcc " + found[0][0] if found else "unknown"


def instructions(path, program):
    """Sums a callgrind file: all instructions, and those in the object that is the program itself."""
    names, total, own, inside, skip, said = {}, 0, 0, False, False, None
    with open(path, encoding="utf-8", errors="replace") as f:
        for line in f:
            if line.startswith("ob="):
                number, _, name = line[3:].strip().partition(" ")
                if name:
                    names[number] = name
                inside = names.get(number) == program
            elif line.startswith("cob="):
                number, _, name = line[4:].strip().partition(" ")
                if name:
                    names[number] = name
            elif line.startswith("totals:"):
                said = int(line.split()[1])
            elif line.startswith("calls="):
                skip = True  # the next line is what the callee cost, which is counted where it happens
            elif line[:1].isdigit() or line[:1] in "+-*":
                cost = 0 if skip else int(line.split()[-1])
                total, own, skip = total + cost, own + (cost if inside else 0), False
    if said != total:
        sys.exit(f"instructions: {path} adds up to {total}, and says {said}")
    return {"own": own, "all": total}


def count(hemibake, folder, name):
    scene, *options = BAKES[name]
    stem = os.path.join(folder, name.replace(" ", "-"))
    bake = [hemibake, "bake", os.path.join(folder, scene + ".glb"), "-o", stem + ".glb", "--quiet", "--threads", "1", *options]
    environment = dict(os.environ, LP_NUM_THREADS="0")
    command = ["valgrind", "--tool=callgrind", "--quiet", f"--callgrind-out-file={stem}.callgrind", *bake]
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600)
    if done.returncode:
        sys.exit(f"instructions: '{name}' ended with {done.returncode}:\n{done.stdout}")
    return instructions(stem + ".callgrind", os.path.realpath(hemibake))


def measure(hemibake):
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        small_room(os.path.join(folder, "room.glb"))
        small_room(os.path.join(folder, "terrace.glb"), roof=False)
        return dict(zip(BAKES, pool.map(lambda name: count(hemibake, folder, name), BAKES)))


def compare(found, stored, compiler):
    """Prints a table; returns what is wrong."""
    failures, saved = [], False
    same = compiler == stored["compiler"]
    print(f"{'bake':12} {'what':4} {'stored, millions':>17} {'now':>10} {'ratio':>8}")
    for name, counts in found.items():
        for what, now in counts.items():
            before = stored["bakes"].get(name, {}).get(what)
            if not before:
                failures.append(f"'{name}' is not in instructions.json; renew it")
                break
            ratio, most = now / before, MAY_GROW[what] if same else OTHER_COMPILER
            print(f"{name:12} {what:4} {before / 1e6:17.1f} {now / 1e6:10.1f} {ratio:8.4f}")
            saved = saved or ratio < 2 - most
            if ratio > most:
                failures.append(f"'{name}' costs {ratio:.3f} times the instructions it did ({what}); {most:g} are allowed")
    if not same:
        print(f"counted with {stored['compiler']}, this is {compiler}: {OTHER_COMPILER:g} times are allowed")
    if saved and not failures:
        print("a bake costs clearly less than is stored: renew it, or the next change may waste what this one saved")
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--hemibake", default=os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake")))
    parser.add_argument("--renew", action="store_true", help="write instructions.json anew")
    a = parser.parse_args()
    if not shutil.which("valgrind"):
        print("skipped: there is no valgrind")
        return SKIPPED
    compiler, found = compiler_of(a.hemibake), measure(a.hemibake)
    if any(counts["own"] == 0 for counts in found.values()):
        sys.exit("instructions: callgrind's file names no function of hemibake; nothing was counted")
    if a.renew:
        with open(STORED, "w", encoding="utf-8") as f:
            json.dump({"compiler": compiler, "bakes": found}, f, indent=2)
            f.write("\n")
        print(f"wrote {STORED}")
        return 0
    with open(STORED, encoding="utf-8") as f:
        stored = json.load(f)
    failures = compare(found, stored, compiler)
    if failures:
        print("once more: where Mesa's shaders are not on disk yet, the first bakes compile them, 140 million instructions each")
        failures = compare(measure(a.hemibake), stored, compiler)
    for failure in failures:
        print(f"instructions: {failure}", file=sys.stderr)
    if failures:
        print("instructions: if it is worth that, say so in CHANGELOG.md beside this and run with --renew", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
