# SPDX-License-Identifier: MIT
"""Does --subdivide bake the limit surface of a cage? A cube in a lit room, in both schemes.

Every mesh is taken as a cage: an open sheet keeps its outline, so the room here is six separate walls.
"""

import json
import math

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


class Subdivision(command.CommandCase):
    def setUp(self):
        super().setUp()
        self.write("scene.glb", scene().glb())

    def baked(self, *arguments):
        """Positions and radiosities of the cube, and the report."""
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--scene-linear", "--no-draco", "--report", "out.json",
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
        counts = [self.baked("--subdivide", level)[2] for level in (1, 2, 3)]
        self.assertLess(counts[0], counts[1])
        self.assertLess(counts[1], counts[2])

    def test_a_subdivided_bake_is_compressed_too(self):
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--subdivide", LEVEL)
        self.succeed("render", "out.glb", "-o", "out.png", "--size", "64x48")

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
