# SPDX-License-Identifier: MIT
"""Are meshes of USD what their normals, polygons, primvars and prototypes say? By the same scene as glTF, and by closed forms."""

import math
import os
import subprocess
import sys

from command import BAD_INPUT, ROOT, main
from gltf_file import Asset, Scene, png
from usd_file import SKY, UsdCase, mean_radiance, primitives, quad, shaded

EVEN = 2e-3  # of an even sky, as in usd_test.py


def polygons(name, points, counts, corners, more=""):
    return f"""def Mesh "{name}" {{
    int[] faceVertexCounts = {counts}
    int[] faceVertexIndices = {corners}
    point3f[] points = {points}
    uniform token subdivisionScheme = "none"
    {more}
}}
"""


def coarse_ball(rows=6, columns=8):
    """Points of a sphere, which are its normals, and triangles."""
    at = [(math.pi * i / rows, 2 * math.pi * j / columns) for i in range(rows + 1) for j in range(columns)]
    points = [(math.sin(t) * math.cos(p), math.cos(t), -math.sin(t) * math.sin(p)) for t, p in at]
    triangles = []
    for i in range(rows):
        for j in range(columns):
            k = (j + 1) % columns
            a, b, c, d = i * columns + j, (i + 1) * columns + j, (i + 1) * columns + k, i * columns + k
            triangles += [(a, b, c)] * (i < rows - 1) + [(a, c, d)] * (i > 0)
    return points, triangles


def read_scene(case, stage):
    """What the program reads of a stage."""
    subprocess.run([sys.executable, os.path.join(ROOT, "converters/usd/__main__.py"), "scene", stage, "-o", "scene.glb"], cwd=case.folder, check=True)
    return Asset(case.path("scene.glb"))


class Normals(UsdCase):
    SUN = ("--sun", "90,45,10", "--environment", "0,0,0")

    def light(self, scene, *options):
        """Radiance by place; where vertices share a place, all of theirs."""
        self.bake(scene, "out.glb", "--quality", "draft", "--scene-linear", "--no-draco", *self.SUN, *options)
        asset, out = Asset(self.path("out.glb")), {}
        for primitive in (p for mesh in asset.json["meshes"] for p in mesh["primitives"]):
            rows = (asset.values(primitive["attributes"][name]) for name in ("POSITION", "_RADIOSITY"))
            for point, light in zip(*rows):
                out.setdefault(tuple(round(x, 3) for x in point), set()).add(round(light[0], 5))
        return out

    def test_a_mesh_is_as_smooth_as_its_normals_say(self):
        """The same as the glTF of it, whichever way USD says them."""
        points, triangles = coarse_ball()
        scene = Scene()
        scene.add_mesh("Ball", (points, triangles, points), scene.add_material("m", (0.5, 0.5, 0.5)))
        self.write("ball.glb", scene.glb())
        want = self.light("ball.glb")
        corners = [v for t in triangles for v in t]
        ways = {
            "vertex": f'normal3f[] normals = {points} (interpolation = "vertex")',
            "corner": f'normal3f[] normals = {[points[v] for v in corners]} (interpolation = "faceVarying")',
            "indexed": f'normal3f[] primvars:normals = {points} (interpolation = "faceVarying")\nint[] primvars:normals:indices = {corners}',
            "first": f'normal3f[] normals = [(0, 1, 0)] (interpolation = "constant")\nnormal3f[] primvars:normals = {points} (interpolation = "vertex")',
        }
        for way, normals in ways.items():
            body = polygons("Ball", points, [3] * len(triangles), corners, normals)
            self.assertEqual(self.light(self.stage(body)), want, way)
        facets = self.light(self.stage(polygons("Ball", points, [3] * len(triangles), corners)))
        self.assertTrue(any(max(values) - min(values) > 0.5 for values in facets.values()))

    def test_a_normal_without_a_length_is_that_of_the_face(self):
        square, slope = [(0, 0, 1), (1, 0, 1), (1, 0, 0), (0, 0, 0)], "(0.6, 0.8, 0)"
        zero = f"[{slope}, (0, 0, 0), {slope}, {slope}, (0, 0, 0)]"
        for side in ("rightHanded", "leftHanded"):
            body = polygons("P", [*square, (9, 9, 9)], [4], [0, 1, 2, 3], f'normal3f[] normals = {zero} (interpolation = "vertex")\nuniform token orientation = "{side}"')
            asset = read_scene(self, self.stage(body))
            (_, primitive), = primitives(asset)
            rows = zip(*(asset.values(primitive["attributes"][name]) for name in ("POSITION", "NORMAL")))
            found = {tuple(point): tuple(round(v, 5) for v in normal) for point, normal in rows}
            up = 1 if side == "rightHanded" else -1
            self.assertEqual(found, {tuple(map(float, p)): (0, up, 0) if k == 1 else (0.6, 0.8, 0) for k, p in enumerate(square)})

    def test_normals_that_cannot_be_read_are_told_and_a_cage_has_its_own(self):
        square, corners = [(0, 0, 1), (1, 0, 1), (1, 0, 0), (0, 0, 0)], [0, 1, 2, 3]
        bad = {"Few": "[(0, 1, 0), (0, 1, 0)]", "Nan": "[(0, nan, 0), (0, 1, 0), (0, 1, 0), (0, 1, 0)]"}
        for name, values in bad.items():
            body = polygons(name, square, [4], corners, f'normal3f[] normals = {values} (interpolation = "vertex")')
            ran = self.bake(self.stage(body + SKY), "out.glb", "--quality", "draft")
            self.assertIn(f"/World/{name}: its normals are not read", ran.stderr)
        scene = self.stage(quad("Cage", 'normal3f[] normals = [(1, 0, 0)] (interpolation = "constant")', scheme="catmullClark"))
        read_scene(self, scene)
        self.assertNotIn(b"NORMAL", self.read("scene.glb"))


