# SPDX-License-Identifier: MIT
"""Does --lights-from light an asset as the other one is lit, mesh by mesh, and is an asset of another geometry refused?"""

import json
import os

from command import BAD_INPUT, USAGE, CommandCase, main
from gltf_file import FLOAT, Asset, Scene, box, lamp, png

DRAFT = ("--method", "rows", "--quality", "draft", "--scene-linear", "--no-draco")
DARK = (0, 0, 0)


def at(mesh, x, z=0.0):
    positions, triangles = mesh
    return [[p[0] + x, p[1], p[2] + z] for p in positions], triangles


def scene(left=DARK, right=DARK, paint=(0.6, 0.1, 0.1), bulb=0.0, turned=False, wide=0.25):
    """A floor and a block under two lamps, one of which meets the block; turned: the other way round in the file. Means of
    the reflectance of the lamp with a picture are exact, whoever works them out."""
    made = Scene()
    white, red = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("red", paint)
    meshes = [("floor", ([[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]], [(0, 1, 2), (0, 2, 3)]), white),
              ("block", box((-wide, 0, -0.25), (wide, 0.8, 0.25)), red),
              ("left", at(lamp(0.2, 0.7), -0.3), made.add_material("left", (0.25, 0.25, 0.25), left)),
              ("right", at(lamp(0.2, 1.2), 1.0), made.add_material("right", DARK, right))]
    for name, mesh, material in meshes[::-1] if turned else meshes:
        made.add_mesh(name if not turned else f"other {name}", mesh, material)
    if bulb:
        made.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": bulb}]}}
        made.json.setdefault("extensionsUsed", []).append("KHR_lights_punctual")
        made.json["nodes"].append({"name": "bulb", "translation": [0, 1.2, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        made.json["scenes"][0]["nodes"].append(len(made.json["nodes"]) - 1)
    return made


class LightsFrom(CommandCase):
    def setUp(self):
        super().setUp()
        self.write("day.glb", scene(left=(8, 8, 8)).glb())
        self.write("night.glb", scene(right=(1, 2, 4), bulb=0.5).glb())
        self.write("other.glb", scene(right=(1, 2, 4), bulb=0.5, paint=(0, 1, 0), turned=True).glb())

    def radiosity(self, name):
        asset = Asset(self.path(name))
        return {mesh["name"]: asset.values(mesh["primitives"][0]["attributes"]["_RADIOSITY"]) for mesh in asset.json["meshes"]}

    def test_it_is_lit_as_the_other_is_and_stays_what_it_is(self):
        self.bake("night.glb", "night.out.glb", *DRAFT)
        self.bake("day.glb", "same.glb", *DRAFT, "--lights-from", "night.glb")
        # Names, numbers and the paint of the other asset do not count.
        self.bake("day.glb", "turned.glb", *DRAFT, "--lights-from", "other.glb")
        self.assertEqual(self.radiosity("same.glb"), self.radiosity("night.out.glb"))
        self.assertEqual(self.radiosity("turned.glb"), self.radiosity("night.out.glb"))

    def test_on_rows_lamps_go_on_and_off(self):
        self.bake("day.glb", "day.out.glb", "--rows", "day.rows", *DRAFT)
        kept = self.read("day.rows")
        self.bake("day.glb", "a.glb", "--rows", "day.rows", *DRAFT, "--lights-from", "night.glb")
        self.bake("night.glb", "b.glb", "--rows", "day.rows", *DRAFT)
        self.assertEqual(self.radiosity("a.glb"), self.radiosity("b.glb"))
        self.assertEqual(self.read("day.rows"), kept)
        lit = self.radiosity("a.glb")
        self.assertEqual(max(max(v) for v in lit["left"]) > 1, False)  # it is off, and shows what it reflects
        self.assertAlmostEqual(lit["right"][0][2], 4, delta=1e-3)

    def test_what_a_picture_glows_by_is_taken(self):
        def glowing(emits):
            made = scene(left=(1, 1, 1) if emits else DARK)
            made.json["meshes"][2]["primitives"][0]["attributes"]["TEXCOORD_0"] = made._add_accessor(
                [[0, 0], [0, 1], [1, 1], [1, 0]], "VEC2", FLOAT)
            if emits:
                made.add_image(png(2, 2, lambda row, column: (255, 0, 0) if column else (0, 0, 64)))
                made.json["materials"][2]["emissiveTexture"] = {"index": 0}
            return made.glb()
        self.write("dark.glb", glowing(False))
        self.write("glow.glb", glowing(True))
        for options in (DRAFT, (*DRAFT, "--rows", "dark.rows")):
            self.bake("dark.glb", "dark.out.glb", *options, "--environment", "0.1,0.1,0.1")
            self.bake("glow.glb", "glow.out.glb", *options, "--environment", "0.1,0.1,0.1")
            self.bake("dark.glb", "mixed.glb", *options, "--environment", "0.1,0.1,0.1", "--lights-from", "glow.glb")
            self.assertEqual(self.radiosity("mixed.glb"), self.radiosity("glow.out.glb"))
            self.assertNotEqual(self.radiosity("mixed.glb"), self.radiosity("dark.out.glb"))

    def test_groups_are_those_of_the_other(self):
        self.bake("day.glb", "out.glb", *DRAFT, "--lights-from", "night.glb", "--light-groups")
        attributes = Asset(self.path("out.glb")).json["meshes"][0]["primitives"][0]["attributes"]
        self.assertEqual({n for n in attributes if n.startswith("_LIGHT_")}, {"_LIGHT_RIGHT", "_LIGHT_BULB"})

    def test_a_stamp_and_a_list_for_make_name_it(self):
        self.bake("day.glb", "out.glb", *DRAFT, "--lights-from", "night.glb", "--depfile", "out.d")
        self.assertIn(b"night.glb", self.read("out.d"))
        self.assertIn("night.glb", json.dumps(Asset(self.path("out.glb")).json["asset"]["extras"]))

    def test_what_does_not_fit_is_refused_with_a_line(self):
        self.write("wide.glb", scene(right=(1, 2, 4), wide=0.3).glb())
        more, less = scene(right=(1, 2, 4)), scene(right=(1, 2, 4))
        more.add_mesh("third", lamp(0.1, 1.5), more.add_material("third", DARK, (1, 1, 1)))
        less.json["scenes"][0]["nodes"].pop(0)
        self.write("more.glb", more.glb())
        self.write("less.glb", less.glb())
        self.write("broken.glb", self.read("night.glb")[:100])
        for status, words, options in (
                (BAD_INPUT, ("wide.glb", '"block" (12 triangles)', "day.glb"), ("--lights-from", "wide.glb")),
                (BAD_INPUT, ("more.glb", '"third"', "day.glb"), ("--lights-from", "more.glb")),
                (BAD_INPUT, ("less.glb", '"floor"'), ("--lights-from", "less.glb")),
                (BAD_INPUT, ("broken.glb",), ("--lights-from", "broken.glb")),
                (BAD_INPUT, ("none.glb",), ("--lights-from", "none.glb")),
                (USAGE, ("--lights-from",), ("--lights-from", "night.glb", "--ao"))):
            ran = self.run_hemibake("bake", "day.glb", "-o", "out.glb", *DRAFT, *options)
            self.assertEqual(ran.returncode, status, ran.stderr)
            self.assertEqual(len(ran.stderr.splitlines()), 1, ran.stderr)
            for word in words:
                self.assertIn(word, ran.stderr)
            self.assertFalse(os.path.exists(self.path("out.glb")))
        ran = self.run_hemibake("bake", "day.glb", "night.glb", "-o", "out/", *DRAFT, "--lights-from", "night.glb")
        self.assertNotEqual(ran.returncode, 0)
        self.assertIn("--lights-from is for one input", ran.stderr)


if __name__ == "__main__":
    main()
