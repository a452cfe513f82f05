# SPDX-License-Identifier: MIT
"""What do the views of the configuration inside make of bright places? Prints the table of color/README.md.

    python3 tests/color/views.py [HEMIBAKE]

Bakes the pillar room and the pavilion at draft as radiance, exposes both as --exposure auto does, and takes vertices of what does not
emit through each view, by OpenColorIO's Python bindings (tests/install-python.sh). Clipped: a band beyond the display. Changed: mean
difference in code values from Standard where that clips nothing. Hue: mean angle in the plane of opponent colours between what is
shown and what is true, of coloured vertices brighter than white. The brightest tenth: between its edge and the last thousandth.
"""

import json
import os
import subprocess
import sys
import tempfile

import numpy
import PyOpenColorIO as ocio

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tests/field"))
from baked import Asset  # noqa: E402

SCENES = ("pillar-room.glb", "pavilion/pavilion.glb")
VIEWS = ("Soft", "Standard", "ACES 1.x SDR", "Filmic")
LUMINANCE = numpy.array((0.2126, 0.7152, 0.0722))


def radiance(hemibake, scene, folder):
    """Exposed radiance of the vertices of what does not emit, n x 3."""
    out, report = os.path.join(folder, "out.glb"), os.path.join(folder, "out.json")
    command = [hemibake, "bake", os.path.join(ROOT, "samples", scene), "-o", out, "--quality", "draft", "--no-draco", "-q", "--report", report]
    subprocess.run(command, check=True)
    with open(report) as f:
        ev = json.load(f)["color"]["exposure_ev"]
    subprocess.run([*command, "--scene-linear"], check=True)
    source, asset = Asset(os.path.join(ROOT, "samples", scene)), Asset(out)
    lamps = {m.get("name") for m in source.json["materials"] if any(m.get("emissiveFactor", [0]))}
    found = []
    for primitive in (p for m in asset.json["meshes"] for p in m["primitives"] if "_RADIOSITY" in p["attributes"]):
        if asset.json["materials"][primitive["material"]].get("name") in lamps:
            continue
        accessor = asset.json["accessors"][primitive["attributes"]["_RADIOSITY"]]
        view = asset.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        found.append(numpy.frombuffer(asset.bin, "<f4", 3 * accessor["count"], start).reshape(-1, 3))
    return numpy.concatenate(found) * numpy.float32(2.0 ** ev)


def hue(rgb):
    """Angle in the plane across grey."""
    return numpy.arctan2(numpy.sqrt(3) * (rgb[:, 1] - rgb[:, 2]), 2 * rgb[:, 0] - rgb[:, 1] - rgb[:, 2])


def shown(config, view, rgb):
    """(linear values on the display, before its range; code values)."""
    linear = ocio.GroupTransform([ocio.DisplayViewTransform(src="Linear Rec.709", display="sRGB", view=view),
                                  ocio.ExponentWithLinearTransform(gamma=[2.4] * 3 + [1], offset=[0.055] * 3 + [0])])
    out = rgb.copy()
    config.getProcessor(linear).getDefaultCPUProcessor().applyRGB(out)
    x = numpy.clip(out, 0, 1)
    return out, 255 * numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def main():
    hemibake = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "build/release/bin/hemibake")
    config = ocio.Config.CreateFromFile(os.path.join(ROOT, "color/hemibake.ocio"))
    with tempfile.TemporaryDirectory() as folder:
        rgb = numpy.concatenate([radiance(hemibake, scene, folder) for scene in SCENES])
    plain, right = shown(config, "Standard", rgb)[1], rgb.max(1) <= 1
    colored = ~right & (rgb.min(1) < 0.8 * rgb.max(1))
    for view in VIEWS:
        linear, code = shown(config, view, rgb)
        turned = numpy.abs(numpy.angle(numpy.exp(1j * (hue(numpy.clip(linear, 0, 1)) - hue(rgb)))))[colored]
        edge, last = numpy.quantile(code @ LUMINANCE, (0.9, 0.999))
        print(f"| {view} | {100 * (linear.max(1) > 1 + 1e-5).mean():.1f} % | {numpy.abs(code - plain)[right].mean():.1f} | "
              f"{numpy.degrees(turned.mean()):.1f}° | {edge:.0f} to {last:.0f} |")


if __name__ == "__main__":
    main()
