# SPDX-License-Identifier: MIT
"""What do tests of USD share? A Python with pxr, stages as text, and the meshes of an output by the path of their prims."""

import os
import subprocess
import sys
import unittest

from command import CommandCase
from gltf_file import Asset

# The tests' own Python reads USD, whatever the machine's user has elsewhere.
os.environ["HEMIBAKE_USD_PYTHON"] = sys.executable

HEAD = '#usda 1.0\n(\n    defaultPrim = "World"\n    metersPerUnit = {meters}\n    upAxis = "{up}"\n)\n'
SKY = 'def DomeLight "Sky" {\n    float inputs:intensity = 1\n}\n'


def has(module):
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True, check=False).returncode == 0


HAS_PXR, HAS_PILLOW = has("pxr"), has("PIL")


def quad(name, more="", half=0.1, y=0.0, scheme="none", color="(0.5, 0.5, 0.5)"):
    """A square that faces up."""
    return f"""def Mesh "{name}" {{
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [({-half}, {y}, {half}), ({half}, {y}, {half}), ({half}, {y}, {-half}), ({-half}, {y}, {-half})]
    color3f[] primvars:displayColor = [{color}]
    uniform token subdivisionScheme = "{scheme}"
    {more}
}}
"""


def shaded(name, inputs, more=""):
    """A material with a UsdPreviewSurface."""
    return f"""def Material "{name}" {{
    token outputs:surface.connect = </World/{name}/S.outputs:surface>
    def Shader "S" {{
        uniform token info:id = "UsdPreviewSurface"
        {inputs}
        token outputs:surface
    }}
    {more}
}}
"""


@unittest.skipUnless(HAS_PXR, "usd-core cannot be had in the Python of the tests")
class UsdCase(CommandCase):
    def stage(self, body, name="stage.usda", meters=1, up="Y"):
        text = HEAD.format(meters=meters, up=up) + 'def Xform "World" {\n' + body + "}\n"
        return self.write(name, text.encode())

    def radiance(self, scene, *options):
        """Mean radiance of each mesh by the path of its prim."""
        self.bake(scene, "out.glb", "--quality", "draft", "--scene-linear", "--no-draco", *options)
        return mean_radiance(Asset(self.path("out.glb")))


def primitives(asset):
    """(path of the prim, primitive) of every mesh of an output."""
    for node in asset.json["nodes"]:
        if "mesh" in node:
            for primitive in asset.json["meshes"][node["mesh"]]["primitives"]:
                yield node["extras"]["usd"]["path"], primitive


def mean_radiance(asset):
    out = {}
    for path, primitive in primitives(asset):
        rows = asset.values(primitive["attributes"]["_RADIOSITY"])
        out[path] = tuple(sum(row[k] for row in rows) / len(rows) for k in range(3))
    return out
