# SPDX-License-Identifier: MIT
"""What does it cost in error that triangles are merged? Prints a table; fails where it costs more than what was promised.

The scenes and their probes are in truth/, beside this file.
"""

import sys
import tempfile

from truth_test import measure

# Relative error by eq. 12 of [Baum89] that merging may add: a thirtieth of what elements of any quality are off by.
MOST = 0.0003

# Shares of triangles that were left when this was written; a bake is the same bits on every run, so a tenth more is
# something that got worse. Four fifths of what is left in the pillar room at draft are facets of a sphere.
LEFT = {
    ("pillar-room", "draft"): 0.82, ("pillar-room", "medium"): 0.47, ("pillar-room", "high"): 0.47,
    ("cornell-box", "draft"): 0.77, ("cornell-box", "medium"): 0.58, ("cornell-box", "high"): 0.49,
}
SLACK = 1.1


def main():
    failures = []
    print(f"{'scene':12} {'quality':8} {'triangles':>9} {'merged':>9} {'left':>6} {'error':>8} {'merged':>8} {'added':>8} {'rms':>8} {'largest':>8}")
    with tempfile.TemporaryDirectory() as folder:
        for (scene, quality), share in LEFT.items():
            _, before = measure(scene, folder, "--quality", quality, "--merge-error", "0")
            report, after = measure(scene, folder, "--quality", quality)
            counts, error = report["scene"], report["error"]
            left, added = counts["triangles_out"] / counts["triangles_cut"], after["error"] - before["error"]
            print(f"{scene:12} {quality:8} {counts['triangles_cut']:9} {counts['triangles_out']:9} {left:6.1%} {before['error']:8.3%} "
                  f"{after['error']:8.3%} {added:+8.3%} {error['merge']:8.3%} {error['merge_largest']:8.3%}", flush=True)
            if not added <= MOST:
                failures.append(f"{scene} {quality}: merging adds {added:.3%} to the error, and may add {MOST:.3%}")
            if not left <= SLACK * share:
                failures.append(f"{scene} {quality}: {left:.1%} of the triangles are left, and were {share:.1%} once")
    for failure in failures:
        print(failure, file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
