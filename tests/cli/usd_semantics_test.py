# SPDX-License-Identifier: MIT
"""Do lamps, instances, pictures and what is left out mean what their schemas say? By closed forms."""

import json
import math
import os
import struct
import subprocess
import sys
import unittest

from command import ROOT, main
from gltf_file import Asset, png
from usd_file import HAS_PILLOW, SKY, UsdCase, mean_radiance, primitives, quad, shaded

EVEN = 2e-3  # of an even sky, as in usd_test.py
DRAFT = 0.025  # of a lamp at draft: hemi-cubes, and a ball of flat faces

DOWN = """    double3 xformOp:translate = (0, 2, 0)
    float xformOp:rotateX = -90
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
"""


def lamp(kind, inputs, apis=""):
    """Two metres above the middle, looking down."""
    return f'def {kind} "Lamp" ({apis}) {{\n{inputs}\n{DOWN}}}\n'


def cone(angle, softness, focus):
    return f"float inputs:shaping:cone:angle = {angle}\nfloat inputs:shaping:cone:softness = {softness}\nfloat inputs:shaping:focus = {focus}\n"


def confined(cosine, angle, softness, focus):
    """What ShapingAPI multiplies radiance by."""
    begin, end = math.radians(angle * (1 - softness)), math.radians(angle)
    x = min(max((math.acos(min(cosine, 1)) - begin) / (end - begin), 0), 1)
    return (1 - x * x * (3 - 2 * x)) * cosine**focus


def probes(places):
    return "".join(quad(f"P{i}", half=0.01).replace('subdivisionScheme = "none"', f'subdivisionScheme = "none"\n double3 xformOp:translate = ({x}, 0, 0)\n uniform token[] xformOpOrder = ["xformOp:translate"]') for i, x in enumerate(places))


class Lamps(UsdCase):
    def test_a_cone_confines_a_square_that_is_near(self):
        how, at, n = (30, 0.5, 1), (0.0, 0.6, 1.0), 60
        body = probes(at) + lamp("RectLight", "float inputs:intensity = 100\n" + cone(*how), 'prepend apiSchemas = ["ShapingAPI"]')
        found = self.radiance(self.stage(body))
        steps = [(k + 0.5) / n - 0.5 for k in range(n)]
        for i, x in enumerate(at):
            # Both cosines are 2 / d.
            arriving = sum(confined(2 / d, *how) * (2 / d) ** 2 / d**2 for d in (math.sqrt(4 + (x - u) ** 2 + v * v) for u in steps for v in steps)) / n**2
            self.assertAlmostEqual(found[f"/World/P{i}"][0] / (0.5 / math.pi * 100 * arriving), 1, delta=0.03)

    def test_a_cone_confines_a_ball_and_ends(self):
        how, at, radius = (30, 0.5, 2), (0.0, 0.9, 1.3), 0.05
        body = probes(at) + lamp("SphereLight", f"float inputs:intensity = 100\nfloat inputs:radius = {radius}\n" + cone(*how), 'prepend apiSchemas = ["ShapingAPI"]')
        found = self.radiance(self.stage(body))
        for i, x in enumerate(at):
            d = math.hypot(2, x)
            want = 0.5 * 100 * radius**2 * confined(2 / d, *how) * (2 / d) / d**2
            self.assertAlmostEqual(found[f"/World/P{i}"][0], want, delta=0.03 * want)

    def test_the_estimate_knows_all_of_a_ball_that_light_passes(self):
        """Its hundreds of patches emit, and no hemi-cube shows them: bodies of lamps are in no light's way."""
        body = quad("P", half=1) + lamp("SphereLight", "float inputs:intensity = 100\nfloat inputs:radius = 0.5")
        for quality in ("draft", "medium"):
            self.radiance(self.stage(body), "--method", "hybrid", "--quality", quality, "--report", "report.json")
            estimate = json.loads(self.read("report.json"))["error"]["estimate"]
            print(f"ball of 0.5 m above 2 m, {quality}: {100 * estimate:.2f} % (estimate)")
            self.assertLess(estimate, 0.02)

    def test_a_line_without_a_radius_is_a_light_if_its_power_is_given(self):
        line = "float inputs:intensity = 100\nbool inputs:normalize = {}\nbool treatAsLine = 1\nfloat inputs:radius = 0\nfloat inputs:length = 0.05"
        found = self.radiance(self.stage(probes((0.0,)) + lamp("CylinderLight", line.format(1))))
        # Its power is that of 1 m2 of radiance 100, of which a tube shows a part of pi to its side.
        self.assertAlmostEqual(found["/World/P0"][0] / (0.5 / math.pi * 100 / math.pi / 4), 1, delta=0.01)

    def test_a_stage_is_lit_by_another_of_the_same_shapes(self):
        sky = 'def DomeLight "Sky" {{\n    float inputs:intensity = {}\n}}\n'
        self.stage(probes((0.0, 0.5)) + sky.format(1))
        self.stage(probes((0.0, 0.5)) + sky.format(3), name="bright.usda")
        own = self.radiance("stage.usda")["/World/P0"][0]
        self.assertAlmostEqual(self.radiance("stage.usda", "--lights-from", "bright.usda")["/World/P0"][0], 3 * own, delta=1e-3 * own)

    def test_a_shape_that_is_a_light_has_the_power_of_its_surface(self):
        ball = """def Sphere "Ball" (prepend apiSchemas = ["MeshLightAPI"]) {{
            double radius = 0.5
            float inputs:intensity = 100
            bool inputs:normalize = {}
            double3 xformOp:translate = (0, 2, 0)
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }}
        """
        # pi L (r / d)^2, and with normalize L over 4 pi r^2.
        for normalize, want in ((0, 3.125), (1, 3.125 / math.pi)):
            found = self.radiance(self.stage(probes((0.0,)) + ball.format(normalize)))
            self.assertAlmostEqual(found["/World/P0"][0] / want, 1, delta=DRAFT)

    def test_a_lamp_with_a_cone_is_written_only_if_kept(self):
        scene = self.stage(probes((0.0,)) + lamp("DiskLight", cone(40, 0, 0), 'prepend apiSchemas = ["ShapingAPI"]'))
        for more, is_there in (((), False), (("--keep-lamps",), True)):
            self.radiance(scene, *more)
            text = json.dumps(Asset(self.path("out.glb")).json)
            self.assertEqual(("EXT_lights_ies" in text, "hemibake_places" in text), (is_there, is_there))