class Polygons(UsdCase):
    def area(self, stage):
        """Of all triangles that the program is given."""
        asset, total = read_scene(self, stage), 0.0
        for _, primitive in primitives(asset):
            points = asset.values(primitive["attributes"]["POSITION"])
            corners = [points[row[0]] for row in asset.values(primitive["indices"])]
            for a, b, c in zip(corners[::3], corners[1::3], corners[2::3]):
                u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
                total += math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2
        return total

    def test_a_hollow_polygon_is_covered_once(self):
        """Whichever corner it begins with, upright or not: fans would lie beside it and over themselves."""
        arrow = ([(0, 0), (2, 2), (0, 1), (-2, 2)], 2)
        court = ([(0, 0), (0, 3), (1, 3), (1, 1), (2, 1), (2, 3), (3, 3), (3, 0)], 7)
        # A square of 4 with one of 2 cut out, in one loop by a bridge.
        frame = ([(0, 0), (0, 4), (4, 4), (4, 0), (0, 0), (1, 1), (3, 1), (3, 3), (1, 3), (1, 1)], 12)
        lay = (lambda x, z: (x, 0.0, z), lambda x, z: (0.6 * x, 0.8 * x, z), lambda x, z: (0.0, z, x), lambda x, z: (x, -z, 0.0))
        for n, (corners, want) in enumerate((arrow, court, frame)):
            for first in range(len(corners)):
                points = [lay[(first + n) % len(lay)](*p) for p in corners[first:] + corners[:first]]
                side = 'uniform token orientation = "leftHanded"' if first // 2 % 2 else ""
                scene = self.stage(polygons("P", points, [len(points)], list(range(len(points))), side))
                self.assertAlmostEqual(self.area(scene) / want, 1, delta=1e-5, msg=f"polygon {n} from corner {first}")


class Prototypes(UsdCase):
    def instancer(self, name, prototype, body="", at="(0, 0, 0)"):
        return f'''def PointInstancer "{name}" {{
            rel prototypes = [<{prototype}>]
            int[] protoIndices = [0]
            point3f[] positions = [{at}]
            {body}
        }}
        '''

    def test_prototypes_that_are_kept_from_walks_are_copied(self):
        """Below an over and a class, as who writes instancers does so that nobody draws them where they are."""
        kept = '{} "Kept" {{\n def Xform "A" {{\n {} class Xform "Class" {{\n {} }}\n over "Nothing" {{\n }}\n }}\n }}\n'
        body = "".join(self.instancer(name, f"/World/{name}/Kept/A", kept.format(word, quad("M"), quad("N")), at) for name, word, at in (("O", "over", "(0, 0, 0)"), ("C", "class", "(9, 0, 0)")))
        body += 'over "Far" {\n class "Kept" {\n def Xform "A" {\n' + quad("M") + "}\n }\n }\n" + self.instancer("F", "/World/Far/Kept/A", at="(18, 0, 0)")
        found = self.radiance(self.stage(body + SKY))
        self.assertEqual(set(found), {"/World/O/Kept/A/M", "/World/C/Kept/A/M", "/World/Far/Kept/A/M"})
        for light in found.values():
            self.assertAlmostEqual(light[0], 0.5, delta=EVEN)

    def test_an_instancer_in_itself_and_an_inactive_prototype_are_told_and_all_else_is_baked(self):
        inside = 'def Xform "P" {{\n {} }}\n'
        body = quad("Seen") + self.instancer("Self", "/World/Self") + self.instancer("All", "/World")
        body += self.instancer("One", "/World/One/P", inside.format(self.instancer("In", "/World/Two/P"))) + self.instancer("Two", "/World/Two/P", inside.format(self.instancer("In", "/World/One/P")))
        body += self.instancer("Off", "/World/Off/P", 'def Xform "P" (active = false) {\n' + quad("M") + "}\n")
        scene = self.stage(body + SKY)
        ran = self.bake(scene, "out.glb", "--quality", "draft")
        self.assertEqual([path for path, _ in primitives(Asset(self.path("out.glb")))], ["/World/Seen"])
        for name in ("Self", "All", "Two/P/In"):
            self.assertIn(f"/World/{name}: not baked, it is in a prototype of its own", ran.stderr)
        self.assertIn("/World/Off: its prototype /World/Off/P is not active", ran.stderr)


