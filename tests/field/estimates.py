# SPDX-License-Identifier: MIT
"""Does a bake's estimate of its error come to within a factor 2 of the truth? Prints a table: scene, quality, error, noise, estimate, verdict.

    python3 tests/field/estimates.py [HEMIBAKE] [--quality draft|medium|high|all] [--samples N] [word of a path ...]

Of the shared scenes and rooms, whose truth lies beside them, and of the cases that the path tracer of tests/oracle knows (which leaves out
what blends and takes glass for opaque): their truth is traced here, at points spread by area over what was baked and does not emit. The
noise of truth is subtracted in squares; an error of less than twice the noise is not judged.
"""

import argparse
import glob
import math
import os
import random
import struct
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, HERE)
from baked import Asset, Bench, dot  # noqa: E402
from exposure import OPTIONS  # noqa: E402

QUALITIES = ("draft", "medium", "high")
# Of few points hardly any lie where errors are, along the edge of a light: of 600 the error of a sharp spot was 2.9 %, of 3,000,000 it is 7.0 %.
FACTOR, POINTS, OF_NOISE = 2.0, 4000, 2.0

# The tracer has no panes, no profiles; the rest is black by right, takes minutes, or is another case with what does not matter added.
NOT_TRACED = ("emissive-atlas-spot",  # whose spot its paths find by chance only
              "smooth-ball-12x6",  # whose facets are in their own shade there
              "bulb-in-shade", "window-transmission", "ies-only", "closed-no-lamp", "black-color0", "emissive-atlas-black", "variants",
              "trees-250-masked", "trees-400-opaque", "animated-door", "animated-root", "node-hidden", "day-night", "lod", "walls-blend-alpha-1")


def rows_of(path):
    with open(path, "rb") as f:
        data = f.read()
    count, = struct.unpack_from("<I", data, 4)
    return [struct.unpack_from("<10f", data, 8 + 40 * i) for i in range(count)]


def write_rows(path, rows):
    with open(path, "wb") as f:
        f.write(b"HPRB" + struct.pack("<I", len(rows)) + b"".join(struct.pack("<10f", *row) for row in rows))


def emits(material):
    return any(material.get("emissiveFactor", [])) and "emissiveTexture" not in material


def places(asset, bake):
    """Points of the triangles of a bake, by area, without the nodes that emit all over."""
    materials = asset.json.get("materials", [])
    lamps = {node.get("name") for node in asset.json["nodes"] if "mesh" in node
             for p in asset.json["meshes"][node["mesh"]]["primitives"] if "material" in p and emits(materials[p["material"]])}
    triangles = [t for name, all_of in bake.nodes().items() if name not in lamps for t in all_of]
    chance, rows = random.Random(1), []
    for t in chance.choices(triangles, [t.twice_area for t in triangles], k=POINTS):
        u, v = chance.random(), chance.random()
        w = (1 - u - v, u, v) if u + v < 1 else (u + v - 1, 1 - u, 1 - v)
        rows.append([sum(x * c[k] for x, c in zip(w, t.corners)) for k in range(3)] + t.normal + [0] * 4)
    return rows


def trace(scene, bake, folder, options, samples):
    """The path of a truth of our own."""
    tracer = os.path.join(os.path.dirname(bake.hemibake), "..", "tests", "oracle", "pathtrace")
    here = os.path.join(folder, "places.hprb")
    truth = os.path.join(folder, os.path.basename(scene) + ".hprb")
    if os.path.exists(truth):
        return truth
    done = bake.bake(scene, *options)
    if not done.asset or not os.path.exists(tracer):
        return None
    write_rows(here, places(Asset(scene), done))
    subprocess.run([tracer, scene, here, "--samples", str(samples), "-o", truth, *options], capture_output=True, check=True)
    return truth


def noise_of(truth):
    rows = rows_of(truth)
    # The standard error of a row is that of the mean of its bands.
    squares = sum(dot(row[6:9], row[6:9]) for row in rows)
    return math.sqrt(3 * sum(row[9] ** 2 for row in rows) / squares) if squares else 0


def judge(scene, truth, bench, options):
    bake = bench.bake(scene, *options, "--reference", truth)
    name = os.path.splitext(os.path.basename(scene))[0]
    found = bake.report.get("error", {})
    if not bake.asset or found["reference"] is None:
        return print(f"{name:22s} {bench.quality:7s} not compared: {bake.text.strip().splitlines()[-1:]}", flush=True)
    noise = noise_of(truth)
    error, estimate = found["reference"], found["estimate"]
    true = math.sqrt(max(error ** 2 - noise ** 2, 0))
    judged = error > OF_NOISE * noise and estimate is not None
    right = not judged or true / FACTOR <= estimate <= true * FACTOR
    word = "right" if judged and right else "WRONG" if judged else "not judged"
    print(f"{name:22s} {bench.quality:7s} error {true:8.2%}  noise {noise:6.2%}  estimate {estimate or 0:8.2%}  "
          f"{true / estimate if estimate else 0:6.2f}  {bake.report['scene'].get('method') or '':8s} {word}", flush=True)
    return right


def scenes():
    shared = os.path.join(ROOT, "..", "shared")
    with_truth = glob.glob(os.path.join(shared, "scenes", "*.glb")) + glob.glob(os.path.join(ROOT, "tests", "accuracy", "truth", "*.glb"))
    cases = [path for path in glob.glob(os.path.join(shared, "field", "*.glb"))
             if os.path.splitext(os.path.basename(path))[0] not in NOT_TRACED]
    return sorted(with_truth) + sorted(cases)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--quality", choices=(*QUALITIES, "all"), default="draft")
    parser.add_argument("--samples", type=int, default=1024, help="paths of a point that is traced here")
    parser.add_argument("words", nargs="*")
    asked = parser.parse_intermixed_args()
    hemibake = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
    if asked.words and os.path.isfile(asked.words[0]) and os.access(asked.words[0], os.X_OK):
        hemibake = os.path.abspath(asked.words.pop(0))
    chosen = [path for path in scenes() if not asked.words or any(w in path for w in asked.words)]
    if not chosen:
        print("skipped: no such scene is here")
        return 77
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for scene in chosen:
            options = OPTIONS.get(os.path.splitext(os.path.basename(scene))[0], [])
            truth = os.path.splitext(scene)[0] + ".hprb"
            for quality in QUALITIES if asked.quality == "all" else (asked.quality,):
                bench = Bench(hemibake, folder, folder, quality)
                path = truth if os.path.exists(truth) else trace(scene, bench, folder, options, asked.samples)
                results.append(judge(scene, path, bench, options) if path else None)
    judged = [r for r in results if r is not None]
    print(f"{sum(judged)} of {len(judged)} right or not judged, {len(results) - len(judged)} not compared")
    return 0 if all(judged) else 1


if __name__ == "__main__":
    sys.exit(main())
