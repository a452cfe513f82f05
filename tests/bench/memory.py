# SPDX-License-Identifier: MIT
"""How does memory grow with the number of elements? Peak of the whole process at three sizes, by method, with the
exponent between neighbours. Columns are kept as far as they fit, which they do; what is left is O(N) for pr and hybrid
and elements x patches for fm, and for columns that are kept.

    HEMIBAKE=build/release/bin/hemibake python3 tests/bench/memory.py
"""

import json
import math
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
SCENE = os.path.join(ROOT, "samples", "pillar-room.glb")

# Edges of elements and patches in metres: each step has four times the elements, and the patches to go with them.
SIZES = ((0.08, 0.4), (0.04, 0.2), (0.02, 0.1))

# Enough shots to have been through all of the solver, not to the end.
FEW_SHOTS = ("--unshot", "0.5", "--hemicube", "32", "--hemicube-light", "64")


def bake(folder, method, element, patch, *options):
    report = os.path.join(folder, "report.json")
    subprocess.run([HEMIBAKE, "bake", SCENE, "-o", os.path.join(folder, "out.glb"), "--method", method, "--element-size",
                    str(element), "--patch-size", str(patch), "--no-draco", "--quiet", "--report", report, *options], check=True)
    with open(report, encoding="utf-8") as f:
        return json.load(f)


def main():
    print(f"{'method':8} {'elements':>9} {'patches':>8} {'peak MiB':>9} {'bytes an element':>17} {'exponent':>9}")
    with tempfile.TemporaryDirectory() as folder:
        base = bake(folder, "hybrid", 1.0, 2.0, *FEW_SHOTS)["memory"]["peak_bytes"]
        for method in ("hybrid", "pr"):
            before = None
            for element, patch in SIZES:
                r = bake(folder, method, element, patch, *FEW_SHOTS)
                n, peak = r["scene"]["elements"], r["memory"]["peak_bytes"] - base
                exponent = math.log(peak / before[1]) / math.log(n / before[0]) if before else math.nan
                before = (n, peak)
                print(f"{method:8} {n:9} {r['scene']['patches']:8} {peak / 2**20:9.1f} {peak / n:17.0f} {exponent:9.2f}")
    print(f"peaks are above {base / 2**20:.0f} MiB, which a scene of a few elements takes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
