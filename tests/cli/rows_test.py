# SPDX-License-Identifier: MIT
"""Is a scene lit anew on the rows of an earlier bake as a bake of its own would light it, and is what does not fit refused?"""

import math
import os

from command import BAD_INPUT, CommandCase, main
from gltf_file import Asset, Scene, box, lamp

DRAFT = ("--quality", "draft", "--scene-linear", "--no-draco")
# Elements of one size and all triangles, so that bakes by other lights have the same vertices.
SAME_VERTICES = ("--uniform", "--merge-error", "0")
DAY, NIGHT = ("--environment", "0.3,0.4,0.5"), ("--sun", "150,40,2", "--environment", "0.02,0.02,0.05")


def scene(emission=(8, 8, 8), width=0.25):
    made = Scene()
    white, red = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("red", (0.6, 0.1, 0.1))
    made.add_mesh("floor", ([[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]], [(0, 1, 2), (0, 2, 3)]), white)
    made.add_mesh("block", box((-width, 0, -0.25), (width, 0.8, 0.25)), red)
    made.add_mesh("lamp", lamp(0.2, 1.2), made.add_material("lamp", (0, 0, 0), emission))
    return made


class Rows(CommandCase):
    def setUp(self):
        super().setUp()
        self.write("day.glb", scene().glb())
        self.write("night.glb", scene((1, 2, 4)).glb())
        self.write("wide.glb", scene(width=0.3).glb())

    def test_the_same_lights_give_the_same_bytes(self):
        self.bake("day.glb", "first.glb", "--rows", "day.rows", *DRAFT, *DAY)
        kept = self.read("day.rows")
        self.bake("day.glb", "again.glb", "--rows", "day.rows", *DRAFT, *DAY)
        self.assertEqual(self.read("first.glb"), self.read("again.glb"))
        self.assertEqual(self.read("day.rows"), kept)

    def test_other_lights_give_what_a_bake_of_theirs_gives(self):
        self.bake("day.glb", "day.out.glb", "--rows", "day.rows", *DRAFT, *SAME_VERTICES, *DAY)
        for out in ("relit.glb", "again.glb"):
            self.bake("night.glb", out, "--rows", "day.rows", *DRAFT, *SAME_VERTICES, *NIGHT)
        self.assertEqual(self.read("relit.glb"), self.read("again.glb"))
        self.bake("night.glb", "alone.glb", "--method", "rows", *DRAFT, *SAME_VERTICES, *NIGHT)
        off = level = 0.0
        relit, alone = Asset(self.path("relit.glb")), Asset(self.path("alone.glb"))
        for a, b in zip(relit.json["meshes"], alone.json["meshes"]):
            a, b = (m["primitives"][0]["attributes"] for m in (a, b))
            self.assertEqual(relit.values(a["POSITION"]), alone.values(b["POSITION"]))
            for x, y in zip(relit.values(a["_RADIOSITY"]), alone.values(b["_RADIOSITY"])):
                off += sum((p - q) ** 2 for p, q in zip(x, y))
                level += sum(q * q for q in y)
        print(f"relit: {100 * math.sqrt(off / level):.2f} % off")
        self.assertLess(math.sqrt(off / level), 0.03)  # both are drafts, of other rays

    def test_groups_of_lights_settle_on_rows_that_are_read(self):
        self.bake("day.glb", "day.out.glb", "--rows", "day.rows", *DRAFT, *DAY)
        self.bake("night.glb", "out.glb", "--rows", "day.rows", "--light-groups", *DRAFT, *NIGHT)
        attributes = Asset(self.path("out.glb")).json["meshes"][0]["primitives"][0]["attributes"]
        self.assertEqual({n for n in attributes if n.startswith("_LIGHT_")}, {"_LIGHT_LAMP", "_LIGHT_SUN", "_LIGHT_SKY"})

    def refused(self, asset, word, *options, status=BAD_INPUT):
        ran = self.run_hemibake("bake", asset, "-o", "out.glb", "--rows", "day.rows", *DRAFT, *DAY, *options)
        self.assertEqual(ran.returncode, status, ran.stderr)
        self.assertIn(word, ran.stderr)
        self.assertFalse(os.path.exists(self.path("out.glb")))

    def test_what_does_not_fit_is_refused_with_a_line_and_stays(self):
        self.bake("day.glb", "day.out.glb", "--rows", "day.rows", *DRAFT, *DAY)
        kept = self.read("day.rows")
        self.refused("day.glb", "--element-size", "--quality", "medium")
        self.refused("day.glb", "--seed", "--seed", "7")
        self.refused("wide.glb", "day.rows")
        self.refused("day.glb", "rows are kept of one bake", "--error", "0.05")
        self.refused("day.glb", "method rows", "--method", "hybrid")
        self.assertEqual(self.read("day.rows"), kept)
        for size in (0, 7, 20, 100, len(kept) // 2, len(kept) - 1):
            self.write("day.rows", kept[:size])
            self.refused("day.glb", "day.rows")
        for place in (3, 9, 13, 40, len(kept) // 3, len(kept) - 3):
            self.write("day.rows", kept[:place] + bytes([kept[place] ^ 16]) + kept[place + 1:])
            self.refused("day.glb", "day.rows")

    def test_several_inputs_are_no_one_geometry(self):
        ran = self.run_hemibake("bake", "day.glb", "night.glb", "-o", "out/", "--rows", "day.rows", *DRAFT)
        self.assertNotEqual(ran.returncode, 0)
        self.assertIn("--rows is for one input", ran.stderr)


if __name__ == "__main__":
    main()
