# SPDX-License-Identifier: MIT
"""Does --subdivide bake the limit surface of a cage? A cube in a lit room, in both schemes.

Every mesh is taken as a cage: an open sheet keeps its outline, so the room here is six separate walls.
"""

import json
import math
import struct

import command
import gltf_file

LEVEL = 2
CENTRE, HALF = (0, 0.5, 0), 0.25


def scene():
    made = gltf_file.Scene()
    white = made.add_material("white", (0.7, 0.7, 0.7))
    light = made.add_material("lamp", (0, 0, 0), (10, 10, 10))
    positions, triangles = gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True)
    for wall in range(6):
        pair = triangles[2 * wall:2 * wall + 2]
        used = sorted({i for t in pair for i in t})
        sheet = [positions[i] for i in used], [tuple(used.index(i) for i in t) for t in pair]
        made.add_mesh(f"wall {wall}", sheet, white)
    low, high = ([c + side * HALF for c in CENTRE] for side in (-1, 1))
    made.add_mesh("cube", gltf_file.box(low, high), white)
    made.add_mesh("lamp", gltf_file.lamp(0.3, 1.9), light)
    return made


def cube_quads():
    """Positions, and four of them for each side; two triangles of the box make one."""
    positions, triangles = gltf_file.box(*([c + side * HALF for c in CENTRE] for side in (-1, 1)))
    return positions, [(*a, b[2]) for a, b in zip(triangles[::2], triangles[1::2])]