class Colours(UsdCase):
    def reads(self, name, primvar, fallback="", put="color3f inputs:diffuseColor", width="float3", more=""):
        """A material one of whose inputs is a primvar."""
        reader = f'''def Shader "R" {{
            uniform token info:id = "UsdPrimvarReader_{width}"
            string inputs:varname = "{primvar}"
            {fallback}
            {width} outputs:result
        }}'''
        return shaded(name, f"{put}.connect = </World/{name}/R.outputs:result>\n{more}", reader)

    def check(self, body, want):
        found = self.radiance(self.stage(body + SKY))
        self.assertEqual(set(found), {"/World/" + name for name in want})
        for name, color in want.items():
            for got, expected in zip(found["/World/" + name], color):
                self.assertAlmostEqual(got, expected, delta=EVEN, msg=name)

    def test_a_constant_colour_has_its_index_and_one_without_brackets_is_one(self):
        indexed = 'color3f[] primvars:displayColor = [(0.9, 0.9, 0.9), (0.2, 0.3, 0.4)] (interpolation = "constant")\nint[] primvars:displayColor:indices = [1]'
        plain = "color3f primvars:displayColor = (0.3, 0.4, 0.5)"
        clear = 'float[] primvars:displayOpacity = [0.5, 1] (interpolation = "constant")\nint[] primvars:displayOpacity:indices = [1]'
        own = "color3f[] primvars:displayColor = [(0.5, 0.5, 0.5)]"
        body = quad("Indexed").replace(own, indexed) + quad("Plain", y=30).replace(own, plain) + quad("Clear", clear, y=60)
        self.check(body, {"Indexed": (0.2, 0.3, 0.4), "Plain": (0.3, 0.4, 0.5), "Clear": (0.5, 0.5, 0.5)})

    def test_what_lacks_a_primvar_has_the_fallback_of_its_reader(self):
        """White would light all around it."""
        body = self.reads("M", "tint", "float3 inputs:fallback = (0.3, 0.2, 0.1)") + self.reads("N", "tint")
        body += quad("Has", "rel material:binding = </World/M>\ncolor3f[] primvars:tint = [(0.1, 0.2, 0.3)]") + quad("Lacks", "rel material:binding = </World/M>", y=30)
        body += quad("Bare", "rel material:binding = </World/N>", y=60)
        few = 'color3f[] primvars:displayColor = [(1, 1, 1), (0, 0, 0)] (interpolation = "vertex")'
        body += quad("Few", y=90).replace("color3f[] primvars:displayColor = [(0.5, 0.5, 0.5)]", few)
        self.check(body, {"Has": (0.1, 0.2, 0.3), "Lacks": (0.3, 0.2, 0.1), "Bare": (0, 0, 0), "Few": (0.5, 0.5, 0.5)})

    def test_a_constant_of_a_prim_is_its_emission_opacity_or_metalness(self):
        """The same material, by which each prim shines with its own colour."""
        body = self.reads("Glow", "glow", put="color3f inputs:emissiveColor", more="color3f inputs:diffuseColor = (0, 0, 0)")
        body += self.reads("Clear", "displayOpacity", "float inputs:fallback = 1", "float inputs:opacity", "float")
        body += self.reads("Metal", "metal", put="float inputs:metallic", width="float", more="float inputs:roughness = 0.5")
        binds, glow = "rel material:binding = </World/{}>\n", 'color3f[] primvars:glow = {} (interpolation = "vertex")'
        prims = {
            "Red": ("Glow", glow.format("[(3, 0, 0)]"), (3, 0, 0)), "Blue": ("Glow", glow.format("[(0, 0, 2)]"), (0, 0, 2)), "Dark": ("Glow", "", (0, 0, 0)),
            "Many": ("Glow", glow.format("[(1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 0)]"), (0.5, 0.5, 0)),
            "Half": ("Clear", "float[] primvars:displayOpacity = [0.5]", (0.09, 0.09, 0.09)), "Whole": ("Clear", "", (0.18, 0.18, 0.18)),
            # A metal reflects half of its squared roughness.
            "Steel": ("Metal", "float[] primvars:metal = [1]", (0.0225, 0.0225, 0.0225)), "Wood": ("Metal", "", (0.18, 0.18, 0.18)),
        }  # fmt: skip
        body += "".join(quad(name, binds.format(look) + more, y=60 * n) for n, (name, (look, more, _)) in enumerate(prims.items()))
        self.check(body, {name: want for name, (_, _, want) in prims.items()})

    def test_colours_stand_in_for_a_material_that_cannot_be_read(self):
        look = 'def Material "{}" {{\n token outputs:{}surface.connect = </World/{}/S.outputs:out>\n def Shader "S" {{\n {}\n token outputs:out\n }}\n }}\n'
        mdl = 'uniform token info:implementationSource = "sourceAsset"\n uniform asset info:mdl:sourceAsset = @OmniPBR.mdl@'
        body = look.format("Mdl", "mdl:", "Mdl", mdl) + look.format("Other", "", "Other", 'uniform token info:id = "PxrDisney"')
        subset = 'def GeomSubset "S" (prepend apiSchemas = ["MaterialBindingAPI"]) {\n uniform token familyName = "materialBind"\n int[] indices = [0]\n rel material:binding = </World/Mdl>\n}'
        binds = {"A": "rel material:binding = </World/Mdl>", "B": "rel material:binding = </World/Other>", "C": subset}
        body += "".join(quad(name, bind, y=60 * n, color="(0.2, 0.3, 0.4)") for n, (name, bind) in enumerate(binds.items()))
        self.check(body, {name: (0.2, 0.3, 0.4) for name in binds})

    def test_a_picture_whose_coordinates_a_mesh_lacks_is_told(self):
        self.write("grey.png", png(4, 4, lambda y, x: (128, 128, 128)))
        nodes = '''def Shader "T" {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @./grey.png@
            float2 inputs:st.connect = </World/M/R.outputs:result>
            float3 outputs:rgb
        }
        def Shader "R" {
            uniform token info:id = "UsdPrimvarReader_float2"
            string inputs:varname = "UVMap"
            float2 outputs:result
        }'''
        body = quad("A", "rel material:binding = </World/M>") + shaded("M", "color3f inputs:diffuseColor.connect = </World/M/T.outputs:rgb>", nodes)
        self.assertIn("/World/A: it has no primvars:UVMap", self.bake(self.stage(body + SKY), "out.glb", "--quality", "draft").stderr)

    def test_shapes_have_the_colour_of_their_primvar(self):
        place = 'double3 xformOp:translate = ({}, 0, 0)\nuniform token[] xformOpOrder = ["xformOp:translate"]\n'
        colors = 'color3f[] primvars:displayColor = [(0.2, 0.3, 0.4), (0.4, 0.5, 0.6)] (interpolation = "vertex")\n'
        one = "color3f[] primvars:displayColor = [(0.2, 0.3, 0.4)]\n"
        body = self.reads("M", "displayColor") + f'def Sphere "One" {{\n{one}rel material:binding = </World/M>\n}}\n'
        body += f'def Cube "Mean" {{\n{colors}{place.format(60)}}}\ndef Cube "Lacks" {{\nrel material:binding = </World/M>\n{place.format(120)}}}\n'
        self.check(body, {"One": (0.2, 0.3, 0.4), "Mean": (0.3, 0.4, 0.5), "Lacks": (0, 0, 0)})


