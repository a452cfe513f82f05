#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What do elements save that are small only where light is not linear? Error against elements, uniform and adaptive.

    python3 tests/bench/adaptive.py [HEMIBAKE]        default: build/release/bin/hemibake

Both on the same patches, hemi-cubes and shots; error against the probes of tests/accuracy/truth. At the end: how many
elements each needs for one error, between the points of its curve (log-log), and their ratio.
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TRUTH = ROOT / "tests" / "accuracy" / "truth"
SCENES = {"pillar-room": 65.6, "cornell-box": 179.0}  # m2 of surface
PATCHES = 1500
UNIFORM = (1500, 6000, 24000, 96000)
ADAPTIVE = ((400, 0.03), (1500, 0.012), (1500, 0.008), (1500, 0.005))  # elements to begin with, --refine-error


def bake(hemibake: str, scene: str, folder: pathlib.Path, *options: str) -> dict:
    report = folder / "report.json"
    command = [hemibake, "bake", TRUTH / f"{scene}.glb", "-o", folder / "out.glb", "--scene-linear", "--no-draco",
               "--quiet", "--reference", TRUTH / f"{scene}.hprb", "--report", report,
               "--patch-size", f"{math.sqrt(SCENES[scene] / PATCHES):.4g}", *options]
    subprocess.run(command, check=True, timeout=900)
    return json.loads(report.read_text())


def row(scene: str, kind: str, report: dict) -> tuple[float, float]:
    s, error = report["scene"], report["error"]["reference"]
    print(f"| {scene} | {kind} | {s['coarse_elements']} | {s['elements']} | {s['vertices_out']} "
          f"| {error:.2%} | {report['error']['estimate']:.2%} | {report['time']['total_s']:.2f} |", flush=True)
    return s["elements"], error


def elements_at(error: float, points: list[tuple[float, float]]) -> float | None:
    """Elements at an error, between two points that have it between them; None outside."""
    for (n, e), (m, f) in zip(points, points[1:]):
        if f <= error <= e and f < e:
            share = math.log(e / error) / math.log(e / f)
            return n * (m / n) ** share
    return None


def main() -> None:
    hemibake = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/release/bin/hemibake")
    print("| scene | elements | at first | in all | vertices | error | estimate | seconds |")
    print("|---|---|---:|---:|---:|---:|---:|---:|")
    ratios = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for scene, area in SCENES.items():
            curves: dict[str, list[tuple[float, float]]] = {"uniform": [], "adaptive": []}
            for count in UNIFORM:
                size = f"{math.sqrt(area / count):.4g}"
                report = bake(hemibake, scene, folder, "--element-size", size, "--uniform")
                curves["uniform"].append(row(scene, "uniform", report))
            for count, error in ADAPTIVE:
                size = f"{math.sqrt(area / count):.4g}"
                report = bake(hemibake, scene, folder, "--element-size", size, "--refine-levels", "5",
                              "--refine-error", str(error))
                curves["adaptive"].append(row(scene, "adaptive", report))
            for n, e in curves["adaptive"]:
                m = elements_at(e, curves["uniform"])
                ratios.append((scene, e, n, m))
    print()
    for scene, error, n, m in ratios:
        if m:
            print(f"{scene} at {error:.2%}: {n} adaptive elements, {m:.0f} uniform ones: {m / n:.1f} times fewer")
        else:
            print(f"{scene} at {error:.2%}: {n} adaptive elements; uniform ones of {UNIFORM[0]} to {UNIFORM[-1]} do not "
                  "have this error")


if __name__ == "__main__":
    main()
