# SPDX-License-Identifier: MIT
"""Does ugly input bake as converters/tessellate/README.md says? Duplicates, crossings, overlaps, inversions, scales."""

import json
import math
import unittest

import command
import gltf_file

CORNER = (0.4, 0, 0.4), (0.6, 0.5, 0.6)


def scaled(mesh, scale):
    return [[x * scale for x in p] for p in mesh[0]], mesh[1]


def room(scale=1.0, *more):
    """The room of gltf_file with further meshes (name, mesh)."""
    made = gltf_file.Scene()
    white, red = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("red", (0.6, 0.1, 0.1))
    light = made.add_material("lamp", (0, 0, 0), (10, 10, 10))
    for name, mesh, material in (("room", gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True), white),
                                 ("box", gltf_file.box((-0.25, 0, -0.25), (0.25, 0.5, 0.25)), red),
                                 ("lamp", gltf_file.lamp(0.3, 1.9), light)):
        made.add_mesh(name, scaled(mesh, scale), material)
    for name, mesh in more:
        made.add_mesh(name, scaled(mesh, scale), white)
    return made


class Ugly(command.CommandCase):
    def baked(self, made):
        """Radiance by mesh, and the report's scene; every number must be finite and none negative."""
        self.write("scene.glb", made.glb())
        # All triangles, so that there are vertices all over each face to look at.
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--scene-linear", "--no-draco", "--merge-error", "0", "--report",
                  "out.json")
        asset, report = gltf_file.Asset(self.path("out.glb")), json.loads(self.read("out.json"))
        light = {}
        for name in [node["name"] for node in asset.json["nodes"]]:
            light[name] = [(p, c) for primitive in asset.primitives(name)
                           for p, c in zip(asset.values(primitive["attributes"]["POSITION"]),
                                           asset.values(primitive["attributes"]["_RADIOSITY"]))]
            for _, rgb in light[name]:
                self.assertTrue(all(math.isfinite(x) and x >= 0 for x in rgb), (name, rgb))
        self.assertLess(abs(report["energy"]["residual_fraction"]), 1e-9)
        return light, report["scene"]

    def mean(self, light, name="room"):
        return sum(rgb[0] for _, rgb in light[name]) / len(light[name])

    def test_a_tenth_of_a_millimetre_and_ten_kilometres_look_alike(self):
        """Positions are rounded to floats at another place of their last bit: 6e-8 of what they are."""
        plain, _ = self.baked(room())
        for scale in (1e-4, 1e4):
            light, scene = self.baked(room(scale))
            worst = max(abs(x - y) for name in plain for (_, a), (_, b) in zip(plain[name], light[name])
                        for x, y in zip(a, b))
            self.assertEqual({name: len(rows) for name, rows in light.items()},
                             {name: len(rows) for name, rows in plain.items()})
            print(f"scale {scale:g}: radiance differs by {worst:.1e} at most")
            self.assertLess(worst, 1e-5)
            self.assertEqual(scene["degenerate_triangles"], 0)

    def test_duplicates_change_nothing(self):
        """All triangles twice, the second time from another corner; the reference has them once."""
        positions, triangles = gltf_file.box(*CORNER)
        once, scene = self.baked(room(1, ("more", (positions, triangles))))
        self.assertEqual((scene["duplicate_triangles"], scene["nonmanifold_edges"]), (0, 0))
        twice, scene = self.baked(room(1, ("more", (positions, triangles + [t[1:] + t[:1] for t in triangles]))))
        self.assertEqual((scene["duplicate_triangles"], scene["nonmanifold_edges"]), (12, 0))
        self.assertEqual(once, twice)

    def test_edges_of_three_triangles_are_counted(self):
        positions, triangles = gltf_file.box(*CORNER)
        a, b, _ = triangles[0]
        fin = positions + [[0.5, 0.7, 0.5]], triangles + [(a, b, 8)]
        _, scene = self.baked(room(1, ("more", fin)))
        self.assertEqual(scene["nonmanifold_edges"], 1)

    def test_a_copy_in_the_same_place_takes_no_light_from_the_room(self):
        """The same box once more, as another mesh: its surfaces are hidden in the first's. What the room sees may only
        change by where samples fall, within the error of the bake itself (6 % at this quality)."""
        once, scene = self.baked(room())
        self.assertEqual(scene["overlapping_triangles"], 2)  # the box's underside, in the floor
        positions, triangles = gltf_file.box((-0.25, 0, -0.25), (0.25, 0.5, 0.25))
        light, scene = self.baked(room(1, ("copy", (positions, [t[1:] + t[:1] for t in triangles]))))
        self.assertEqual((scene["overlapping_triangles"], scene["coincident_meshes"]), (2 + 12, 0))
        print(f"coincident copy: room at {self.mean(light) / self.mean(once):.3f} of itself")
        self.assertAlmostEqual(self.mean(light), self.mean(once), delta=0.06 * self.mean(once))

    def test_a_copy_vertex_for_vertex_is_solved_once(self):
        once, _ = self.baked(room())
        light, scene = self.baked(room(1, ("copy", gltf_file.box((-0.25, 0, -0.25), (0.25, 0.5, 0.25)))))
        self.assertEqual((scene["overlapping_triangles"], scene["coincident_meshes"]), (2, 1))
        self.assertEqual({name: light[name] for name in once}, once)

    def test_no_light_is_inside_crossed_boxes(self):
        """Two closed boxes with a corner in each other, and a grey box in what they share: it must be dark."""
        crossed = [("first", gltf_file.box((0.3, 0.3, 0.3), (0.7, 0.7, 0.7))),
                   ("second", gltf_file.box((0.5, 0.5, 0.5), (0.9, 0.9, 0.9))),
                   ("inside", gltf_file.box((0.56, 0.56, 0.56), (0.64, 0.64, 0.64)))]
        light, scene = self.baked(room(1, *crossed))
        self.assertEqual(scene["crossing_surfaces"], 6)  # the three of each box that meet in its corner
        most = max(rgb[0] for _, rgb in light["inside"])
        print(f"crossed boxes: {most / self.mean(light):.1e} of the room's radiance inside")
        self.assertEqual(most, 0)
        for name in ("first", "second"):
            self.assertGreater(self.mean(light, name), 0.3 * self.mean(light))

    def test_an_inverted_shell_is_a_room(self):
        """From outside, backs block and absorb: what is in it is dark. Its corners are the exception that is known: one that
        lies between the pixels of a draft hemi-cube lets a path through that passes half a centimetre beside it."""
        shell = [("shell", gltf_file.box((0.3, 0.3, 0.3), (0.7, 0.7, 0.7), inward=True)),
                 ("inside", gltf_file.box((0.46, 0.46, 0.46), (0.54, 0.54, 0.54)))]
        light, _ = self.baked(room(1, *shell))
        most = max(rgb[0] for name in ("shell", "inside") for _, rgb in light[name])
        print(f"inverted shell: {most / self.mean(light):.1e} of the room's radiance inside")
        self.assertLess(most, 0.01 * self.mean(light))
        self.assertLess(max(rgb[0] for _, rgb in light["inside"]), 0.001 * self.mean(light))

    def test_t_junctions_and_slivers_leak_nothing(self):
        """A closed box whose top is a fan of slivers along one side, against a side that is whole: nothing gets in."""
        low, high = (0.4, 0.2, 0.4), (0.7, 0.5, 0.7)
        positions, triangles = gltf_file.box(low, high)
        top = [t for t in triangles if all(positions[v][1] == high[1] for v in t)]
        rest = [t for t in triangles if t not in top]
        count, first = 40, len(positions)
        positions = positions + [[low[0] + (high[0] - low[0]) * i / count, high[1], low[2]] for i in range(count + 1)]
        apex = [v for v in range(8) if positions[v] == [low[0], high[1], high[2]]][0]
        far = [v for v in range(8) if positions[v] == [high[0], high[1], high[2]]][0]
        slivers = [(first + i, apex, first + i + 1) for i in range(count)] + [(first + count, apex, far)]
        light, scene = self.baked(room(1, ("box with a fan", (positions, rest + slivers)),
                                   ("inside", gltf_file.box((0.5, 0.3, 0.5), (0.6, 0.4, 0.6)))))
        self.assertEqual((scene["slivers"], scene["t_junctions"]), (count, 1))
        most = max(rgb[0] for _, rgb in light["inside"])
        print(f"slivers: {most / self.mean(light):.1e} of the room's radiance inside")
        self.assertEqual(most, 0)

    def test_a_needle_along_a_diagonal_changes_nothing(self):
        """Rounding leaves it an area, and both its long sides are edges of the triangles beside it: merging fell over it."""
        def grid(needle):
            positions = [[0.3, y, z] for z in (-0.3, 0, 0.3) for y in (0.1, 0.4, 0.7)]
            triangles = [t for row in (0, 3) for a in (row, row + 1) for t in ((a, a + 1, a + 4), (a, a + 4, a + 3))]
            made = gltf_file.room()
            made.add_mesh("sheet", (positions, triangles + ([(0, 4, 8)] if needle else [])), 0)
            self.write("scene.glb", made.glb())
            self.bake("scene.glb", "out.glb", "--quality", "draft", "--scene-linear", "--no-draco")
            asset = gltf_file.Asset(self.path("out.glb"))
            rows = [c for p in asset.primitives("room") for c in asset.values(p["attributes"]["_RADIOSITY"])]
            return sum(c[0] for c in rows) / len(rows)

        self.assertAlmostEqual(grid(True) / grid(False), 1, delta=0.02)


if __name__ == "__main__":
    command.main()