class Subsets(UsdCase):
    def test_a_subset_that_names_no_face_changes_nothing(self):
        """Nor does one of points, or of no family, which is told."""
        subset = '''def GeomSubset "S" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
            uniform token elementType = "{}"
            uniform token familyName = "{}"
            int[] indices = {}
            rel material:binding = </World/Red>
        }}
        '''
        ways = {"Empty": ("face", "materialBind", "[]"), "Beyond": ("face", "materialBind", "[-5, 2147483647]"), "Points": ("point", "materialBind", "[0]"),
                "NoFamily": ("face", "", "[0]"), "One": ("face", "materialBind", "[0, 0]")}  # fmt: skip
        body = shaded("Red", "color3f inputs:diffuseColor = (0.8, 0.1, 0.1)")
        body += "".join(quad(name, subset.format(*way), y=30 * n) for n, (name, way) in enumerate(ways.items()))
        ran = self.bake(self.stage(body + SKY), "out.glb", "--quality", "draft", "--scene-linear", "--no-draco")
        for name in ("Beyond", "Points", "NoFamily"):
            self.assertIn(f"/World/{name}/S: ", ran.stderr)
        found = mean_radiance(Asset(self.path("out.glb")))
        self.assertEqual(set(found), {"/World/" + name for name in ways})
        for path, light in found.items():
            self.assertAlmostEqual(light[0], 0.8 if path == "/World/One" else 0.5, delta=EVEN, msg=path)


