# SPDX-License-Identifier: MIT
"""Does a bake that comes out black say so, and why, in a line that fits the cause?"""

import json
import math

from command import BAD_INPUT, CommandCase, main
from gltf_file import Asset, Scene, box, lamp, png, room, sphere


def painted(rgb):
    """A room whose COLOR_0 is one colour, in a shell under a lamp."""
    scene = Scene()
    white, light = scene.add_material("white", (0.7, 0.7, 0.7)), scene.add_material("light", (0, 0, 0), (5, 5, 5))
    scene.add_mesh("hall", box((-1, 0, -1), (1, 2, 1), inward=True), white)
    scene.add_mesh("lamp", lamp(0.3, 1.9), light)
    if rgb:
        scene.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = scene._add_accessor([rgb] * 8, "VEC3", 5126)
    return scene


def moved(mesh, x, y, z):
    return [(p[0] + x, p[1] + y, p[2] + z) for p in mesh[0]], mesh[1]


def garden():
    """A lamp over a hut on a lawn."""
    scene = Scene()
    white, lawn, light = (scene.add_material(*m) for m in (("white", (0.7,) * 3), ("lawn", (0.3, 0.4, 0.2)), ("lamp", (0,) * 3, (10,) * 3)))
    scene.add_mesh("lawn", lamp(8, 0.0)[:1] + ([(0, 2, 1), (0, 3, 2)],), lawn)
    scene.add_mesh("hut", box((-1, 0, -1), (1, 2, 1)), white)
    scene.add_mesh("lantern", lamp(0.2, 3), light)
    return scene


