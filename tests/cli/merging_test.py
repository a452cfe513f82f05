# SPDX-License-Identifier: MIT
"""Are triangles merged where the picture does not need them, and nothing else changed? (tests/core/decimate_test.c has the method.)"""

import json
import math
import unittest

import command
import gltf_file

ALL = ("--merge-error", "0")


def furnace():
    """A closed room whose walls all glow alike: light is the same everywhere."""
    made = gltf_file.Scene()
    made.add_mesh("room", gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True), made.add_material("glow", (0.5, 0.5, 0.5), (1, 1, 1)))
    return made


def grid(corner, u, v, cells):
    """A parallelogram of cells x cells squares with common vertices, and how far each vertex is along u and v."""
    places = [(i / cells, j / cells) for j in range(cells + 1) for i in range(cells + 1)]
    positions = [[corner[k] + s * u[k] + t * v[k] for k in range(3)] for s, t in places]
    quads = [(j * (cells + 1) + i, j * (cells + 1) + i + 1, (j + 1) * (cells + 1) + i + 1, (j + 1) * (cells + 1) + i)
             for j in range(cells) for i in range(cells)]
    return positions, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], places


def triangles(asset):
    """Corners of all triangles as rows of positions."""
    for mesh in asset.json["meshes"]:
        for primitive in mesh["primitives"]:
            positions = asset.values(primitive["attributes"]["POSITION"])
            indices = [i for (i,) in asset.values(primitive["indices"])]
            for t in range(0, len(indices), 3):
                yield [positions[i] for i in indices[t:t + 3]]


def area(corners):
    a, b, c = corners
    u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
    return 0.5 * math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def lone_length(asset):
    """Length of edges that a single triangle has. Where a border had a vertex on one side only, both sides' edges were lone."""
    edges = {}
    for corners in triangles(asset):
        for k in range(3):
            edge = tuple(sorted((tuple(corners[k]), tuple(corners[(k + 1) % 3]))))
            edges[edge] = edges.get(edge, 0) + 1
    return sum(math.dist(*edge) for edge, count in edges.items() if count == 1)


