# SPDX-License-Identifier: MIT
"""What does a mesh of a million triangles cost? A sphere in a room, at several densities: patches, time and memory of the
whole process, and how far the light on sphere and room is from that beside a sphere of 5,000 triangles that is solved as it is.

    HEMIBAKE=build/release/bin/hemibake python3 tests/bench/dense.py [QUALITY]
"""

import json
import math
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(ROOT, "tests", "cli"))
import gltf_file  # noqa: E402

HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))

ROOM, HEIGHT = 2.0, 3.0  # half the width, and the height, m
RADIUS, CENTER = 0.5, (0.3, 0.5, 0.2)
# Around the sphere: 5,000 to 1,000,000 triangles; the first is solved as it is, with two elements to a triangle's edge.
SPHERES = ((70, "0"), (70, "0.035"), (316, "0.035"), (1000, "0.035"))

LIMITS = {"patches": 2000, "seconds": 30.0, "MiB": 1536}


def scene(segments):
    """A sphere that rests on the floor under a lamp."""
    made = gltf_file.Scene()
    white, red = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("red", (0.7, 0.3, 0.2))
    light = made.add_material("lamp", (0, 0, 0), (10, 10, 10))
    made.add_mesh("room", gltf_file.box((-ROOM, 0, -ROOM), (ROOM, HEIGHT, ROOM), inward=True), white)
    made.add_mesh("sphere", gltf_file.sphere(segments, CENTER, RADIUS), red)
    made.add_mesh("lamp", gltf_file.lamp(0.4, HEIGHT - 0.1), light)
    return made.glb()


def bake(folder, segments, *options):
    """The report and the path of the baked asset."""
    scene_path, out, report = (os.path.join(folder, name) for name in ("in.glb", "out.glb", "report.json"))
    with open(scene_path, "wb") as f:
        f.write(scene(segments))
    subprocess.run([HEMIBAKE, "bake", scene_path, "-o", out, "--quiet", "--report", report, *options], check=True, timeout=600)
    with open(report, encoding="utf-8") as f:
        return json.load(f), out


class Light:
    """Radiance of a bake with --scene-linear --no-draco by mesh."""

    def __init__(self, path):
        asset = gltf_file.Asset(path)
        self.of = {}
        for name in ("room", "sphere"):
            rows = []
            for primitive in asset.primitives(name):
                rows += zip(asset.values(primitive["attributes"]["POSITION"]), asset.values(primitive["attributes"]["_RADIOSITY"]))
            self.of[name] = rows


def on_sphere(light, segments, by=SPHERES[0][0]):
    """Radiance at the vertices of the first sphere, by their row and column; of another sphere at the vertex nearest."""
    rings, found = segments // 2 + 1, {}
    for p, rgb in light.of["sphere"]:
        d = [(x - c) / RADIUS for x, c in zip(p, CENTER)]
        row, column = math.acos(max(-1.0, min(1.0, d[1]))) / math.pi * rings, math.atan2(-d[2], d[0]) / (2 * math.pi) % 1.0 * segments
        # Vertices that elements add lie between the rows, and inside the sphere.
        if abs(math.hypot(*d) - 1) < 1e-5:
            found[round(row), round(column) % segments] = rgb[0]
    rows, at = by // 2 + 1, {}
    for row in range(1, rows):
        for column in range(by):
            key = round(row * rings / rows), round(column * segments / by) % segments
            if key in found:
                at[row, column] = found[key]
    return at


def in_room(light):
    return {tuple(round(x, 4) for x in p): rgb[0] for p, rgb in light.of["room"]}


def difference(a, b):
    """Root mean square of the difference where both know something, relative to that of b."""
    common = sorted(set(a) & set(b))
    return math.sqrt(sum((a[k] - b[k]) ** 2 for k in common) / sum(b[k] ** 2 for k in common))


def main():
    quality = sys.argv[1] if len(sys.argv) > 1 else "medium"
    print(f"{'triangles':>9} {'solved on':>9} {'deviation':>9} {'patches':>7} {'elements':>8} {'hemi-cubes':>10} {'seconds':>7} "
          f"{'MiB':>6} {'estimate':>8} {'sphere':>7} {'room':>7}")
    first = None
    with tempfile.TemporaryDirectory() as folder:
        for segments, stand_in in SPHERES:
            options = ["--quality", quality, "--stand-in", stand_in]
            light = Light(bake(folder, segments, *options, "--scene-linear", "--no-draco")[1])
            report, _ = bake(folder, segments, *options)
            first, s, triangles = first or light, report["scene"], segments * 2 * (segments // 2)
            figures = {"patches": s["patches"], "seconds": report["time"]["total_s"], "MiB": report["memory"]["peak_bytes"] / 2**20}
            print(f"{triangles:9} {s['stand_in_triangles'] or triangles:9} {s['stand_in_deviation']:9.5f} {s['patches']:7} "
                  f"{s['elements']:8} {report['solver']['hemicubes']:10} {figures['seconds']:7.2f} {figures['MiB']:6.0f} "
                  f"{report['error']['estimate']:8.2%} {difference(on_sphere(light, segments), on_sphere(first, SPHERES[0][0])):7.2%} "
                  f"{difference(in_room(light), in_room(first)):7.2%}", flush=True)
    within = all(figures[key] <= limit for key, limit in LIMITS.items())
    print(f"a million triangles: {'within' if within else 'NOT within'} {LIMITS}")
    return 0 if within else 1


if __name__ == "__main__":
    sys.exit(main())