class Instances(UsdCase):
    def test_copies_of_copies_stand_where_they_should_and_have_paths(self):
        body = f"""def PointInstancer "Outer" {{
            rel prototypes = [</World/Outer/Row>]
            int[] protoIndices = [0, 0, 0]
            int64[] ids = [7, 8, 9]
            int64[] invisibleIds = [8]
            point3f[] positions = [(0, 0, 0), (0, 0, 50), (0, 0, 10)]
            quath[] orientations = [(1, 0, 0, 0), (1, 0, 0, 0), (0.70710678, 0, 0.70710678, 0)]
            def PointInstancer "Row" {{
                rel prototypes = [</World/Outer/Row/A>]
                int[] protoIndices = [0, 0]
                point3f[] positions = [(1, 0, 0), (2, 0, 0)]
                {quad("A")}
            }}
        }}
        """
        self.radiance(self.stage(body + SKY))
        self.assertEqual(self.middles(), {("A", 1, 0), ("A", 2, 0), ("A", 0, 9), ("A", 0, 8)})

    def test_turned_instances_take_less_than_three_hundred_bytes(self):
        each = "def \"Instance_{0}\" (instanceable = true\n references = </Tile>) {{\ndouble3 xformOp:translate = ({0}.37, 0, 1.11)\nfloat3 xformOp:rotateXYZ = (12, {0}, 5)\nuniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateXYZ\"]\n}}\n"
        text = "#usda 1.0\n(\n    metersPerUnit = 1\n)\ndef Xform \"World\" {\n" + "".join(each.format(1000 + k) for k in range(1000)) + "}\n"
        scene = self.write("many.usda", (text + 'class Xform "Tile" {\n' + quad("M") + "}\n").encode())
        subprocess.run([sys.executable, os.path.join(ROOT, "converters/usd/__main__.py"), "scene", scene, "-o", "scene.glb"], cwd=self.folder, check=True)
        self.assertLess(len(self.read("scene.glb")), 300000)

    def test_what_shears_or_flattens_is_made_of_nodes_that_gltf_may_have(self):
        sheared = "matrix4d xformOp:transform = ((1, 0.5, 0, 0), (0, 1, 0, 0), (0.3, 0, -2, 0), (1, 2, 3, 1))\nuniform token[] xformOpOrder = [\"xformOp:transform\"]\n"
        flat = 'float3 xformOp:scale = (2, 0, 1)\nfloat xformOp:rotateX = 30\nuniform token[] xformOpOrder = ["xformOp:scale", "xformOp:rotateX"]\n'
        turned = 'float xformOp:rotateX = 30\nfloat xformOp:rotateY = 40\nfloat3 xformOp:scale = (-1, 1, 1)\nuniform token[] xformOpOrder = ["xformOp:rotateX", "xformOp:rotateY", "xformOp:scale"]\n'
        aside = 'double3 xformOp:translate = (1, 0, 1)\nuniform token[] xformOpOrder = ["xformOp:translate"]\n'
        body = "".join(f'def Xform "X{name}" {{\n{ops}{quad(name, aside)}}}\n' for name, ops in (("Sheared", sheared), ("Flat", flat), ("Turned", turned)))
        self.radiance(self.stage(body + quad("Plain") + SKY))
        # The middle of the squares is at (1, 0, 1) before the matrix, whose rows are what the axes become.
        c, s, tilt = math.cos(math.radians(40)), math.sin(math.radians(40)), math.cos(math.pi / 6)
        self.assertEqual(self.middles(), {("Sheared", 2.3, 1), ("Flat", 2, round(tilt, 2)), ("Turned", round(s - c, 2), round((c + s) * tilt, 2)), ("Plain", 0, 0)})
        for node in Asset(self.path("out.glb")).json["nodes"]:
            axes = [local(node)[4 * k : 4 * k + 3] for k in range(3)]
            for a, b in ((0, 1), (0, 2), (1, 2)):
                self.assertAlmostEqual(sum(p * q for p, q in zip(axes[a], axes[b])), 0, places=6)
            self.assertTrue("matrix" not in node or all(any(axis) for axis in axes))

    def middles(self):
        """(name, x, z) of every mesh of the output."""
        asset, out = Asset(self.path("out.glb")), set()
        for path, matrix, primitive in walk(asset.json):
            rows = asset.values(primitive["attributes"]["POSITION"])
            low, high = ([bound(row[k] for row in rows) for k in range(3)] for bound in (min, max))
            mean = [(a + b) / 2 for a, b in zip(low, high)]
            x, z = (sum(mean[k] * matrix[4 * k + r] for k in range(3)) + matrix[12 + r] for r in (0, 2))
            out.add((path.rsplit("/", 1)[-1], round(x, 2), round(z, 2)))
        return out

    def test_a_collection_binds_a_material_to_one_of_two_instances(self):
        text = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
)
def Xform "World" (prepend apiSchemas = ["MaterialBindingAPI", "CollectionAPI:reds"]) {
    rel material:binding:collection:reds = [</World.collection:reds>, </World/Red>]
    rel collection:reds:includes = [</World/J>, </World/K/M>]
"""
        instance = 'def "{}" (instanceable = true\n references = </Tile>) {{}}\n'
        text += "".join(instance.format(name) for name in "IJKL") + shaded("Red", "color3f inputs:diffuseColor = (0.8, 0.1, 0.1)") + SKY + "}\n"
        text += 'class Xform "Tile" {' + quad("M", color="(0.3, 0.3, 0.3)") + quad("N", y=9, color="(0.2, 0.2, 0.2)") + "}\n"
        found = self.radiance(self.write("stage.usda", text.encode()))
        red = {path for path, color in found.items() if color[0] > 2 * color[1]}
        self.assertEqual(red, {"/World/J/M", "/World/J/N", "/World/K/M"})


def local(node):
    """Its matrix, column after column."""
    if "matrix" in node:
        return node["matrix"]
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]]  # fmt: skip
    columns = [[scale * v for v in axis] for scale, axis in zip(node.get("scale", (1, 1, 1)), turn)]
    return [v for column in columns for v in (*column, 0)] + [*node.get("translation", (0, 0, 0)), 1]


def walk(root):
    """(path of the prim, matrix to the world as 16 numbers, primitive) of every mesh."""
    stack = [(index, local({})) for index in root["scenes"][0]["nodes"]]
    while stack:
        index, above = stack.pop()
        node = root["nodes"][index]
        own = local(node)
        matrix = [sum(own[4 * c + k] * above[4 * k + r] for k in range(4)) for c in range(4) for r in range(4)]
        for primitive in root["meshes"][node["mesh"]]["primitives"] if "mesh" in node else ():
            yield node["extras"]["usd"]["path"], matrix, primitive
        stack += [(child, matrix) for child in node.get("children", [])]


class LeftOut(UsdCase):
    def test_what_is_not_there_is_left_out_alone(self):
        body = quad("Seen") + quad("Hidden", 'uniform token purpose = "render"').join(('def Xform "Off" (prepend apiSchemas = ["VisibilityAPI"]) {\nuniform token renderVisibility = "invisible"\n', "}\n"))
        body += quad("Cut", "rel material:binding = </World/Thin>", y=1) + shaded("Thin", "float inputs:opacity = 0.2\nfloat inputs:opacityThreshold = 0.5")
        body += quad("Border", 'uniform token interpolateBoundary = "none"', y=2, scheme="catmullClark")
        found = self.radiance(self.stage(body + SKY))
        self.assertEqual(list(found), ["/World/Seen"])


class Pictures(UsdCase):
    def textured(self, name, file, more="", low=0.0):
        coordinates = f"texCoord2f[] primvars:st = [({low}, 0), ({low + 0.9}, 0), ({low + 0.9}, 1), ({low}, 1)] (interpolation = \"vertex\")\n"
        picture = f"""def Shader "T" {{
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @./{file}@
            float2 inputs:st.connect = </World/M{name}/R.outputs:result>
            {more}
            float3 outputs:rgb
        }}
        def Shader "R" {{
            uniform token info:id = "UsdPrimvarReader_float2"
            string inputs:varname = "st"
            float2 outputs:result
        }}
        """
        look = shaded("M" + name, f"color3f inputs:diffuseColor.connect = </World/M{name}/T.outputs:rgb>")
        return quad(name, coordinates + f"rel material:binding = </World/M{name}>") + look[: look.rindex("}")] + picture + "}\n"

    def test_sixteen_bits_are_as_eight_and_black_is_black(self):
        self.write("eight.png", png(2, 2, lambda y, x: (128, 128, 128)))
        self.write("sixteen.png", png(2, 2, lambda y, x: (32896, 32896, 32896), bits=16))
        srgb, wraps = ((128 / 255 + 0.055) / 1.055) ** 2.4, 'token inputs:wrapS = "{0}"\ntoken inputs:wrapT = "{0}"'
        want = {"Raw16": 128 / 255, "Srgb16": srgb, "Black": 0, "Unset": 0, "Clamp": srgb}
        body = self.textured("Raw16", "sixteen.png") + self.textured("Srgb16", "sixteen.png", 'token inputs:sourceColorSpace = "sRGB"')
        body += self.textured("Black", "eight.png", wraps.format("black"), 1.05) + self.textured("Unset", "eight.png", "", 1.05) + self.textured("Clamp", "eight.png", wraps.format("clamp"), 1.05)
        found = self.radiance(self.stage(body + SKY))
        for name, radiance in want.items():
            self.assertAlmostEqual(found["/World/" + name][0], radiance, delta=EVEN)


    def picture(self, path, name, file, more=""):
        return f"""def Shader "{name}" {{
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @./{file}@
            float2 inputs:st.connect = <{path}/R.outputs:result>
            token inputs:wrapS = "repeat"
            token inputs:wrapT = "repeat"
            {more}
            float3 outputs:rgb
            float outputs:r
            float outputs:a
        }}
        """

    def look(self, name, inputs, nodes):
        """A material of pictures; inputs and nodes may say {path}."""
        path = f"/World/M{name}"
        reader = 'def Shader "R" {\n uniform token info:id = "UsdPrimvarReader_float2"\n string inputs:varname = "st"\n float2 outputs:result\n }\n'
        return shaded("M" + name, inputs.replace("{path}", path), reader + "".join(self.picture(path, *node) for node in nodes))

    @unittest.skipUnless(HAS_PILLOW, "pillow cannot be had in the Python of the tests")
    def test_an_opacity_of_its_own_cuts_out(self):
        """Leaves of one picture for their colour and another for their shape are as those of one for both."""
        shape = {"color.png": lambda y, x: (128, 64, 32), "shape.png": lambda y, x: (255 * (x < 4),) * 3, "white.png": lambda y, x: (255,) * 3 + (255 * (x < 4),)}
        for name, pixel in shape.items():
            self.write(name, png(8, 8, pixel, channels=len(pixel(0, 0))))
        self.write("both.png", png(8, 8, lambda y, x: (128, 64, 32, 255 * (x < 4)), channels=4))
        st = 'texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")\n'
        cut, colored = "float inputs:opacity.connect = <{path}/O.outputs:%s>\nfloat inputs:opacityThreshold = 0.5\n", "color3f inputs:diffuseColor.connect = <{path}/%s.outputs:rgb>"
        plain = "color3f inputs:diffuseColor = (0.5, 0.5, 0.5)"
        looks = {
            "Two": self.look("Two", cut % "r" + colored % "C", [("O", "shape.png"), ("C", "color.png")]), "Both": self.look("Both", cut % "a" + colored % "O", [("O", "both.png")]),
            "Plain": self.look("Plain", cut % "r" + plain, [("O", "shape.png")]),
            "White": self.look("White", cut % "a" + colored % "O", [("O", "white.png", "float4 inputs:scale = (0.5, 0.5, 0.5, 1)")]),
        }  # fmt: skip
        found = {}
        for name, look in looks.items():
            scene = self.stage(quad("Card", st + f"rel material:binding = </World/M{name}>", half=1) + look + SKY)
            self.assertNotIn("opacity", self.bake(scene, "out.glb", "--quality", "draft", "--scene-linear", "--no-draco").stderr)
            asset = Asset(self.path("out.glb"))
            self.assertEqual([m["alphaMode"] for m in asset.json["materials"]], ["MASK"])
            found[name] = mean_radiance(asset)["/World/Card"]
        for two, both in (("Two", "Both"), ("Plain", "White")):
            for a, b in zip(found[two], found[both]):
                self.assertAlmostEqual(a, b, delta=1e-5, msg=two)
        # Below a roof that is cut out whole a floor sees all of the sky.
        self.write("shape.png", png(4, 4, lambda y, x: (0, 0, 0)))
        found = self.radiance(self.stage(quad("Floor", y=-0.5) + quad("Roof", st + "rel material:binding = </World/MTwo>", half=5) + looks["Two"] + SKY))
        self.assertAlmostEqual(found["/World/Floor"][0], 0.5, delta=EVEN)

    @unittest.skipUnless(HAS_PILLOW, "pillow cannot be had in the Python of the tests")
    def test_a_scale_and_a_bias_that_no_factor_is_are_in_the_picture(self):
        self.write("color.png", png(2, 2, lambda y, x: (128, 64, 32)))
        color = [((v / 255 + 0.055) / 1.055) ** 2.4 for v in (128, 64, 32)]
        ways = {"Inverse": (-1, 1), "Twice": (2, 0), "Raised": (0.5, 0.25)}
        body = ""
        for n, (name, (scale, bias)) in enumerate(ways.items()):
            more = f"float4 inputs:scale = ({scale}, {scale}, {scale}, 1)\nfloat4 inputs:bias = ({bias}, {bias}, {bias}, 0)"
            body += quad(name, f"rel material:binding = </World/M{name}>", y=60 * n) + self.look(name, "color3f inputs:diffuseColor.connect = <{path}/C.outputs:rgb>", [("C", "color.png", more)])
        found = self.radiance(self.stage(body + SKY))
        for name, (scale, bias) in ways.items():
            for got, stored in zip(found["/World/" + name], color):
                self.assertAlmostEqual(got, scale * stored + bias, delta=4e-3, msg=name)


    @unittest.skipUnless(HAS_PILLOW, "pillow cannot be had in the Python of the tests")
    def test_pictures_of_formats_that_gltf_has_not_are_made_png(self):
        row = bytes((32, 64, 128)) * 4  # blue, green, red
        self.write("a.bmp", b"BM" + struct.pack("<IHHI", 54 + 4 * len(row), 0, 0, 54) + struct.pack("<IiiHHIIiiII", 40, 4, 4, 1, 24, 0, 4 * len(row), 0, 0, 0, 0) + 4 * row)
        self.write("a.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n" + 16 * bytes((128, 64, 32, 127)))
        self.write("a.exr", b"no picture")
        body = "".join(quad(name, f"rel material:binding = </World/M{name}>", y=60 * n) + self.look(name, "color3f inputs:diffuseColor.connect = <{path}/C.outputs:rgb>", [("C", file)])
                       for n, (name, file) in enumerate((("Bmp", "a.bmp"), ("Hdr", "a.hdr"), ("Bad", "a.exr"))))  # fmt: skip
        found = self.radiance(self.stage(body + SKY))
        for name, want in (("Bmp", [((v / 255 + 0.055) / 1.055) ** 2.4 for v in (128, 64, 32)]), ("Hdr", (1 / 4, 1 / 8, 1 / 16)), ("Bad", (0, 0, 0))):
            for a, b in zip(found["/World/" + name], want):
                self.assertAlmostEqual(a, b, delta=EVEN, msg=name)


class MaterialX(UsdCase):
    def surface(self, name, kind, inputs, *nodes):
        made = "".join(f'def Shader "N{k}" {{\n uniform token info:id = "{node}"\n {values}\n color3f outputs:out\n }}\n' for k, (node, values) in enumerate(nodes))
        return f"""def Material "M{name}" {{
            token outputs:mtlx:surface.connect = </World/M{name}/S.outputs:out>
            def Shader "S" {{
                uniform token info:id = "{kind}"
                {inputs}
                token outputs:out
            }}
            {made}
        }}
        """

    def test_the_surface_of_gltf_and_nodes_that_compute_are_read(self):
        self.write("grey.png", png(4, 4, lambda y, x: (128, 64, 32)))
        linear = [v / 255 for v in (128, 64, 32)]
        gltf, standard = "ND_gltf_pbr_surfaceshader", "ND_standard_surface_surfaceshader"
        link = "float inputs:base = 1\n color3f inputs:base_color.connect = </World/M{}/N0.outputs:out>".format
        image = ("ND_image_color3", 'asset inputs:file = @./grey.png@ (colorSpace = "lin_rec709")')

        def node(operation, name, a, b):
            return f"ND_{operation}_color3", f"color3f inputs:in1{a.format(name)}\n color3f inputs:in2{b.format(name)}"

        to_next, half = ".connect = </World/M{}/N1.outputs:out>", " = (0.5, 0.5, 0.5)"
        mixed = "color3f inputs:fg = (1, 0, 0)\n color3f inputs:bg = (0, 0, 1)\n float inputs:mix = 0.25"
        looks = {
            "Gltf": ((1.2, 0.4, 0.6), gltf, "color3f inputs:base_color = (0.2, 0.4, 0.6)\n float inputs:metallic = 0\n color3f inputs:emissive = (0.5, 0, 0)\n float inputs:emissive_strength = 2"),
            "White": ((0.999,) * 3, gltf, "float inputs:metallic = 0\n float inputs:alpha = 0.3"),
            "Cut": (None, gltf, "float inputs:metallic = 0\n int inputs:alpha_mode = 1\n float inputs:alpha = 0.3"),
            "Constant": ((0.1, 0.2, 0.3), standard, link("Constant"), ("ND_constant_color3", "color3f inputs:value = (0.1, 0.2, 0.3)")),
            "Product": ((0.1, 0.2, 0.3), standard, link("Product"), node("multiply", "Product", half, " = (0.2, 0.4, 0.6)")),
            "Less": ((0.3, 0.1, 0), standard, link("Less"), node("subtract", "Less", half, " = (0.2, 0.4, 0.5)")),
            "Mix": ((0.25, 0, 0.75), standard, link("Mix"), ("ND_mix_color3", mixed)),
            "Tinted": ([v / 2 for v in linear], standard, link("Tinted"), node("multiply", "Tinted", to_next, half), image),
            "Circle": ((0, 0, 0), standard, link("Circle"), node("multiply", "Circle", to_next.replace("N1", "N0"), half)),
        }
        body = "".join(self.surface(name, *look) + quad(name, f"rel material:binding = </World/M{name}>", y=60 * n) for n, (name, (_, *look)) in enumerate(looks.items()))
        found = self.radiance(self.stage(body + SKY))
        self.assertEqual(set(found), {"/World/" + name for name in looks} - {"/World/Cut"})
        for path, light in found.items():
            for got, want in zip(light, looks[path.rsplit("/", 1)[-1]][0]):
                self.assertAlmostEqual(got, want, delta=EVEN, msg=path)


class Opening(UsdCase):
    def test_a_package_without_a_name_and_a_camera_by_its_path(self):
        self.write("part.usda", b'#usda 1.0\n(\ndefaultPrim = "P"\n)\ndef Xform "P" {\n' + quad("Q").encode() + b"}\n")
        self.stage('def "Part" (\nreferences = @./part.usda@\n) {}\ndef Camera "Cam" {}\n' + SKY)
        pack = "import sys; from pxr import Sdf, UsdUtils; UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath('stage.usda'), 'p.usdz')"
        subprocess.run([sys.executable, "-c", pack], cwd=self.path("."), check=True)
        with open(self.path("p.usdz"), "rb") as f:
            self.write("package", f.read())
        self.radiance("package", "--preview", "p.png", "--camera", "/World/Cam")
        self.assertEqual([path for path, _ in primitives(Asset(self.path("out.glb")))], ["/World/Part/Q"])


if __name__ == "__main__":
    main()
