# SPDX-License-Identifier: MIT
"""Does hemibake bake USD stages, and say in one line what it cannot?"""

import json
import os
import stat
import unittest
from unittest import mock

from command import BAD_INPUT, USAGE, CommandCase, main
from gltf_file import Asset, png, room
from usd_file import SKY, UsdCase, primitives, quad, shaded

# Radiance of a sky that is the same everywhere is exact but for float32 and the directions it is looked for in.
EVEN = 2e-3

# Where the middle of a face of a cube of half side 1 is on its Catmull-Clark surface: (16 p + 4 sum of edges + sum of faces) / 36.
LIMIT = (16 + 4 * 4 * 3 / 4 + 4 * 5 / 9) / 36

CUBE = """def Mesh "Cube" {{
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3]
    point3f[] points = [(-1, -1, -1), (-1, -1, 1), (-1, 1, -1), (-1, 1, 1), (1, -1, -1), (1, -1, 1), (1, 1, -1), (1, 1, 1)]
    {more}
}}
"""


def textured(name, space):
    """A square with a picture of its own space."""
    picture = f"""def Shader "T" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @./grey.png@
        token inputs:sourceColorSpace = "{space}"
        float3 outputs:rgb
    }}"""
    look = shaded(f"M{name}", f"color3f inputs:diffuseColor.connect = </World/M{name}/T.outputs:rgb>", picture)
    return quad(name, f"rel material:binding = </World/M{name}>") + look


class Reader(CommandCase):
    """Whatever becomes of the reader of USD, the program says one line."""

    def fake_python(self, script):
        path = self.write("python", f"#!/bin/sh\n{script}\n".encode())
        os.chmod(path, stat.S_IRWXU)
        return path

    def fail_with(self, python, **more):
        self.write("a.usda", b"#usda 1.0\n")
        environment = {**os.environ, "HEMIBAKE_USD_PYTHON": python, **more}
        ran = self.run_hemibake("bake", "a.usda", "-o", "out.glb", env=environment)
        self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
        self.assertEqual(len(ran.stderr.splitlines()), 1, ran.stderr)
        self.assertEqual([name for name in self.left() if name.startswith("out")], [])
        return ran.stderr

    def test_a_missing_python_is_told_with_the_pip_command(self):
        self.assertIn("pip install usd-core", self.fail_with(self.path("nowhere")))

    def test_a_crash_of_the_reader_is_one_line(self):
        self.assertIn("signal 11", self.fail_with(self.fake_python("kill -SEGV $$")))

    def test_a_reader_that_does_not_end_is_ended(self):
        self.assertIn("ended after 1 s", self.fail_with(self.fake_python("sleep 100"), HEMIBAKE_USD_TIME_LIMIT="1"))

    def test_the_words_of_the_reader_are_passed_on(self):
        self.assertIn("a.usda: no, thanks", self.fail_with(self.fake_python("echo 'error: no, thanks' >&2; exit 1")))

    def test_what_python_itself_says_last_is_told(self):
        said = self.fail_with(self.fake_python("echo one >&2; echo 'No module named hemibake' >&2; exit 1"))
        self.assertIn("ended with status 1: No module named hemibake", said)
        self.assertIn("and no word", self.fail_with(self.fake_python("exit 1")))

    def test_gltf_needs_no_python(self):
        self.write("room.glb", room().glb())
        with mock.patch.dict(os.environ, HEMIBAKE_USD_PYTHON=self.path("nowhere")):
            self.bake("room.glb", "out.glb", "--quality", "draft")

    def test_a_layer_needs_a_stage(self):
        self.write("room.glb", room().glb())
        self.succeed("bake", "room.glb", "-o", "out.glb", "--layer", "l.usda", status=USAGE)