class Black(CommandCase):
    def told(self, scene, words, *arguments):
        """The lines with these words, which the report has too."""
        self.write("in.glb", scene.glb())
        ran = self.bake("in.glb", "out.glb", "--quality", "draft", "--report", "report.json", *arguments)
        lines = [line for line in ran.stderr.splitlines() if words in line]
        self.assertEqual(len(lines), sum(words in line for line in json.loads(self.read("report.json"))["warnings"]))
        return lines

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

    def add_bulb(self, scene, name, opaque):
        shell = scene.add_material("glass", (0.8, 0.8, 0.8))
        if not opaque:
            scene.json["materials"][shell]["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": 1}}
            scene.json["extensionsUsed"].append("KHR_materials_transmission")
        scene.add_mesh("filament", sphere(8, (0.5, 1.2, 0.5), 0.03)[:2], 2)
        scene.add_mesh(name, sphere(12, (0.5, 1.2, 0.5), 0.08)[:2], shell)

    def add_point(self, scene, name, place):
        scene.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5, "name": name}]}}
        scene.json["extensionsUsed"].append("KHR_lights_punctual")
        scene.json["nodes"].append({"name": name, "translation": place, "extensions": {"KHR_lights_punctual": {"light": 0}}})
        scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)

    def test_lamps_that_light_their_housing_alone_are_named(self):
        words = "nothing but what closely surrounds"
        bulb, crate, strip, both = room(), room(), room(), room()
        self.add_bulb(bulb, "bulb", True)
        self.add_point(crate, "spark", (0.5, 1, 0.5))
        crate.add_mesh("crate", box((0.3, 0.8, 0.3), (0.7, 1.2, 0.7)), 0)
        strip.add_mesh("strip", box((-0.9, 1, -0.95), (0.9, 1.02, -0.93)), 2)
        strip.add_mesh("profile", box((-0.95, 0.98, -0.98), (0.95, 1.05, -0.9)), 0)
        for scene, name, shell in ((bulb, "filament", "bulb"), (crate, "spark", "crate"), (strip, "strip", "profile")):
            line, = self.told(scene, words)
            self.assertIn(f'1 of 2 lamps lights {words} it: "{name}", in mesh "{shell}"; open', line)
        self.add_bulb(both, "bulb", True)
        self.add_point(both, "spark", (-0.5, 1, -0.5))
        both.add_mesh("crate", box((-0.7, 0.8, -0.7), (-0.3, 1.2, -0.3)), 0)
        line, = self.told(both, words)
        self.assertIn(f'2 of 3 lamps light {words} them: "filament", "spark", in mesh "bulb", "crate"', line)

    def test_lamps_whose_light_gets_out_are_not(self):
        glass, shade, can, cupboard, wicker = (room() for _ in range(5))
        self.add_bulb(glass, "bulb", False)
        for scene in (shade, can):
            scene.json["materials"][0]["doubleSided"] = True
        positions, triangles = box((0.4, 0.9, 0.4), (0.6, 1.1, 0.6))
        self.add_point(shade, "spark", (0.5, 1, 0.5))
        shade.add_mesh("shade", (positions, triangles[:6] + triangles[8:]), 0)  # open above
        positions, triangles = box((0.54, 1.6, 0.54), (0.66, 1.9, 0.66))
        can.add_mesh("downlight", moved(lamp(0.05, 1.89), 0.6, 0, 0.6), 2)
        can.add_mesh("can", (positions, triangles[:4] + triangles[6:]), 0)  # and below
        self.add_point(cupboard, "spark", (0, 1, 0))
        self.add_bulb(wicker, "bulb", True)
        wicker.json["materials"][-1].update(alphaMode="MASK", pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
        wicker.add_image(png(4, 4, lambda y, x: (200, 200, 200, 255 * (x % 2)), channels=4))
        attributes = wicker.json["meshes"][-1]["primitives"][0]["attributes"]
        places = wicker.json["accessors"][attributes["POSITION"]]["count"]
        attributes["TEXCOORD_0"] = wicker._add_accessor([(i % 13 / 3, i // 13 / 3) for i in range(places)], "VEC2", 5126)
        for scene in (room(), painted((0.5, 0.5, 0.5)), glass, shade, can, cupboard, wicker):
            self.assertEqual(self.told(scene, "surrounds"), [])

    def test_what_shuts_out_the_sky_that_was_asked_for_is_named(self):
        sky, sun = ("--environment", "1,1,1"), ("--sun", "150,40,80000")
        for change, arguments, lines in (({}, sky, 1), ({"alphaMode": "BLEND"}, sky, 1), ({"doubleSided": True}, sun, 1), ({}, (), 0),
                                         ({"extensions": {"KHR_materials_unlit": {}}}, sky, 0), (None, sky, 0)):
            scene = garden()
            dome = scene.add_material("sky", (0.3, 0.5, 0.9))
            if change is not None:
                positions, triangles, _ = sphere(16, (0, 0, 0), 20)
                scene.add_mesh("dome", (positions, [t[::-1] for t in triangles]), dome)
                scene.json["materials"][dome].update(change)
            if change and "extensions" in change:
                scene.json["extensionsUsed"].append("KHR_materials_unlit")
            told = self.told(scene, "gets in: mesh", *arguments)
            self.assertEqual(len(told), lines, (change, arguments, told))
            for line in told:
                self.assertIn(f'nothing of the {arguments[0].replace("environment", "sky")[2:]} gets in: mesh "dome" is closed around', line)
        window = room()  # of 20 cm, by which a thousandth of the light gets in that would without its wall
        for name, low, high in (("left", (-1, 0), (-0.1, 2)), ("right", (0.1, 0), (1, 2)), ("below", (-0.1, 0), (0.1, 1)), ("above", (-0.1, 1.2), (0.1, 2))):
            strip = [(low[0], low[1], 1), (high[0], low[1], 1), (high[0], high[1], 1), (low[0], high[1], 1)]
            window.add_mesh(name, (strip, [(0, 2, 1), (0, 3, 2)]), 0)
        positions, triangles = box((-1, 0, -1), (1, 2, 1), inward=True)
        walls = [i for t in triangles if any(positions[v][2] < 0 for v in t) for i in t]
        self.assertEqual(len(walls), 30)
        window.json["meshes"][0]["primitives"][0]["indices"] = window._add_accessor(walls, "SCALAR", 5125)
        self.assertEqual(self.told(window, "gets in", *sky), [])
        scene = room()  # with a larger one
        positions, triangles = box((-1, 0, -1), (1, 2, 1), inward=True)
        scene.json["meshes"].pop(0), scene.json["nodes"].pop(0)
        for node in scene.json["nodes"]:
            node["mesh"] -= 1
        scene.json["scenes"][0]["nodes"].pop()
        scene.add_mesh("room", (positions, triangles[:6] + triangles[7:]), 0)
        self.assertEqual(self.told(scene, "gets in", *sky), [])

    def test_a_room_that_is_lit_from_outside_alone_is_named(self):
        """Its inside is most of it, here since furniture is part of its mesh: half of a hollow thing is none."""
        def hall(*furniture):
            scene, positions, triangles = Scene(), [], []
            white = scene.add_material("white", (0.7, 0.7, 0.7))
            scene.json["materials"][white]["doubleSided"] = True
            for part in (box((-2, 0, -2), (2, 3, 2)), *furniture):
                triangles += [tuple(i + len(positions) for i in t) for t in part[1]]
                positions += part[0]
            scene.add_mesh("hall", (positions, triangles), white)
            return scene

        for arguments in (("--environment", "1,1,1"), ("--sun", "150,40,80000"), ()):
            line, = self.told(hall(box((-1, 0.1, -1), (1, 1, 1))), "nothing lights the inside", *arguments)
            self.assertRegex(line, r'5\d % of what is baked is closed in and black, on mesh "hall"')
        self.assertEqual(self.told(hall(), "inside", "--environment", "1,1,1"), [])
        seen = hall()
        seen.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
        seen.json["nodes"].append({"name": "eye", "camera": 0, "translation": [0, 1, 0.5]})
        seen.json["scenes"][0]["nodes"].append(1)
        self.assertEqual(len(self.told(seen, 'no light gets in where the camera "eye" is', "--environment", "1,1,1")), 1)

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