class Subdivision(command.CommandCase):
    def setUp(self):
        super().setUp()
        self.write("scene.glb", scene().glb())

    def baked(self, *arguments):
        """Positions and radiosities of the cube, and the report. By columns, whose books close to the last digits."""
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--method", "hybrid", "--scene-linear", "--no-draco", "--report", "out.json",
                  *arguments)
        asset = gltf_file.Asset(self.path("out.glb"))
        positions, radiance, triangles = [], [], 0
        for primitive in asset.primitives("cube"):
            positions += asset.values(primitive["attributes"]["POSITION"])
            radiance += asset.values(primitive["attributes"]["_RADIOSITY"])
            triangles += asset.json["accessors"][primitive["indices"]]["count"] // 3
        return positions, radiance, triangles, json.loads(self.read("out.json"))

    def radii(self, positions):
        return [math.dist(p, CENTRE) / HALF for p in positions]

    def check(self, positions, radiance, triangles, report, least_triangles, flattest, farthest):
        """The cube has become a ball between the spheres of its flattest and its farthest point, lit from above."""
        self.assertGreaterEqual(triangles, least_triangles)
        radii = self.radii(positions)
        self.assertAlmostEqual(max(radii), farthest, delta=1e-5)
        # Elements are cut from flat facets, so nothing but the facets' own chords lies nearer than the surface.
        self.assertGreater(min(radii), flattest)
        self.assertLess(abs(report["energy"]["residual_fraction"]), 1e-9)
        top = [c[1] for p, c in zip(positions, radiance) if p[1] > CENTRE[1] + 0.4 * HALF]
        bottom = [c[1] for p, c in zip(positions, radiance) if p[1] < CENTRE[1] - 0.4 * HALF]
        self.assertGreater(min(top), max(bottom))

    def test_without_it_the_cube_stays_a_cube(self):
        for more in ((), ("--subdivide", "0")):
            positions, _, _, report = self.baked(*more)
            self.assertAlmostEqual(max(self.radii(positions)), math.sqrt(3), delta=1e-6)
            self.assertEqual(max(abs(p[0]) for p in positions), HALF)

    def test_catmull_clark(self):
        """Twelve triangles are six quads, 6 * 4^2 of them after two levels. The limit of a corner of valence 3 is
        (9 P + 4 sum of edge ends + sum of face ends) / 24 [Halstead93]: half of (1, 1, 1), which is the farthest point.
        The middle of a face is at 0.84; chords of facets of a quarter of a face lie 2 % inside."""
        cage = self.baked("--subdivide", LEVEL, "--subdivide-scheme", "catmull-clark")
        self.check(*cage, least_triangles=2 * 6 * 4**LEVEL, flattest=0.8, farthest=math.sqrt(3) * 0.5)

    def test_loop(self):
        """Twelve triangles are 12 * 4^2 after two levels."""
        cage = self.baked("--subdivide", LEVEL, "--subdivide-scheme", "loop")
        positions, _, triangles, _ = cage
        self.assertGreaterEqual(triangles, 12 * 4**LEVEL)
        self.assertLess(max(self.radii(positions)), 1.1)
        self.assertGreater(min(self.radii(positions)), 0.5)

    def test_the_schemes_differ_and_walls_keep_their_outline(self):
        surfaces = []
        for scheme in ("catmull-clark", "loop"):
            positions, *_ = self.baked("--subdivide", LEVEL, "--subdivide-scheme", scheme)
            surfaces.append(max(self.radii(positions)))
            asset = gltf_file.Asset(self.path("out.glb"))
            for primitive in asset.primitives("wall 0"):
                for p in asset.values(primitive["attributes"]["POSITION"]):
                    self.assertTrue(all(-1 - 1e-6 <= x <= 2 + 1e-6 for x in p), p)
        self.assertGreater(abs(surfaces[0] - surfaces[1]), 0.01)

    def test_more_levels_come_nearer_to_the_limit(self):
        """The area of the chords grows towards that of the surface."""
        counts = [self.baked("--subdivide", level, "--uniform")[2] for level in (1, 2, 3)]
        self.assertLess(counts[0], counts[1])
        self.assertLess(counts[1], counts[2])

    def test_a_subdivided_bake_is_compressed_too(self):
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--subdivide", LEVEL)
        self.succeed("render", "out.glb", "-o", "out.png", "--size", "64x48")

    # ---- what the asset asks for itself ------------------------------------------------------------------------------

    def polygons(self, extras=None, where="meshes", texture=True):
        """The room with the cube as six quads of FB_ngon_encoding, a corner of its own for each, with a unit square of
        texture on every face."""
        made = scene()
        at = next(i for i, mesh in enumerate(made.json["meshes"]) if mesh["name"] == "cube")
        self.positions, self.quads = cube_quads()
        corners = [self.positions[v] for quad in self.quads for v in quad]
        uv = [(u + f, v) for f in range(6) for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))]
        fans = [4 * f + k for f in range(6) for k in (0, 1, 2, 0, 2, 3)]
        primitive = made.json["meshes"][at]["primitives"][0]
        primitive["attributes"] = {"POSITION": made._add_accessor(corners, "VEC3", gltf_file.FLOAT)}
        if texture:
            primitive["attributes"]["TEXCOORD_0"] = made._add_accessor(uv, "VEC2", gltf_file.FLOAT)
        primitive["indices"] = made._add_accessor(fans, "SCALAR", gltf_file.UINT32)
        primitive["extensions"] = {"FB_ngon_encoding": {}}
        made.json.setdefault("extensionsUsed", []).append("FB_ngon_encoding")
        if extras is not None:
            target = primitive if where == "primitives" else made.json[where][at]
            target["extras"] = {"hemibake_subdivision": extras, "kept": 7}
        self.write("scene.glb", made.glb())

    def test_extras_of_a_mesh_a_node_or_a_primitive_ask_for_a_surface(self):
        for where in ("meshes", "nodes", "primitives"):
            self.polygons({"level": LEVEL}, where)
            self.check(*self.baked(), least_triangles=2 * 6 * 4**LEVEL, flattest=0.8, farthest=math.sqrt(3) * 0.5)
            positions, *_ = self.baked("--subdivide", "0")
            self.assertAlmostEqual(max(self.radii(positions)), math.sqrt(3), delta=1e-6)

    def test_texture_coordinates_reach_the_surface_and_polygons_are_gone(self):
        """Every face keeps its unit square: the seams are not blurred."""
        self.polygons({"level": LEVEL})
        self.baked()
        asset = gltf_file.Asset(self.path("out.glb"))
        primitive, = asset.primitives("cube")
        rows = asset.values(primitive["attributes"]["TEXCOORD_0"])
        for f in range(6):
            face = [u for u, v in rows if f <= u <= f + 1]
            self.assertAlmostEqual(min(face), f, delta=1e-6)
            self.assertAlmostEqual(max(face), f + 1, delta=1e-6)
        self.assertNotIn("extensions", primitive)
        self.assertNotIn("FB_ngon_encoding", asset.json["extensionsUsed"])

    def test_polygons_that_are_not_baked_stay(self):
        self.polygons()
        data = self.read("scene.glb")
        length = struct.unpack("<I", data[12:16])[0]
        tree = json.loads(data[20:20 + length])
        tree["materials"].append({"name": "card", "extensions": {"KHR_materials_unlit": {}}})
        tree.setdefault("extensionsUsed", []).append("KHR_materials_unlit")
        pane = json.loads(json.dumps(next(mesh for mesh in tree["meshes"] if mesh["name"] == "cube")))
        pane["primitives"][0]["material"] = len(tree["materials"]) - 1
        tree["meshes"].append(pane)
        tree["nodes"].append({"name": "pane", "mesh": len(tree["meshes"]) - 1})
        tree["scenes"][0]["nodes"].append(len(tree["nodes"]) - 1)
        self.write("scene.glb", gltf_file.glb(tree, data[28 + length:]))
        self.baked()
        asset = gltf_file.Asset(self.path("out.glb"))
        self.assertEqual(asset.primitives("pane")[0]["extensions"], {"FB_ngon_encoding": {}})
        self.assertNotIn("extensions", asset.primitives("cube")[0])
        self.assertIn("FB_ngon_encoding", asset.json["extensionsUsed"])

    def test_what_a_bake_has_written_is_no_cage_any_more(self):
        """Its materials are unlit and its colours baked, so a lamp has to be put back before it can be baked again."""
        self.polygons({"level": LEVEL})
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--keep-pbr", "--no-draco")
        self.bake("out.glb", "again.glb", "--quality", "draft", "--keep-pbr", "--no-draco", "--element-size", "1")
        count = {}
        for name in ("out.glb", "again.glb"):
            asset = gltf_file.Asset(self.path(name))
            primitive, = asset.primitives("cube")
            count[name] = asset.json["accessors"][primitive["indices"]]["count"]
        self.assertLessEqual(count["again.glb"], count["out.glb"])

    def test_creases_corners_and_holes(self):
        """A hard edge around the top is the uniform cubic B-spline of its square: the middle of a side of half length 1 is
        at (23 + 23 - 1 - 1) / 48 = 11/12, its corners at (4 + 1 - 1) / 6 = 2/3 on each axis."""
        _, quads = cube_quads()
        top = next(f for f, quad in enumerate(quads) if all(self.height(v) > CENTRE[1] for v in quad))
        ring = [[4 * top + k, 4 * top + (k + 1) % 4, 10] for k in range(4)]
        self.polygons({"level": LEVEL, "creases": ring}, texture=False)
        found, _, whole, _ = self.baked()
        rim = [p for p in found if p[1] > CENTRE[1] + HALF - 1e-6]
        self.assertAlmostEqual(max(p[1] for p in found), CENTRE[1] + HALF, delta=1e-6)
        self.assertAlmostEqual(max(min(abs(p[0]), abs(p[2])) for p in rim), HALF * 2 / 3, delta=1e-6)
        self.assertAlmostEqual(max(abs(p[0]) for p in rim), HALF * 11 / 12, delta=1e-6)
        self.polygons({"level": LEVEL, "corners": [[4 * top, 10]]}, texture=False)
        self.assertAlmostEqual(max(self.radii(self.baked()[0])), math.sqrt(3), delta=1e-6)
        self.polygons({"level": LEVEL, "creases": ring, "holes": [top]}, texture=False)
        self.assertLess(self.baked()[2], whole)

    def height(self, vertex):
        return cube_quads()[0][vertex][1]

    def test_an_adaptive_surface_spends_nothing_on_what_is_flat(self):
        self.polygons({"level": 5, "scheme": "bilinear", "adaptive": True}, texture=False)
        self.assertEqual(self.baked("--element-size", "1")[2], 12)
        self.polygons({"level": 5, "scheme": "catmull-clark", "adaptive": True}, texture=False)
        self.assertGreater(self.baked("--element-size", "1")[2], 100)

    def test_malformed_extras_are_refused(self):
        for extras, words in ((5, "no object"), ({"scheme": "butterfly"}, "scheme.*catmull-clark"),
                              ({"level": 9}, "level"), ({"level": 1.5}, "level"), ({"adaptive": 1}, "adaptive"),
                              ({"creases": [[0, 1]]}, "creases"), ({"creases": [[0, 2, 5]]}, "crease 0.*no edge"),
                              ({"creases": [[0, 900, 5]]}, "crease 0"), ({"corners": [["a", 1]]}, "corners"),
                              ({"corners": [[0, -1]]}, "corners"), ({"holes": [77]}, "hole 0"),
                              ({"holes": [0.5]}, "holes"), ({"holes": [0, 1, 2, 3, 4, 5]}, "hole"),
                              ({"scheme": "loop"}, "4 corners.*Loop")):
            self.polygons(extras)
            ran = self.run_hemibake("bake", "scene.glb", "-o", "out.glb")
            self.assertEqual(ran.returncode, command.BAD_INPUT, extras)
            self.assertRegex(ran.stderr, r"\Ahemibake: scene\.glb: [^\n]*" + words + r"[^\n]*\n\Z")
            self.assertEqual(self.left(), ["scene.glb"])

    def test_a_cage_that_is_no_surface_is_refused(self):
        """Three triangles on one edge."""
        made = scene()
        made.add_mesh("fin", ([[0, 1, 0], [0, 1.2, 0], [0.1, 1, 0], [-0.1, 1, 0], [0, 1, 0.1]],
                              [(0, 1, 2), (1, 0, 3), (0, 1, 4)]), 0)
        self.write("fin.glb", made.glb())
        ran = self.run_hemibake("bake", "fin.glb", "-o", "out.glb", "--subdivide", "1")
        self.assertEqual(ran.returncode, command.BAD_INPUT)
        self.assertRegex(ran.stderr, r"\Ahemibake: fin\.glb: [^\n]*fin[^\n]*\n\Z")
        self.assertEqual(self.left(), ["fin.glb", "scene.glb"])


if __name__ == "__main__":
    command.main()
