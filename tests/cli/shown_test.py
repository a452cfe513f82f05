# SPDX-License-Identifier: MIT
"""Does `hemibake render` show what an unlit viewer shows: vertex colours times factors and pictures, and no more than a mask leaves?"""

import os
import sys

import command
from gltf_file import FLOAT, Scene, png

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "field"))
from baked import pixels  # noqa: E402

CHECKER = png(2, 2, lambda y, x: (255, 0, 0) if x == y else (0, 0, 255))
BACKGROUND = 241  # 0.88 of light


def floor(material, picture=None, unlit=True, color=None):
    """A square of 2 m that faces up under a camera that sees all of it and no more than twice as much; u along x, v along z."""
    scene = Scene()
    if unlit:
        material = dict(material, extensions={"KHR_materials_unlit": {}})
        scene.json["extensionsUsed"] = ["KHR_materials_unlit"]
    scene.json["materials"].append(material)
    corners = [[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]]
    scene.add_mesh("floor", (corners, [(0, 1, 2), (0, 2, 3)]), 0)
    attributes = scene.json["meshes"][0]["primitives"][0]["attributes"]
    attributes["TEXCOORD_0"] = scene._add_accessor([[0, 0], [0, 1], [1, 1], [1, 0]], "VEC2", FLOAT)
    if color:
        attributes["COLOR_0"] = scene._add_accessor([list(color)] * 4, "VEC3", FLOAT)
    if picture:
        scene.add_image(picture)
    scene.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.9273, "znear": 0.1}}]  # 2 m from edge to edge 2 m below
    scene.json["nodes"].append({"name": "above", "camera": 0, "translation": [0, 3, 0], "rotation": [-0.5 ** 0.5, 0, 0, 0.5 ** 0.5]})
    scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)
    return scene


class Render(command.CommandCase):
    def picture(self, scene, *bake):
        self.write("in.glb", scene.glb())
        if bake:
            self.bake("in.glb", "out.glb", "--quality", "draft", *bake)
        ran = self.run_hemibake("render", "out.glb" if bake else "in.glb", "-o", "out.png", "--size", "64x64")
        self.assertEqual((ran.returncode, ran.stderr), (0, ""))
        _, _, rows, step = pixels(self.path("out.png"))
        return lambda x, y: tuple(rows[y][step * x:step * x + 3])

    def test_factor_and_picture_multiply_the_colours(self):
        half = 188  # sRGB's code for half of the light
        material = {"name": "m", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {"index": 0}}}
        at = self.picture(floor(material, CHECKER, color=(1, 1, 0.5)))
        for (x, y), right in {(24, 24): (half, 0, 0), (40, 40): (half, 0, 0), (40, 24): (0, 0, half), (24, 40): (0, 0, half)}.items():
            self.assertEqual(at(x, y), right, (x, y))

    def test_far_pictures_are_their_mean(self):
        fine = png(512, 512, lambda y, x: (255,) * 3 if (x + y) % 2 else (0,) * 3)
        material = {"name": "m", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
        at = self.picture(floor(material, fine))
        for x in range(20, 44, 3):
            # Half of the light; levels of a power of two are exact.
            self.assertLess(abs(at(x, 30)[0] - 188), 2)

    def test_what_a_mask_cuts_out_shows_what_is_behind(self):
        hole = png(2, 1, lambda y, x: (255, 255, 255, 255 if x else 0), channels=4)
        material = {"name": "m", "alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
        at = self.picture(floor(material, hole))
        self.assertEqual(at(24, 32), (BACKGROUND,) * 3)
        self.assertEqual(at(40, 32), (255,) * 3)

    def test_a_decal_has_no_border_in_pictures_of_a_bake(self):
        hole = png(2, 1, lambda y, x: (255, 255, 255, 255 if x else 0), channels=4)
        for mode in ("MASK", "BLEND"):
            scene = floor({"name": "m", "alphaMode": mode, "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}},
                          hole, unlit=False)
            at = self.picture(scene, "--environment", "1,1,1", "--preview", "preview.png", "--size", "64x64")
            _, _, rows, step = pixels(self.path("preview.png"))
            preview = lambda x, y: tuple(rows[y][step * x:step * x + 3])  # noqa: E731
            for shown in (at, preview):
                self.assertEqual(shown(24, 32), (BACKGROUND,) * 3, mode)
                self.assertNotEqual(shown(40, 32), (BACKGROUND,) * 3, mode)

    def test_a_preview_is_the_picture_of_what_is_written(self):
        """A textured floor, and over a part of it a textured unlit board and one that is left out."""
        scene = floor({"name": "m", "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}}, CHECKER, unlit=False)
        picture = {"baseColorTexture": {"index": 0}}
        scene.json["materials"] += [{"name": "unlit", "pbrMetallicRoughness": picture, "extensions": {"KHR_materials_unlit": {}}},
                                    {"name": "left", "pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]},
                                     "extras": {"hemibake": {"bake": False, "castShadow": False}}}]
        scene.json["extensionsUsed"] = ["KHR_materials_unlit"]
        for material, x in ((1, -0.7), (2, 0.3)):
            corners = [[x, 0.2, -0.2], [x, 0.2, 0.2], [x + 0.4, 0.2, 0.2], [x + 0.4, 0.2, -0.2]]
            scene.add_mesh(f"board {material}", (corners, [(0, 1, 2), (0, 2, 3)]), material)
            attributes = scene.json["meshes"][-1]["primitives"][0]["attributes"]
            attributes["TEXCOORD_0"] = scene._add_accessor([[0, 0], [0, 1], [1, 1], [1, 0]], "VEC2", FLOAT)
        for options in ((), ("--no-draco",), ("--scene-linear",)):
            self.picture(scene, "--environment", "1,1,1", "--preview", "preview.png", "--size", "64x64", *options)
            drawn, seen = (pixels(self.path(name)) for name in ("out.png", "preview.png"))
            self.assertEqual(drawn[:2], seen[:2])
            step = drawn[3]
            at = [tuple(seen[2][32][step * x:step * x + 3]) for x in (22, 41)]
            self.assertEqual(at[1], (0, 255, 0), "what is left out shows its factor")
            self.assertIn(at[0], ((255, 0, 0), (0, 0, 255)), "what is unlit shows its picture")
            # Draco moves corners by less than a pixel, so that only pixels of edges may differ by more than rounding.
            far = sum(max(abs(a - b) for a, b in zip(one[step * x:step * x + 3], other[step * x:step * x + 3])) > 2
                      for one, other in zip(drawn[2], seen[2]) for x in range(64))
            self.assertLessEqual(far, 0 if "--no-draco" in options else 40, options)

    def test_a_bake_keeps_its_picture_in_it(self):
        material = {"name": "m", "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0}}}
        for options in ((), ("--keep-pbr",), ("--no-draco",)):
            at = self.picture(floor(material, CHECKER, unlit=False), "--environment", "1,1,1", "--exposure", "0", "--view", "Standard", *options)
            for x, y in ((24, 24), (40, 24)):
                red, green, blue = at(x, y)
                self.assertEqual(green, 0)
                self.assertGreater(abs(red - blue), 150, (options, x, y))


if __name__ == "__main__":
    command.main()
