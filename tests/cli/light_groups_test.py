# SPDX-License-Identifier: MIT
"""Is light told apart by what it comes from, and does it add up? What each group gives against a bake of it alone."""

import json
import math
import os

from command import BAD_INPUT, USAGE, CommandCase, main
from gltf_file import Asset, Scene, box, lamp

ALL = {"DESK", "CEILING", "BULB", "SUN", "SKY"}
# Elements of one size and all triangles, so that bakes by other lights have the same vertices.
SAME_VERTICES = ("--scene-linear", "--no-draco", "--uniform", "--merge-error", "0", "--quality", "draft", "--method", "rows")


def moved(mesh, x, y=0.0):
    positions, triangles = mesh
    return [[p[0] + x, p[1] + y, p[2]] for p in positions], triangles


def scene(on=ALL, lamps=2):
    """A floor and a block under the sky, with two lamps and a bulb; of the lights those that are on."""
    made = Scene()
    white, red = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("red", (0.6, 0.1, 0.1))
    desk = made.add_material("desk lamp", (0, 0, 0), (8, 8, 8) if "DESK" in on else (0, 0, 0))
    made.json["materials"][desk]["extras"] = {"hemibake": {"group": "Desk"}}
    made.add_mesh("floor", ([[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]], [(0, 1, 2), (0, 2, 3)]), white)
    made.add_mesh("block", box((-0.25, 0, -0.25), (0.25, 0.8, 0.25)), red)
    made.add_mesh("some node", moved(lamp(0.2, 1.0), 1.0), desk)
    for i in range(1, lamps):
        light = made.add_material(f"lamp {i}", (0, 0, 0), (4, 4, 6) if "CEILING" in on else (0, 0, 0))
        made.add_mesh("Ceiling" if i == 1 else f"lamp {i}", moved(lamp(0.3, 1.5), -1.0, 0.01 * i), light)
    if "BULB" in on:
        made.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 3}]}}
        made.json.setdefault("extensionsUsed", []).append("KHR_lights_punctual")
        made.json["nodes"].append({"name": "bulb", "translation": [0, 1.2, 1],
                                   "extensions": {"KHR_lights_punctual": {"light": 0}}})
        made.json["scenes"][0]["nodes"].append(len(made.json["nodes"]) - 1)
    return made


def more(on):
    return (("--sun", "150,40,2") if "SUN" in on else ()) + (("--environment", "0.3,0.4,0.5") if "SKY" in on else ())


class Groups(CommandCase):
    def baked(self, on, *options):
        """{attribute: values} of all vertices, one after the other."""
        self.write("in.glb", scene(on).glb())
        self.bake("in.glb", "out.glb", *SAME_VERTICES, *more(on), *options)
        asset, found = Asset(self.path("out.glb")), {}
        for mesh in asset.json["meshes"]:
            for name, index in mesh["primitives"][0]["attributes"].items():
                found.setdefault(name, []).extend(asset.values(index))
        return found

    def test_groups_have_names_and_add_up_to_the_radiance(self):
        found = self.baked(ALL, "--light-groups")
        names = {f"_LIGHT_{name}" for name in ALL}
        self.assertEqual({name for name in found if name.startswith("_LIGHT_")}, names)
        for i, radiance in enumerate(found["_RADIOSITY"]):
            for c in range(3):
                self.assertAlmostEqual(sum(found[name][i][c] for name in names), radiance[c], delta=1e-5 * max(radiance))

    def test_what_a_group_gives_is_what_a_bake_of_it_alone_gives(self):
        found = self.baked(ALL, "--light-groups")
        for name in ALL:
            alone = self.baked({name})
            self.assertEqual(alone["POSITION"], found["POSITION"])
            off = level = 0.0
            for a, b in zip(alone["_RADIOSITY"], found[f"_LIGHT_{name}"]):
                off += sum((x - y) ** 2 for x, y in zip(a, b))
                level += sum(x * x for x in a)
            print(f"{name}: {100 * math.sqrt(off / level):.2f} % off")
            # Other rays, of a draft: its estimates are 1 to 3 %, of each of two bakes.
            self.assertLess(math.sqrt(off / level), 0.04, name)

    def test_groups_are_in_draco_and_beside_the_colours_of_the_display(self):
        self.write("in.glb", scene().glb())
        self.bake("in.glb", "out.glb", "--light-groups", "--quality", "draft", *more(ALL))
        with open(self.path("out.glb"), "rb") as f:
            data = f.read()
        tree = json.loads(data[20:20 + int.from_bytes(data[12:16], "little")])
        for mesh in tree["meshes"]:
            packed = mesh["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]
            self.assertEqual({name for name in packed if name.startswith("_LIGHT_")}, {f"_LIGHT_{name}" for name in ALL})
            self.assertIn("COLOR_0", packed)

    def test_a_bake_of_a_bake_does_not_pass_old_groups_on(self):
        self.write("in.glb", scene().glb())
        self.bake("in.glb", "out.glb", "--light-groups", "--no-draco", "--keep-pbr", "--quality", "draft", *more(ALL))
        self.bake("out.glb", "again.glb", "--no-draco", "--quality", "draft", *more(ALL))
        self.assertNotIn("_LIGHT_SUN", Asset(self.path("again.glb")).json["meshes"][0]["primitives"][0]["attributes"])

    def test_what_cannot_be_told_apart_is_refused_with_a_line(self):
        self.write("in.glb", scene().glb())
        self.write("many.glb", scene(lamps=66).glb())
        for status, arguments, word in (
                (BAD_INPUT, ("in.glb", "-o", "out.glb", "--method", "hybrid"), "groups of lights"),
                (BAD_INPUT, ("many.glb", "-o", "out.glb"), "extras.hemibake.group"),
                (USAGE, ("in.glb", "-o", "out.glb", "--keep-instances"), "--light-groups")):
            ran = self.run_hemibake("bake", *arguments, "--light-groups", "--quality", "draft", *more(ALL))
            self.assertEqual(ran.returncode, status, ran.stderr)
            self.assertIn(word, ran.stderr)
            self.assertFalse(os.path.exists(self.path("out.glb")))


if __name__ == "__main__":
    main()
