# SPDX-License-Identifier: MIT
"""Does 'render' take its picture from where it is told to, of all that is seen from there?"""

import struct
import zlib

import command
import gltf_file
from command import BAD_INPUT, USAGE

GROUND = 240  # 0.88 linear as sRGB


def pixels(data):
    """rows[y][x] = (r, g, b) of an 8-bit PNG with alpha, whose rows may be filtered."""
    at, body, wide, high = 8, b"", 0, 0
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        if kind == b"IHDR":
            wide, high, _, color = struct.unpack(">IIBB", data[at + 8 : at + 18])
        if kind == b"IDAT":
            body += data[at + 8 : at + 8 + size]
        at += 12 + size
    step, raw = {2: 3, 6: 4}[color], zlib.decompress(body)
    before, rows = bytearray(wide * step), []
    for y in range(high):
        kind, row = raw[y * (wide * step + 1)], bytearray(raw[y * (wide * step + 1) + 1 : (y + 1) * (wide * step + 1)])
        for i, value in enumerate(row):
            a, b, c = row[i - step] if i >= step else 0, before[i], before[i - step] if i >= step else 0
            paeth = min((a, b, c), key=lambda x: (abs(a + b - c - x), (a, b, c).index(x)))
            row[i] = (value + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        rows.append([tuple(row[i : i + 3]) for i in range(0, wide * step, step)])
        before = row
    return rows


class Render(command.CommandCase):
    def setUp(self):
        """A red cube at x = 3 and a green one at z = 3, both a metre high."""
        super().setUp()
        scene = gltf_file.Scene()
        for name, corner, rho in (("red", (2.5, 0, -0.5), (0.8, 0.02, 0.02)), ("green", (-0.5, 0, 2.5), (0.02, 0.8, 0.02))):
            scene.add_mesh(name, gltf_file.box(corner, tuple(x + 1 for x in corner)), scene.add_material(name, rho))
        for name, eye in (("to red", (8, 0.5, 0)), ("up", (0, 0.5, 8))):
            scene.json.setdefault("cameras", []).append({"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}})
            turn = [0, 0.7071067811865476, 0, 0.7071067811865476] if eye[0] else [0, 0, 0, 1]
            scene.json["nodes"].append({"name": name, "camera": len(scene.json["cameras"]) - 1, "translation": eye, "rotation": turn})
            scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)
        self.write("scene.glb", scene.glb())
        self.bake("scene.glb", "out.glb", "--quality", "draft")

    def middle(self, name):
        rows = pixels(self.read(name))
        r, g, b = rows[len(rows) // 2][len(rows[0]) // 2]
        return "ground" if min(r, g, b) >= GROUND - 2 else "red" if r > g else "green"

    def picture(self, *arguments):
        self.succeed("render", "out.glb", "-o", "p.png", "--size", "32x32", *arguments)
        return self.middle("p.png")

    def test_it_looks_from_where_and_at_what_it_is_told(self):
        self.assertEqual(self.picture("--look-from", "8,0.5,0", "--look-at", "3,0.5,0"), "red")
        self.assertEqual(self.picture("--look-from", "0,.5,8", "--look-at", "0,0.5,3"), "green")
        self.assertEqual(self.picture("--look-from", "3,9,0", "--look-at", "3,0,0"), "red")
        self.assertEqual(self.picture("--look-from", "3,-9,0", "--look-at", "3,0,0"), "red")
        self.assertEqual(self.picture("--look-from", "8,0.5,0", "--look-at", "8,9,0"), "ground")

    def test_without_a_target_it_looks_at_the_middle(self):
        """Which lies between the cubes."""
        self.assertEqual(self.picture("--look-from", "8,0.5,8"), "ground")
        self.assertEqual(self.read("p.png"), (self.picture("--look-from", "8,0.5,8", "--look-at", "1.5,0.5,1.5"), self.read("p.png"))[1])

    def test_a_preview_looks_the_same_way(self):
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--preview", "p.png", "--size", "32x32", "--look-from", "3,9,0", "--look-at", "3,0,0")
        self.assertEqual(self.middle("p.png"), "red")

    def test_all_cameras_have_a_picture_each(self):
        self.succeed("render", "out.glb", "-o", "all.png", "--all-cameras", "--size", "32x32")
        self.assertEqual([name for name in self.left() if name.startswith("all")], ["all-0.png", "all-1.png"])
        self.assertEqual([self.middle(f"all-{i}.png") for i in range(2)], ["red", "green"])
        for i in range(2):
            self.succeed("render", "out.glb", "-o", "one.png", "--camera", i, "--size", "32x32")
            self.assertEqual(self.read("one.png"), self.read(f"all-{i}.png"))

    def test_what_makes_no_view_is_refused(self):
        for status, words, *arguments in ((BAD_INPUT, "needs --look-from", "--look-at", "1,2,3"), (USAGE, "is not what it takes", "--look-from", "1,2"),
                                          (USAGE, "leave it out, or '--camera'", "--all-cameras", "--camera", "0"),
                                          (USAGE, "leave it out, or '--turntable'", "--all-cameras", "--turntable", "3"),
                                          (USAGE, "leave it out, or '--look-from'", "--all-cameras", "--look-from", "1,2,3"),
                                          (USAGE, "is not what it takes", "--look-from", "1,2,nan"), (USAGE, "is not what it takes", "--look-from", "1,2,3,4"),
                                          (BAD_INPUT, "where --look-from is", "--look-from", "1,2,3", "--look-at", "1,2,3.0"),
                                          (BAD_INPUT, "where --look-from is", "--look-from", "1,0,3", "--look-at", "1,-0,3")):
            ran = self.run_hemibake("render", "out.glb", "-o", "no.png", *arguments)
            self.assertEqual((ran.returncode, ran.stderr.count("\n")), (status, 1), ran.stderr)
            self.assertIn(words, ran.stderr)
        self.write("room.glb", gltf_file.room().glb())
        self.bake("room.glb", "none.glb", "--quality", "draft")
        ran = self.run_hemibake("render", "none.glb", "-o", "no.png", "--all-cameras")
        self.assertEqual((ran.returncode, ran.stderr), (BAD_INPUT, "hemibake: none.glb: --all-cameras: it has no camera\n"))
        self.assertNotIn("no.png", self.left())

    def test_a_turntable_goes_all_around(self):
        self.succeed("render", "out.glb", "-o", "turn.png", "--size", "32x32", "--turntable", "4", "--look-from", "9,0.5,0",
                     "--look-at", "3,0.5,0")
        self.assertEqual([name for name in self.left() if "turn" in name], [f"turn-{i}.png" for i in range(4)])
        self.assertEqual([self.middle(f"turn-{i}.png") for i in range(4)], ["red"] * 4)
        self.succeed("render", "out.glb", "-o", "one.png", "--size", "32x32", "--look-from", "9,0.5,0", "--look-at", "3,0.5,0")
        self.assertEqual(self.read("one.png"), self.read("turn-0.png"))
        # Without a place to look from all of it is in view, and the middle, between the cubes, is seen past them.
        self.succeed("render", "out.glb", "-o", "all.png", "--size", "64x64", "--turntable", "3")
        for i in range(3):
            rows = pixels(self.read(f"all-{i}.png"))
            edge = rows[0] + rows[-1] + [row[k] for row in rows for k in (0, -1)]
            self.assertTrue(all(min(pixel) >= GROUND - 2 for pixel in edge))
            self.assertTrue(any(r > 2 * g for row in rows for r, g, _ in row) or any(g > 2 * r for row in rows for r, g, _ in row))

    def sheets(self, *panes):
        """What is seen at a white wall past panes (alpha, rgb or a change of its material), the nearest first, in linear light."""
        scene = gltf_file.Scene()
        for i, (alpha, rgb, change) in enumerate((*panes, (1, (1, 1, 1), {}))):
            name, z = f"pane {i}", -float(i)
            scene.add_mesh(name, ([(-9, -9, z), (9, -9, z), (9, 9, z), (-9, 9, z)], [(0, 1, 2), (0, 2, 3)]), scene.add_material(name, rgb))
            scene.json["materials"][i].update(extensions={"KHR_materials_unlit": {}}, **change)
            scene.json["materials"][i]["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha
            if "texture" in scene.json["materials"][i]:
                scene.json["materials"][i]["pbrMetallicRoughness"]["baseColorTexture"] = scene.json["materials"][i].pop("texture")
                scene.add_image(gltf_file.png(2, 1, lambda y, x: (255, 255, 255, 51), channels=4))
                attributes = scene.json["meshes"][i]["primitives"][0]["attributes"]
                attributes["TEXCOORD_0"] = scene._add_accessor([(0, 0), (1, 0), (1, 1), (0, 1)], "VEC2", gltf_file.FLOAT)
        scene.json["extensionsUsed"] = ["KHR_materials_unlit"]
        self.write("panes.glb", scene.glb())
        self.succeed("render", "panes.glb", "-o", "p.png", "--size", "16x16", "--look-from", "0,0,3", "--look-at", "0,0,0")
        rows = pixels(self.read("p.png"))
        return [((c / 255 + 0.055) / 1.055) ** 2.4 if c > 10 else c / 255 / 12.92 for c in rows[8][8]]

    def test_what_blends_is_drawn_over_what_is_behind(self):
        red, blue, blend = (1, 0, 0), (0, 0, 1), {"alphaMode": "BLEND"}
        for panes, seen in ((((0.3, red, blend),), (1, 0.7, 0.7)), (((0.7, red, blend),), (1, 0.3, 0.3)), (((0.3, red, {}),), red),
                            (((0, red, blend),), (1, 1, 1)), (((1, red, blend),), red),
                            (((0.5, red, blend), (0.5, blue, blend)), (0.75, 0.25, 0.5)), (((0.5, blue, blend), (0.5, red, blend)), (0.5, 0.25, 0.75)),
                            (((0.5, red, blend), (1, blue, {}), (0.5, (0, 1, 0), blend)), (0.5, 0, 0.5)),
                            (((1, red, {"texture": {"index": 0}, **blend}),), (1, 0.8, 0.8)), (((0.5, red, {"texture": {"index": 0}, **blend}),), (1, 0.9, 0.9))):
            for a, b in zip(self.sheets(*panes), seen):
                self.assertAlmostEqual(a, b, delta=0.01, msg=panes)

    def test_far_from_the_origin_is_drawn_as_near_it(self):
        found = []
        for away in (0, 4.5e6):
            scene = gltf_file.Scene()
            scene.add_mesh("floor", gltf_file.box((-2, -0.1, -2), (2, 0, 2)), scene.add_material("white", (0.7, 0.7, 0.7)))
            scene.add_mesh("ball", gltf_file.sphere(16, (0, 0.5, 0), 0.5), scene.add_material("red", (0.8, 0.1, 0.1)))
            scene.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}}]
            scene.json["nodes"] += [{"camera": 0, "translation": [0, 1, 5]}, {"translation": [away, 0, away / 2], "children": [0, 1, 2]}]
            scene.json["scenes"][0]["nodes"] = [3]
            self.write("in.glb", scene.glb())
            self.bake("in.glb", "far.glb", "--quality", "draft", "--environment", "1,1,1", "--exposure", "0")
            for i, arguments in enumerate(((), ("--look-from", f"{away + 3},2,{away / 2 + 3}"), ("--turntable", 2))):
                self.succeed("render", "far.glb", "-o", f"{i}.png", "--size", "48x32", *arguments)
            found.append([pixel for name in ("0.png", "1.png", "2-0.png") for row in pixels(self.read(name)) for pixel in row])
        self.assertGreater(sum(r > 2 * g for r, g, _ in found[0]), 100, "the ball is seen")
        self.assertLessEqual(max(abs(a - b) for one, two in zip(*found) for a, b in zip(one, two)), 40, "a sample of nine beside an edge")

    def test_what_is_not_baked_is_refused(self):
        ran = self.run_hemibake("render", "scene.glb", "-o", "no.png")
        self.assertEqual((ran.returncode, ran.stderr.count("\n")), (BAD_INPUT, 1), ran.stderr)
        self.assertIn("bake it first", ran.stderr)
        self.assertNotIn("no.png", self.left())

    def test_paint_and_a_backdrop_are_no_bake(self):
        def scene(paint, *extensions):
            made = gltf_file.Scene()
            for i, extension in enumerate(extensions):
                made.add_mesh(f"box {i}", gltf_file.box((3 * i, 0, 0), (3 * i + 1, 1, 1)), made.add_material(f"stuff {i}", (0.5, 0.5, 0.5)))
                if extension:
                    made.json["materials"][i]["extensions"] = {extension: {}}
                    made.json["extensionsUsed"] = [extension]
            if paint:
                primitive = made.json["meshes"][0]["primitives"][0]
                primitive["attributes"]["COLOR_0"] = primitive["attributes"]["POSITION"]
            self.write("in.glb", made.glb())
            return self.run_hemibake("render", "in.glb", "-o", "p.png", "--size", "8x8").returncode

        unlit = "KHR_materials_unlit"
        self.assertEqual([scene(True, None), scene(False, None, unlit), scene(True, None, unlit)], [BAD_INPUT] * 3)
        # What others have baked into textures is unlit throughout, and so drawn as it is.
        self.assertEqual([scene(False, unlit, unlit), scene(True, unlit, None)], [command.DONE] * 2)


if __name__ == "__main__":
    command.main()
