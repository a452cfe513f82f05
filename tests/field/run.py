# SPDX-License-Identifier: MIT
"""Do the cases from the field come out right? Prints case, expected, got, verdict, processor seconds; ends with how many are right.

    python3 tests/field/run.py [HEMIBAKE] [--quality draft|medium|high|all] [--fast] [case ...]

The cases lie in ../shared/field beside the checkout, or in $HEMIBAKE_FIELD. Exit status 0: all are right; 1: not all; 77: they are not there.
--fast: those that are right at draft in a second or so. A case is named as its file, without .glb.
"""

import argparse
import os
import resource
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, HERE)

import asset_cases  # noqa: E402,F401
import geometry_cases  # noqa: E402,F401
from baked import Bench  # noqa: E402
from rows import CASES  # noqa: E402

QUALITIES = ("draft", "medium", "high")


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--quality", choices=(*QUALITIES, "all"), default="draft")
    parser.add_argument("--fast", action="store_true")
    parser.add_argument("names", nargs="*")
    asked = parser.parse_intermixed_args()
    asked.hemibake = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
    if asked.names and os.path.isfile(asked.names[0]) and os.access(asked.names[0], os.X_OK):
        asked.hemibake = os.path.abspath(asked.names.pop(0))
    unknown = sorted(set(asked.names) - set(CASES))
    if unknown:
        parser.error(f"no case {', '.join(unknown)}; there are {', '.join(sorted(CASES))}")
    return asked


def processor_seconds():
    """Of all bakes so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def ask(name, bench):
    """Prints the rows of one case, each with the seconds of the processor so far; was all of it right?"""
    function, _, _ = CASES[name]
    right, before = True, processor_seconds()
    try:
        for what, expected, got, verdict in function(bench):
            right = right and verdict
            said = f"{'right' if verdict else 'WRONG'} {processor_seconds() - before:7.1f} s"
            print(f"{name:22s} {bench.quality:7s} {what:46s} {expected:26s} {got:26s} {said}", flush=True)
    except Exception as error:  # A case that cannot be read is wrong, and the others still want their turn.
        right = False
        print(f"{name:22s} {bench.quality:7s} {type(error).__name__}: {error}  WRONG", flush=True)
    return right


def main():
    asked = arguments()
    field = os.environ.get("HEMIBAKE_FIELD", os.path.join(ROOT, "..", "shared", "field"))
    if not os.path.isdir(field):
        print("skipped: the cases from the field are not beside this checkout (../shared/field)")
        return 77
    qualities = QUALITIES if asked.quality == "all" else (asked.quality,)
    results = []
    for quality in qualities:
        with tempfile.TemporaryDirectory(prefix="hemibake field ") as folder:
            bench = Bench(asked.hemibake, field, folder, quality)
            for name, (_, only, fast) in CASES.items():
                chosen = name in asked.names if asked.names else fast or not asked.fast
                if chosen and (only is None or quality in only):
                    results.append(ask(name, bench))
    print(f"{sum(results)} of {len(results)} right")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