class Merging(command.CommandCase):
    def baked(self, scene, *options):
        self.write("scene.glb", scene.glb())
        self.bake("scene.glb", "out.glb", "--scene-linear", "--no-draco", "--report", "out.json", *options)
        return gltf_file.Asset(self.path("out.glb")), json.loads(self.read("out.json"))

    def test_evenly_lit_walls_end_with_two_triangles_each(self):
        for quality in ("draft", "medium"):
            asset, report = self.baked(furnace(), "--quality", quality)
            print(f"{quality}: {report['scene']['triangles_cut']} triangles of even walls become {report['scene']['triangles_out']}")
            self.assertEqual(report["scene"]["triangles_out"], 12)
            self.assertEqual(report["scene"]["vertices_out"], 24)
            # Floats of a box of 24 square metres.
            self.assertAlmostEqual(sum(map(area, triangles(asset))), 24.0, delta=1e-5)

    def test_so_do_walls_that_came_as_grids(self):
        """The input's own vertices go where geometry does not need them. By columns, whose light has no noise: that of rows is kept."""
        scene = furnace()
        scene.json.update(meshes=[], nodes=[], scenes=[{"nodes": []}])
        x, y, z = (2, 0, 0), (0, 2, 0), (0, 0, 2)
        for corner, u, v in (((-1, 0, -1), z, x), ((-1, 2, -1), x, z), ((-1, 0, -1), x, y), ((-1, 0, 1), y, x),
                             ((-1, 0, -1), y, z), ((1, 0, -1), z, y)):
            scene.add_mesh("wall", grid(corner, u, v, 5)[:2], 0)
        asset, report = self.baked(scene, "--quality", "draft", "--method", "hybrid")
        self.assertEqual((report["scene"]["surfaces"], report["scene"]["triangles_out"]), (6 * 25, 12))
        self.assertAlmostEqual(sum(map(area, triangles(asset))), 24.0, delta=1e-5)

    def test_a_lit_room_has_fewer_triangles_and_the_same_shape(self):
        all_of_them, before = self.baked(gltf_file.room(), *ALL)
        merged, after = self.baked(gltf_file.room())
        print(f"{before['scene']['triangles_out']} triangles become {after['scene']['triangles_out']}, off by "
              f"{after['error']['merge']:.3%} rms and {after['error']['merge_largest']:.3%} at most")
        self.assertEqual((before["scene"]["triangles_merged"], before["error"]["merge_largest"]), (0, 0))
        self.assertEqual(after["scene"]["triangles_cut"], before["scene"]["triangles_out"])
        self.assertEqual(after["scene"]["triangles_out"], after["scene"]["triangles_cut"] - after["scene"]["triangles_merged"])
        self.assertLess(after["scene"]["triangles_out"], 0.75 * before["scene"]["triangles_out"])
        # The tolerance of medium (plugin/api/quality.c).
        self.assertLessEqual(after["error"]["merge_largest"], 0.0045)
        self.assertLess(after["error"]["merge"], after["error"]["merge_largest"])
        # Some thousand sums of float positions.
        self.assertAlmostEqual(sum(map(area, triangles(merged))), sum(map(area, triangles(all_of_them))), delta=1e-4)
        # No triangle is narrower than a tenth of its longest edge, as merge_open.c has it; floats round.
        narrowest = min(2 * area(c) / max(math.dist(c[k], c[(k + 1) % 3]) for k in range(3)) ** 2 for c in triangles(merged))
        self.assertGreater(narrowest, 0.0999)

    def test_no_border_gets_a_vertex_on_one_side_only(self):
        all_of_them, _ = self.baked(gltf_file.room(), *ALL)
        merged, _ = self.baked(gltf_file.room())
        self.assertAlmostEqual(lone_length(merged), lone_length(all_of_them), delta=1e-5)

    def test_vertices_that_stay_keep_their_colours(self):
        """What lies between them is measured by tests/core/decimate_test.c."""
        colors = []
        for options in (ALL, ()):
            asset, _ = self.baked(gltf_file.room(), *options)
            colors.append({(mesh["name"], place, color) for mesh in asset.json["meshes"] for primitive in mesh["primitives"]
                           for place, color in zip(*(asset.values(primitive["attributes"][a]) for a in ("POSITION", "_RADIOSITY")))})
        self.assertLess(colors[1], colors[0])

    def rug(self, coordinates):
        """A grid over the floor, and what its texture coordinates are in the result by place."""
        scene = gltf_file.room()
        positions, cells, places = grid((-0.9, 0.01, -0.9), (0, 0, 1.8), (1.8, 0, 0), 4)
        scene.add_mesh("rug", (positions, cells), 0)
        attributes = scene.json["meshes"][-1]["primitives"][0]["attributes"]
        attributes["TEXCOORD_0"] = scene._add_accessor([coordinates(*place) for place in places], "VEC2", gltf_file.FLOAT)
        # Colours ask for nothing.
        asset, _ = self.baked(scene, "--merge-error", "1")
        found = {}
        for primitive in asset.primitives("rug"):
            attributes = primitive["attributes"]
            for p, uv in zip(asset.values(attributes["POSITION"]), asset.values(attributes["TEXCOORD_0"])):
                found[((p[2] + 0.9) / 1.8, (p[0] + 0.9) / 1.8)] = uv
        return found

    def test_texture_coordinates_stay_where_they_were(self):
        even = self.rug(lambda s, t: (3 * s + t, 1 - t))
        self.assertLess(len(even), 25)
        for (s, t), (u, v) in even.items():
            # Positions and coordinates are interpolated in floats.
            self.assertLess(math.hypot(u - 3 * s - t, v - 1 + t), 1e-6)
        # What bends the picture stays: all 25 vertices of the grid.
        bent = self.rug(lambda s, t: (s * s, t * t))
        self.assertGreaterEqual(len(bent), 25)
        self.assertTrue(all((i / 4, j / 4) in {(round(s, 5), round(t, 5)) for s, t in bent} for i in range(5) for j in range(5)))

    def test_every_triangle_stays_where_it_was_asked_for(self):
        for options in (("--uniform",), ("--flat",), ("--element-size", "0.2"), ("--method", "pr"), ("--flat", "--merge-error", "0.01")):
            _, report = self.baked(gltf_file.room(), "--quality", "draft", *options)
            self.assertEqual(report["scene"]["triangles_merged"], 0, options)
        _, report = self.baked(gltf_file.room(), "--quality", "draft", "--uniform", "--merge-error", "0.01")
        self.assertGreater(report["scene"]["triangles_merged"], 0)

    def test_the_mesh_that_something_stands_in_for_is_whole(self):
        scene = gltf_file.room()
        scene.add_mesh("ball", gltf_file.sphere(120, (0.6, 0.5, 0.5), 0.3, 60), 0)
        asset, report = self.baked(scene, "--quality", "draft")
        self.assertEqual(report["scene"]["stand_in_meshes"], 1)
        self.assertEqual(sum(asset.json["accessors"][p["indices"]]["count"] for p in asset.primitives("ball")), 3 * 120 * 118)

    def test_what_is_no_share_is_refused(self):
        self.write("scene.glb", gltf_file.room().glb())
        for text in ("-1", "1.5", "nan", "much"):
            self.succeed("bake", "scene.glb", "-o", "out.glb", "--merge-error", text, status=command.USAGE)


if __name__ == "__main__":
    command.main()
