# SPDX-License-Identifier: MIT
"""Has what is built what a hardened build has? Asks readelf of each file: hardening_test.py [--fortified] PROGRAM LIBRARY ..."""

import re
import shutil
import subprocess
import sys

SKIPPED = 77


def readelf(what, path):
    return subprocess.run(["readelf", "--wide", what, path], check=True, capture_output=True, text=True).stdout


def lacks(path, fortified):
    """What the file does not have."""
    head, dynamic, segments, symbols = (readelf(what, path) for what in ("-h", "-d", "-l", "--dyn-syms"))
    stack = re.search(r"GNU_STACK\s.*?([R ][W ][E ])\s", segments)
    is_program = ".so" not in path
    has = {"its place chosen anew at each start (PIE)": "DYN" in head and (not is_program or re.search(r"FLAGS_1.*PIE", dynamic)),
           "all symbols found at its start (BIND_NOW)": re.search(r"BIND_NOW|FLAGS_1.*NOW", dynamic),
           "relocations that are read-only (RELRO)": "GNU_RELRO" in segments,
           "no code on its stack": stack and "E" not in stack[1],
           "no relocations in its code": "TEXTREL" not in dynamic,
           "no path of a builder's machine in it (RUNPATH)": not is_program or "RUNPATH" not in dynamic or "$ORIGIN" in dynamic,
           "stacks that are watched (-fstack-protector-strong)": "__stack_chk_fail" in symbols,
           "copies that are checked (_FORTIFY_SOURCE)": not fortified or re.search(r"__\w+_chk\b", symbols.replace("__stack_chk_fail", ""))}
    return [what for what, is_there in has.items() if not is_there]


def main():
    paths = [a for a in sys.argv[1:] if a != "--fortified"]
    if not shutil.which("readelf"):
        print("skipped: there is no readelf")
        return SKIPPED
    wrong = [(path, what) for path in paths for what in lacks(path, "--fortified" in sys.argv)]
    for path, what in wrong:
        print(f"{path} lacks: {what}")
    print(f"{len(paths)} files, {len(wrong)} things are lacking")
    return 1 if wrong or not paths else 0


if __name__ == "__main__":
    sys.exit(main())
