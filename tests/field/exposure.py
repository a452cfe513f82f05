# SPDX-License-Identifier: MIT
"""Does --exposure auto give pictures that people keep? Prints a table: scene, burnt %, median, EV, verdict.

    python3 tests/field/exposure.py [HEMIBAKE] [--pictures FOLDER] [FILE or word of a path ...]

Of the cases, the shared scenes, the pavilion and, where tests/corpus/fetch.sh has put it, the corpus, at draft. Right: at most 2 % of what the
preview shows is burnt to white, its median lies between code values 18 and 178, EV within +-20. Of scenes with truth the same is asked of
the probes, which lie evenly on all fronts that can be seen: their true radiance, exposed by that EV. What is black by right is exempt,
pixels of what emits (as white as a lamp has to be) do not count, and neither do those that no light reaches.
"""

import argparse
import glob
import math
import os
import struct
import subprocess
import sys
import tempfile
from json import load

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, HERE)
from baked import Asset, glb, pixels  # noqa: E402

BURNT_MAX, MEDIAN, EV_MAX = 0.02, (18, 178), 20
BLACK_BY_RIGHT = ("black-color0", "closed-no-lamp", "emissive-atlas-black")
PATIENCE_S = 120

# A closed thing with its lamp inside is black from outside, but for the pixels of its edges.
DARK_OUTSIDE = 0.05

SKY = ["--environment", "1,1,1"]
OPTIONS = {
    **{name: SKY for name in ("living-room", "bedroom", "zdm2", "apartment", "garage", "sealed-under-sky", "house-on-ground",
                              "window-sky-1200mm", "window-sky-200mm", "window-bar")},
    "window-open": ["--sun", "0,45,100000"], "window-transmission": ["--sun", "0,45,100000"],
    "trees-250-masked": ["--sun", "150,40,80000"], "trees-400-opaque": ["--sun", "150,40,80000"],
}


def scenes():
    shared = os.path.join(ROOT, "..", "shared")
    found = sorted(glob.glob(os.path.join(shared, "field", "*.glb"))) + sorted(glob.glob(os.path.join(shared, "scenes", "*.glb")))
    found += [os.path.join(ROOT, "samples", name) for name in ("pillar-room.glb", "pavilion/pavilion.glb")]
    for end in ("glb", "gltf"):
        found += sorted(glob.glob(os.path.join(ROOT, "build/corpus/packages", "**", "*." + end), recursive=True))
    return found


def code(linear):
    v = min(max(linear, 0), 1)
    return 255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055)


def soft(rgb):
    """The view Soft (color/hemibake.ocio): what is over half of white rolls off, with its hue kept."""
    brightest = max(rgb)
    scale = (1 + math.log(2 * brightest)) / 2 / brightest if brightest > 0.5 else 1
    return [1 - math.exp(1 - 2 * x * scale) / 2 if x * scale > 0.5 else x * scale for x in rgb]