class Broken(UsdCase):
    def test_numbers_that_are_none_are_told_and_the_rest_is_baked(self):
        nan = shaded("M", "color3f inputs:diffuseColor = (nan, 0.5, inf)\n float inputs:opacity = nan\n string inputs:metallic = \"x\"\n float inputs:roughness = inf")
        turn = 'string xformOp:translate = "x"\nuniform token[] xformOpOrder = ["xformOp:translate"]'
        copies = f'''def PointInstancer "I" {{
            rel prototypes = [</World/I/P>]
            int[] protoIndices = [0, 0]
            int64[] ids = [1]
            int64[] invisibleIds = [1]
            point3f[] positions = [(0, 60, 0), (1, 60, 0)]
            {quad("P")}
        }}
        '''
        lamp = 'def RectLight "L" {\n color3f inputs:color = (1, nan, 1)\n float inputs:width = inf\n}\n'
        ran = self.bake(self.stage(nan + quad("A", "rel material:binding = </World/M>") + quad("B", turn, y=30) + copies + lamp + SKY), "out.glb", "--quality", "draft")
        self.assertEqual({path for path, _ in primitives(Asset(self.path("out.glb")))}, {"/World/A", "/World/B", "/World/I/P"})
        for line in ("M/S: inputs:diffuseColor is no number", "M/S: inputs:metallic is no number", "B: its transform is left out", "I: its ids do not fit", "L: inputs:color is not finite", "L: inputs:width is not finite"):
            self.assertIn("/World/" + line, ran.stderr)

    def test_where_nothing_is_left_the_line_says_why(self):
        head = 'def Mesh "M" {\n point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n int[] faceVertexCounts = [3]\n'
        lost = {
            "names a point beyond its 3": head + "int[] faceVertexIndices = [0, 1, 7]\n}\n",
            "a size of it is not above 0": 'def Sphere "S" {\n double radius = -1\n}\ndef Cube "C" {\n double size = inf\n}\n',
            "Could not open asset": 'def "A" (references = @./gone.usda@) {\n}\n',
            "no mesh or shape is active": 'def DistantLight "L" (prepend apiSchemas = ["ShadowAPI"]) {\n bool inputs:shadow:enable = 0\n}\n',
        }
        for why, body in lost.items():
            ran = self.run_hemibake("bake", self.stage(body), "-o", "out.glb")
            self.assertEqual((ran.returncode, len(ran.stderr.splitlines())), (BAD_INPUT, 1), ran.stderr)
            self.assertIn("there is nothing to bake: ", ran.stderr)
            self.assertIn(why, ran.stderr)

    def test_a_transform_of_texture_coordinates_by_itself_ends(self):
        loop = '''def Shader "T" {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @./grey.png@
            float2 inputs:st.connect = </World/M/L.outputs:result>
            float3 outputs:rgb
        }
        def Shader "L" {
            uniform token info:id = "UsdTransform2d"
            float2 inputs:in.connect = </World/M/L.outputs:result>
            float2 outputs:result
        }'''
        self.write("grey.png", png(4, 4, lambda y, x: (128, 128, 128)))
        body = quad("A", "rel material:binding = </World/M>") + shaded("M", "color3f inputs:diffuseColor.connect = </World/M/T.outputs:rgb>", loop)
        self.assertEqual(list(self.radiance(self.stage(body + SKY))), ["/World/A"])


if __name__ == "__main__":
    main()
