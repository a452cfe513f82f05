# SPDX-License-Identifier: MIT
"""Does 'compare' say how far a bake is from truth or from another bake, and where?"""

import json

from command import BAD_INPUT, OUTPUT, CommandCase, main, probes
from gltf_file import Scene
from render_test import pixels


def plates(light):
    """Two plates that emit and reflect nothing: what is baked is known. The right one emits `light`."""
    scene = Scene()
    for x, name, L in ((0, "left", 1.0), (3, "right", light)):
        corners = [[x, 0, 0], [x, 0, 2], [x + 2, 0, 2], [x + 2, 0, 0]]
        scene.add_mesh(name, (corners, [(0, 1, 2), (0, 2, 3)]), scene.add_material(name, (0, 0, 0), (L,) * 3))
    return scene


class Compare(CommandCase):
    def setUp(self):
        super().setUp()
        for name, light in (("one", 1.0), ("two", 2.0)):
            self.write(f"{name}.in.glb", plates(light).glb())
            self.bake(f"{name}.in.glb", f"{name}.glb", "--scene-linear", "--quality", "draft", "--no-draco")

    def compare(self, *arguments):
        return json.loads(self.succeed("compare", *arguments, "--json").stdout)

    def test_a_bake_is_compared_with_another_uniformly_by_area(self):
        self.assertLess(self.compare("one.glb", "one.glb")["error"], 1e-6, "but for rounding to float")
        found = self.compare("one.glb", "two.glb")
        # Half of the area is off by 1: sqrt(1 / (1 + 4)).
        self.assertAlmostEqual(found["error"], 0.2**0.5, delta=1e-4)
        for node, error in zip(found["nodes"], (0, 0.5), strict=True):
            self.assertAlmostEqual(node["error"], error, delta=1e-6)
        self.assertEqual(found["unmatched"], 0)
        self.assertEqual(found["nodes"][0]["matched"], found["nodes"][1]["matched"])

    def test_the_worst_points_are_listed_with_their_share(self):
        up = (0, 1, 0)
        self.write("p.hprb", probes([((0.5, 0, 0.5), up, (1, 1, 1)), ((3.5, 0, 0.5), up, (3, 3, 3)), ((4, 0, 1), up, (2, 2, 2))]))
        worst = self.compare("one.glb", "p.hprb", "--worst", "2")["worst"]
        self.assertEqual([one["node"] for one in worst], ["right", "right"])
        self.assertEqual([one["position"] for one in worst], [[3.5, 0, 0.5], [4, 0, 1]])
        for one, share in zip(worst, (0.8, 0.2)):
            self.assertAlmostEqual(one["share"], share, delta=1e-5)
        table = self.succeed("compare", "one.glb", "p.hprb", "--worst", "5").stdout
        self.assertEqual(len(table[table.index("where it sits") :].splitlines()), 4, "as many as there are")

    def test_the_heatmap_is_dark_where_it_is_right(self):
        self.succeed("compare", "one.glb", "two.glb", "--heatmap", "h.png", "--size", "64x64", "--look-from", "2.5,8,1",
                     "--look-at", "2.5,0,1")
        rows = pixels(self.read("h.png"))
        left, right = rows[32][22], rows[32][42]
        self.assertLess(max(left), 40)
        self.assertGreater(min(right[:2]), 200)

    def test_what_cannot_be_compared_or_drawn_is_one_line(self):
        for arguments, status, word in (
            (("one.glb", "one.in.glb"), BAD_INPUT, "no mesh has _RADIOSITY or COLOR_0"),
            (("one.glb", "nowhere.glb"), BAD_INPUT, "nowhere.glb"),
            (("one.glb", "two.glb", "--heatmap", "no/h.png"), OUTPUT, "cannot be written"),
            (("one.glb", "two.glb", "--heatmap", "h.png", "--camera", "none"), BAD_INPUT, "there is no camera"),
        ):
            ran = self.run_hemibake("compare", *arguments)
            self.assertEqual((ran.returncode, len(ran.stderr.splitlines())), (status, 1), ran.stderr)
            self.assertIn(word, ran.stderr)

    def test_where_one_has_colours_only_these_are_compared(self):
        self.bake("one.in.glb", "plain.glb", "--quality", "draft")
        ran = self.succeed("compare", "one.glb", "plain.glb")
        self.assertIn("comparing COLOR_0", ran.stderr)


if __name__ == "__main__":
    main()