def middle(values):
    values = sorted(values)
    return values[len(values) // 2] if values else 0


def without_lamps(source, baked, out):
    """The bake with what emits, by materials that no texture makes dark in places, painted black; False where nothing does."""
    lamps = {m.get("name") for m in Asset(source).json.get("materials", [])
             if any(m.get("emissiveFactor", [0])) and "emissiveTexture" not in m} if source.endswith(".glb") else set()
    asset = Asset(baked)
    data, found = bytearray(asset.bin), False
    for primitive in (p for m in asset.json["meshes"] for p in m["primitives"] if "material" in p):
        color = primitive["attributes"].get("COLOR_0")
        if asset.json["materials"][primitive["material"]].get("name") not in lamps or color is None:
            continue
        accessor, found = asset.json["accessors"][color], True
        view = asset.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = {5121: 1, 5123: 2, 5126: 4}[accessor["componentType"]] * {"VEC3": 3, "VEC4": 4}[accessor["type"]]
        stride = view.get("byteStride", width)
        for i in range(accessor["count"]):
            data[start + i * stride:start + i * stride + width * 3 // {"VEC3": 3, "VEC4": 4}[accessor["type"]]] = bytes(
                width * 3 // {"VEC3": 3, "VEC4": 4}[accessor["type"]])
    if found:
        with open(out, "wb") as f:
            f.write(glb(asset.json, bytes(data)))
    return found


def judge_picture(path, dark=None):
    """(share burnt, median) of what is neither background nor black, None where that is next to nothing; dark: the picture with
    its lamps painted black."""
    _, _, rows, step = pixels(path)
    other = pixels(dark)[2] if dark else rows
    background = bytes(rows[0][:3])
    shown = [bytes(row[i:i + 3]) for row, under in zip(rows, other) for i in range(0, len(row), step)
             if row[i:i + 3] == under[i:i + 3] or not dark]
    shown = [p for p in shown if p != background]
    lit = [p for p in shown if max(p) > 0]
    if len(lit) < DARK_OUTSIDE * len(shown):
        return None
    return sum(min(p) == 255 for p in lit) / max(1, len(lit)), middle([0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2] for p in lit])


def judge_probes(path, ev):
    """The same of truth."""
    with open(path, "rb") as f:
        data = f.read()
    count, = struct.unpack_from("<I", data, 4)
    light = [struct.unpack_from("<10f", data, 8 + 40 * i)[6:9] for i in range(count)]
    light = [soft([x * 2 ** ev for x in L]) for L in light if max(L) > 0]
    return sum(code(min(L)) >= 254.5 for L in light) / max(1, len(light)), middle(
        [code(0.2126 * L[0] + 0.7152 * L[1] + 0.0722 * L[2]) for L in light])


def ask(hemibake, path, folder):
    name = os.path.splitext(os.path.basename(path))[0]
    out, picture = os.path.join(folder, name + ".glb"), os.path.join(folder, name + ".png")
    command = [hemibake, "bake", path, "-o", out, "--no-draco", "--quality", "draft", "--preview", picture, "--report", out + ".json", "--quiet",
               "--size", "320x240", *OPTIONS.get(name, [])]
    try:
        ran = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        return print(f"{name:36s} not done after {PATIENCE_S} s", flush=True)
    if ran.returncode not in (0, 4) or not os.path.exists(picture):
        line = (ran.stderr.strip().splitlines() or [""])[-1]
        return print(f"{name:36s} not baked: {line[-110:]}", flush=True)
    with open(out + ".json") as f:
        ev = load(f)["color"]["exposure_ev"]
    dark = None
    if without_lamps(path, out, out + ".dark.glb"):
        dark = out + ".dark.png"
        subprocess.run([hemibake, "render", out + ".dark.glb", "-o", dark, "--size", "320x240"], capture_output=True, check=True)
        subprocess.run([hemibake, "render", out, "-o", picture, "--size", "320x240"], capture_output=True, check=True)
    judged = judge_picture(picture, dark)
    rows = [("picture", *judged)] if judged else []
    probes = os.path.splitext(path)[0] + ".hprb"
    if os.path.exists(probes):
        rows.append(("probes", *judge_probes(probes, ev)))
    verdicts = []
    if not rows:
        print(f"{name[:36]:36s} picture  black from outside{'':17s}EV {ev:+7.2f}  exempt", flush=True)
    for what, burnt, median in rows:
        right = burnt <= BURNT_MAX and MEDIAN[0] <= median <= MEDIAN[1] and abs(ev) <= EV_MAX
        exempt = name in BLACK_BY_RIGHT
        verdicts.append(right or exempt)
        word = "exempt" if exempt else "right" if right else "WRONG"
        print(f"{name[:36]:36s} {what:8s} burnt {100 * burnt:5.1f} %  median {median:5.0f}  EV {ev:+7.2f}  {word}", flush=True)
    return all(verdicts)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--pictures", help="where the previews stay")
    parser.add_argument("words", nargs="*")
    asked = parser.parse_intermixed_args()
    hemibake = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
    if asked.words and os.path.isfile(asked.words[0]) and os.access(asked.words[0], os.X_OK):
        hemibake = asked.words.pop(0)
    chosen = [p for p in scenes() if not asked.words or any(w in p for w in asked.words)]
    if not chosen:
        print("skipped: no such scene is here")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        results = [ask(hemibake, path, asked.pictures or folder) for path in chosen]
    judged = [r for r in results if r is not None]
    print(f"{sum(judged)} of {len(judged)} right, {len(results) - len(judged)} not baked")
    return 0 if all(judged) else 1


if __name__ == "__main__":
    sys.exit(main())
