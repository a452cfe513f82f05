# SPDX-License-Identifier: MIT
"""How far is a bake from path-traced truth, and does its own estimate say so? Prints a table; fails past the bars.

The scenes and their probes are in truth/, beside this file.
"""

import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
TRUTH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "truth")

# What the project promises of each quality, relative error by eq. 12 of [Baum89].
PROMISED = {"draft": 0.10, "medium": 0.06, "high": 0.02}

# What was reached when this was written; a bake is the same bits on every run, so a quarter more is no noise but something
# that got worse. Better figures belong here as soon as they are reached.
MEASURED = {
    ("pillar-room", "draft"): 0.0168, ("pillar-room", "medium"): 0.0067, ("pillar-room", "high"): 0.0057,
    ("cornell-box", "draft"): 0.0186, ("cornell-box", "medium"): 0.0084, ("cornell-box", "high"): 0.0047,
}
SLACK = 1.25

# The paper's other methods, at the cheapest quality: only their estimates are held to anything.
METHODS = ("analytic", "pr", "fm")

# How far the estimated error may be from the true one, either way.
FACTOR = 2.0
FACTOR_TOO_HIGH = 4


def run(*arguments):
    return subprocess.run([HEMIBAKE, *arguments], check=True, stdout=subprocess.PIPE, timeout=600).stdout


def measure(scene, folder, *options):
    """The report and the comparison of one bake."""
    baked, report = os.path.join(folder, f"{scene}.glb"), os.path.join(folder, f"{scene}.json")
    run("bake", os.path.join(TRUTH, f"{scene}.glb"), "-o", baked, "--scene-linear", "--no-draco", "--report", report, "--quiet",
        *options)
    with open(report, encoding="utf-8") as f:
        return json.load(f), json.loads(run("compare", baked, os.path.join(TRUTH, f"{scene}.hprb"), "--json"))


def look(name, report, found):
    """Prints one row; lists what is wrong with any bake."""
    error, estimate = found["error"], report["error"]["estimate"]
    print(f"{name:24} {error:8.3%} {found['bias']:+8.3%} {estimate:8.3%} {error / estimate:6.2f} {report['time']['total_s']:8.2f} "
          f"{report['scene']['elements']:9} {found['matched']:8}")
    failures = []
    # An estimate that is too high is an honest one: one of 475 points, 5 mm from the outline of a lamp, may hold nine tenths of it
    # (cornell-box at high, by the seed). One that is too low is not.
    if not estimate / FACTOR_TOO_HIGH <= error <= estimate * FACTOR:
        failures.append(f"{name}: the estimate {estimate:.3%} is more than a factor {FACTOR:g} from {error:.3%}")
    if found["unmatched"] > 0 or found["matched"] == 0:
        failures.append(f"{name}: {found['unmatched']} probes lie on no triangle of the bake")
    if not report["energy"]["residual_fraction"] <= 1e-6:
        failures.append(f"{name}: the books are off by {report['energy']['residual_fraction']:g} of what is emitted")
    return failures


def main():
    failures = []
    print(f"{'bake':24} {'error':>8} {'bias':>8} {'estimate':>8} {'ratio':>6} {'seconds':>8} {'elements':>9} {'matched':>8}")
    with tempfile.TemporaryDirectory() as folder:
        for (scene, quality), measured in MEASURED.items():
            report, found = measure(scene, folder, "--quality", quality)
            failures += look(f"{scene} {quality}", report, found)
            bar = min(PROMISED[quality], SLACK * measured)
            if not found["error"] <= PROMISED[quality]:
                failures.append(f"{scene} {quality}: {found['error']:.3%} is above the promised {PROMISED[quality]:.0%}")
            elif not found["error"] <= bar:
                failures.append(f"{scene} {quality}: {found['error']:.3%} was {measured:.3%} once, and may be {bar:.3%}")
        for scene in sorted({scene for scene, _ in MEASURED}):
            for method in METHODS:
                report, found = measure(scene, folder, "--quality", "draft", "--method", method)
                failures += look(f"{scene} {method}", report, found)
    for failure in failures:
        print(failure, file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