class Reading(UsdCase):
    def test_an_even_sky_shows_the_colour_of_what_it_lights(self):
        found = self.radiance(self.stage(quad("A", color="(0.8, 0.5, 0.2)") + SKY))
        for got, want in zip(found["/World/A"], (0.8, 0.5, 0.2)):
            self.assertAlmostEqual(got, want, delta=EVEN)

    def test_a_stage_is_known_by_its_first_bytes(self):
        scene = self.stage(quad("A") + SKY, name="stage")
        self.assertIn("/World/A", self.radiance(scene))

    def test_what_is_inactive_invisible_or_a_guide_is_not_there(self):
        body = (
            quad("Seen") + quad("Hidden", 'token visibility = "invisible"') + quad("Guide", 'uniform token purpose = "guide"')
            + 'def Mesh "Off" (\nactive = false\n) {}\n' + 'class Xform "Class" {' + quad("InClass") + "}\n" + SKY
        )  # fmt: skip
        self.assertEqual(list(self.radiance(self.stage(body))), ["/World/Seen"])

    def test_a_lamp_lights_and_is_written_only_if_kept(self):
        lamp = """def RectLight "Lamp" {
    float inputs:intensity = 100
    double3 xformOp:translate = (0, 2, 0)
    float xformOp:rotateX = -90
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
}
"""
        scene = self.stage(quad("Probe", half=0.01) + lamp)
        found = self.radiance(scene)
        self.assertEqual(list(found), ["/World/Probe"])
        # rho L F, F of a square of 1 m on the axis, 2 m away; draft hemi-cubes are off by up to 1 %.
        self.assertAlmostEqual(found["/World/Probe"][0] / (0.5 * 100 * 0.0734776), 1, delta=0.01)
        self.assertIn("/World/Lamp", self.radiance(scene, "--keep-lamps"))

    def test_a_lamp_that_is_not_written_darkens_nothing(self):
        """The body of a lamp of no power, a metre across and half a metre above: under a sky it is missed only if it is a thing."""
        lamp = 'def RectLight "Lamp" {\n    float inputs:intensity = 1e-9\n    double3 xformOp:translate = (0, 0.5, 0)\n    float xformOp:rotateX = -90\n' \
               '    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]\n}\n'
        scene = self.stage(quad("Probe", half=0.01) + lamp + SKY)
        self.assertAlmostEqual(self.radiance(scene)["/World/Probe"][0], 0.5, delta=EVEN)
        # A square of one metre half a metre away hides 0.5541 of the sky; rays of draft are off by a few per cent.
        self.assertAlmostEqual(self.radiance(scene, "--keep-lamps")["/World/Probe"][0], 0.5 * (1 - 0.5541), delta=0.02)

    def test_round_shapes_are_lit_as_round_ones(self):
        """By the cosine of the angle to a sun along x; facets of 11 degrees are off by a sixth beside their edges."""
        body = 'def Cylinder "Round" {\n    double radius = 1\n    double height = 2\n    token axis = "Y"\n}\n' \
               'def DistantLight "Sun" {\n    float inputs:intensity = 1e5\n    float xformOp:rotateY = 90\n    uniform token[] xformOpOrder = ["xformOp:rotateY"]\n}\n'
        self.radiance(self.stage(body), "--merge-error", "0")
        (_, primitive), = primitives(Asset(self.path("out.glb")))
        asset = Asset(self.path("out.glb"))
        points, light = (asset.values(primitive["attributes"][name]) for name in ("POSITION", "_RADIOSITY"))
        side = [(x, L[0]) for (x, y, z), L in zip(points, light) if abs(y) < 0.9 and x > 0.3]
        most = max(L for _, L in side)
        self.assertGreater(len(side), 20)
        for x, L in side:
            self.assertAlmostEqual(L / most, x, delta=0.03)

    def test_a_cage_reaches_its_limit(self):
        cube = CUBE.format(more="")
        self.radiance(self.stage(cube + SKY))
        asset = Asset(self.path("out.glb"))
        _, primitive = next(primitives(asset))
        reach = max(abs(v) for row in asset.values(primitive["attributes"]["POSITION"]) for v in row)
        self.assertAlmostEqual(reach, LIMIT, delta=1e-5)
        self.radiance(self.stage(cube + SKY), "--subdivide", "0")
        asset = Asset(self.path("out.glb"))
        self.assertEqual(max(max(row) for row in asset.values(next(primitives(asset))[1]["attributes"]["POSITION"])), 1)

    def test_a_raw_picture_is_linear_and_another_is_srgb(self):
        self.write("grey.png", png(4, 4, lambda y, x: (128, 128, 128)))
        body = "".join(textured(name, space) for name, space in (("Raw", "raw"), ("Srgb", "sRGB"), ("Auto", "auto")))
        found = self.radiance(self.stage(body + SKY))
        self.assertAlmostEqual(found["/World/Raw"][0], 128 / 255, delta=EVEN)
        for name in ("Srgb", "Auto"):
            self.assertAlmostEqual(found[f"/World/{name}"][0], ((128 / 255 + 0.055) / 1.055) ** 2.4, delta=EVEN)

    def test_faces_of_a_cage_have_their_materials_and_one_limit(self):
        subset = """def GeomSubset "S" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    ) {
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [0, 2]
        rel material:binding = </World/Dark>
    }
"""
        self.radiance(self.stage(CUBE.format(more=subset) + shaded("Dark", "color3f inputs:diffuseColor = (0.2, 0.2, 0.2)") + SKY))
        asset = Asset(self.path("out.glb"))
        found = {round(asset.values(p["attributes"]["_RADIOSITY"])[0][0], 2): asset.values(p["attributes"]["POSITION"]) for _, p in primitives(asset)}
        self.assertEqual(sorted(found), [0.2, 0.5])
        for rows in found.values():
            self.assertAlmostEqual(max(abs(v) for row in rows for v in row), LIMIT, delta=1e-5)

    def test_losses_are_lines_with_paths_and_in_the_report(self):
        body = quad("A") + SKY + 'def BasisCurves "Hair" {}\n' + 'def Mesh "Broken" {\n int[] faceVertexCounts = [4]\n int[] faceVertexIndices = [0]\n }\n'
        ran = self.bake(self.stage(body), "out.glb", "--quality", "draft", "--report", "r.json")
        with open(self.path("r.json")) as f:
            losses = json.load(f)["usd"]["losses"]
        for path in ("/World/Hair", "/World/Broken"):
            self.assertIn(path, ran.stderr)
            self.assertTrue(any(line.startswith(path + ": ") for line in losses), losses)

    def test_the_depfile_names_every_layer(self):
        self.write("part.usda", b'#usda 1.0\n(\ndefaultPrim = "P"\n)\ndef Xform "P" {\n' + quad("Q").encode() + b"}\n")
        scene = self.stage('def "Part" (\nreferences = @./part.usda@\n) {}\n' + SKY)
        self.bake(scene, "out.glb", "--quality", "draft", "--depfile", "out.d")
        self.assertIn("part.usda", self.read("out.d").decode())
        whole = self.stage(quad("A") + SKY, "same.usda")
        self.stage(quad("A") + SKY, "whole.usda")
        layered = self.write("layered.usda", b"#usda 1.0\n(\nsubLayers = [@./whole.usda@]\nmetersPerUnit = 1\nupAxis = \"Y\"\n)\n")
        self.bake(whole, "out.glb", "--quality", "draft", "--depfile", "out.d", "--lights-from", layered)
        self.assertIn("whole.usda", self.read("out.d").decode())

    def test_a_variant_that_is_not_there_is_told(self):
        scene = self.stage(quad("A") + SKY)
        ran = self.run_hemibake("bake", scene, "-o", "out.glb", "--variant", "/World{look=red}")
        self.assertEqual((ran.returncode, len(ran.stderr.splitlines())), (BAD_INPUT, 1), ran.stderr)
        self.assertIn("/World has no variant set 'look'", ran.stderr)

    def test_a_room_is_the_same_as_usd_and_as_gltf(self):
        self.write("room.glb", room().glb())
        body = "".join(mesh_of(Asset(self.path("room.glb")), name) for name in ("room", "box", "lamp"))
        self.bake("room.glb", "g.glb", "--quality", "draft", "--scene-linear", "--no-draco")
        self.radiance(self.stage(body))
        a, b = Asset(self.path("g.glb")), Asset(self.path("out.glb"))
        for name in ("room", "box"):
            rows = [x.values(x.primitives(name)[0]["attributes"]["_RADIOSITY"]) for x in (a, b)]
            self.assertEqual(len(rows[0]), len(rows[1]))
            for one, other in zip(*rows):
                for p, q in zip(one, other):
                    self.assertAlmostEqual(p, q, delta=1e-3 * max(p, 1e-3))


def mesh_of(asset, name):
    """A mesh of a glTF as USD: triangles, with a UsdPreviewSurface of its own."""
    primitive = asset.primitives(name)[0]
    material = asset.json["materials"][primitive["material"]]
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    points = ", ".join(str(p) for p in asset.values(primitive["attributes"]["POSITION"]))
    indices = [row[0] for row in asset.values(primitive["indices"])]
    base, glow = tuple(material["pbrMetallicRoughness"]["baseColorFactor"][:3]), tuple(strength * e for e in material["emissiveFactor"])
    return f"""def Mesh "{name}" (
    prepend apiSchemas = ["MaterialBindingAPI"]
) {{
    int[] faceVertexCounts = {[3] * (len(indices) // 3)}
    int[] faceVertexIndices = {indices}
    point3f[] points = [{points}]
    uniform token subdivisionScheme = "none"
    rel material:binding = </World/M_{name}>
}}
""" + shaded(f"M_{name}", f"color3f inputs:diffuseColor = {base}\n        color3f inputs:emissiveColor = {glow}")


if __name__ == "__main__":
    main()
