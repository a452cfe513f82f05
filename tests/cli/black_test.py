# SPDX-License-Identifier: MIT
"""Does a bake that comes out black say so, and why, in a line that fits the cause?"""

import json
import math

from command import BAD_INPUT, CommandCase, main
from gltf_file import Asset, Scene, box, lamp, png, room


def painted(rgb):
    """A room whose COLOR_0 is one colour, in a shell under a lamp."""
    scene = Scene()
    white, light = scene.add_material("white", (0.7, 0.7, 0.7)), scene.add_material("light", (0, 0, 0), (5, 5, 5))
    scene.add_mesh("hall", box((-1, 0, -1), (1, 2, 1), inward=True), white)
    scene.add_mesh("lamp", lamp(0.3, 1.9), light)
    if rgb:
        scene.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = scene._add_accessor([rgb] * 8, "VEC3", 5126)
    return scene


class Black(CommandCase):
    def lines(self, scene):
        self.write("in.glb", scene.glb())
        ran = self.bake("in.glb", "out.glb", "--quality", "draft", "--report", "report.json")
        report = json.loads(self.read("report.json"))
        color = report["color"]
        # Where nothing is lit there is nothing to estimate.
        self.assertEqual(report["error"]["estimate"] is None, color["reflecting_fraction"] == 0)
        return [line for line in ran.stderr.splitlines() if "black" in line], color

    def test_black_materials_are_named(self):
        scene = room()
        for material in scene.json["materials"][:2]:
            material["pbrMetallicRoughness"]["baseColorFactor"] = [0, 0, 0, 1]
        lines, color = self.lines(scene)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn('"white", "red"', lines[0])
        self.assertIn("base colour", lines[0])
        self.assertIn('"white"', color["black"])
        self.assertEqual((color["dark_fraction"], color["reflecting_fraction"]), (1, 0))

    def test_black_vertex_colours_are_named(self):
        lines, _ = self.lines(painted((0, 0, 0)))
        self.assertEqual(len(lines), 1, lines)
        self.assertIn('COLOR_0 of mesh "hall"', lines[0])

    def test_a_dark_room_with_a_camera_is_named(self):
        scene = Scene()
        white = scene.add_material("white", (0.7, 0.7, 0.7))
        scene.add_mesh("hall", box((-1, 0, -1), (1, 2, 1), inward=True), white)
        scene.add_mesh("shell", box((-1.1, -0.1, -1.1), (1.1, 2.1, 1.1)), white)
        scene.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
        scene.json["nodes"].append({"name": "eye", "camera": 0, "translation": [0, 1, 0.5]})
        scene.json["scenes"][0]["nodes"].append(2)
        lines, _ = self.lines(scene)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn('no light gets in where the camera "eye" is', lines[0])

    def test_a_mesh_without_any_light_is_named(self):
        """However little of all it is: here in a closed box that stands in a lit room."""
        scene = room()
        shell = scene.add_material("shell", (0.5, 0.5, 0.5))
        scene.add_mesh("crate", box((-0.9, -0.01, -0.9), (-0.6, 0.4, -0.6)), shell)
        scene.add_mesh("apple", box((-0.8, 0.2, -0.8), (-0.7, 0.3, -0.7)), shell)
        lines, color = self.lines(scene)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn('mesh "apple" is black, ', lines[0])
        self.assertIn("no light was found there", color["black"])
        self.assertLess(color["dark_fraction"], 0.2)

    def test_emission_through_a_black_texture_is_named(self):
        scene = painted(None)
        scene.json["nodes"].pop()
        scene.json["scenes"][0]["nodes"].pop()
        scene.add_image(png(4, 4, lambda y, x: (0, 0, 0)))
        scene.json["materials"][0].update(emissiveFactor=[1, 1, 1], emissiveTexture={"index": 0})
        attributes = scene.json["meshes"][0]["primitives"][0]["attributes"]
        attributes["TEXCOORD_0"] = scene._add_accessor([(0.5, 0.5)] * 8, "VEC2", 5126)
        self.write("in.glb", scene.glb())
        ran = self.bake("in.glb", "out.glb", "--quality", "draft", status=BAD_INPUT)
        self.assertIn("textures of all that emits are black", ran.stderr)
        self.assertNotIn("turn", ran.stderr)

    def test_a_closed_room_whose_lamp_is_lost_is_refused_with_its_name(self):
        scene = Scene()
        scene.add_mesh("hall", box((-1, 0, -1), (1, 2, 1), inward=True), scene.add_material("white", (0.7, 0.7, 0.7)))
        scene.json["extensions"] = {"EXT_lights_ies": {"lights": [{"uri": "gone.ies"}]}}
        scene.json["extensionsUsed"] = ["EXT_lights_ies"]
        scene.json["nodes"][0]["extensions"] = {"EXT_lights_ies": {"light": 0}}
        self.write("in.glb", scene.glb())
        said = self.bake("in.glb", "out.glb", "--quality", "draft", status=BAD_INPUT).stderr
        self.assertIn("nothing in the scene emits", said)
        self.assertIn("profile 0: its light is left out", said)
        self.assertNotIn("turn", said)
        self.assertIn("its lights are shut out", self.bake("in.glb", "out.glb", "--sun", "0,90,1000", status=BAD_INPUT).stderr)

    def test_clear_glass_is_not_called_black(self):
        scene = Scene()
        sheet = [[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], [(0, 1, 2), (0, 2, 3)]
        scene.add_mesh("floor", sheet, scene.add_material("grey", (0.5, 0.5, 0.5)))
        glass = scene.add_material("glass", (1, 1, 1))
        scene.json["materials"][glass]["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": 1}}
        scene.json["extensionsUsed"] = ["KHR_materials_transmission"]
        for i in range(12):
            scene.add_mesh(f"pane {i}", ([[x, 0.1 * (i + 1), z] for x, _, z in sheet[0]], sheet[1]), glass)
        lines, color = self.lines(scene)
        self.assertEqual((lines, color["black"], color["reflecting_fraction"]), ([], None, 1))

    def test_what_is_lit_is_not_called_black(self):
        for scene in (room(), painted((0.1, 0.1, 0.1))):
            lines, color = self.lines(scene)
            self.assertEqual((lines, color["black"]), ([], None))
            self.assertEqual(color["reflecting_fraction"], 1)

    def test_black_things_take_only_what_falls_on_them(self):
        """Nearly a third of the patches reflect nothing and never shoot: the rest is as bright by columns as by rows."""
        scene, found = room(), []
        black = scene.add_material("black", (0, 0, 0))
        for x, z in [(x, z) for x in (-0.7, 0, 0.7) for z in (-0.7, 0, 0.7) if x or z]:
            scene.add_mesh("thing", box((x - 0.12, 0, z - 0.12), (x + 0.12, 0.6, z + 0.12)), black)
        self.write("in.glb", scene.glb())
        for method in ("hybrid", "rows"):
            self.bake("in.glb", "out.glb", "--quality", "draft", "--method", method, "--scene-linear", "--no-draco", "--merge-error", "0")
            out = Asset(self.path("out.glb"))
            primitive = out.json["meshes"][1]["primitives"][0]
            places, light = (out.values(primitive["attributes"][name]) for name in ("POSITION", "_RADIOSITY"))
            corners, sums = [i for i, in out.values(primitive["indices"])], [0, 0]
            for a, b, c in zip(*[iter(corners)] * 3):
                u, v = ([places[i][k] - places[a][k] for k in range(3)] for i in (b, c))
                area = math.hypot(*(u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)))
                sums = [sums[0] + area, sums[1] + area * (light[a][0] + light[b][0] + light[c][0]) / 3]
            found.append(sums[1] / sums[0])
        print(f"box, by columns and rows: {found[0]:.4f} {found[1]:.4f}")
        self.assertAlmostEqual(found[0] / found[1], 1, delta=0.02)


if __name__ == "__main__":
    main()
