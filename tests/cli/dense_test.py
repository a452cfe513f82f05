# SPDX-License-Identifier: MIT
"""Is a mesh that is denser than its light solved on a simpler one, and handed back whole? (tests/bench/dense.py measures more.)"""

import json
import math
import unittest

import command
import gltf_file

CENTER, RADIUS = (0.2, 0.5, 0.1), 0.5


def scene(segments, *more):
    made = gltf_file.Scene()
    white, red = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("red", (0.7, 0.3, 0.2))
    light = made.add_material("lamp", (0, 0, 0), (10, 10, 10))
    made.add_mesh("room", gltf_file.box((-1.5, 0, -1.5), (1.5, 2.5, 1.5), inward=True), white)
    made.add_mesh("sphere", gltf_file.sphere(segments, CENTER, RADIUS, segments // 2), red)
    made.add_mesh("lamp", gltf_file.lamp(0.3, 2.4), light)
    return made.glb()


def by_place(asset, name, digits=4):
    """Radiance by position."""
    light = {}
    for primitive in asset.primitives(name):
        attributes = primitive["attributes"]
        for p, rgb in zip(asset.values(attributes["POSITION"]), asset.values(attributes["_RADIOSITY"])):
            light[tuple(round(x, digits) for x in p)] = rgb[0]
    return light


def smooth_normals(points, triangles):
    """Of vertices that share a place, as those along a sphere's seam, too."""
    key = [tuple(round(x, 6) for x in p) for p in points]
    sums = {k: [0.0, 0.0, 0.0] for k in key}
    for t in triangles:
        a, b, c = (points[i] for i in t)
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        for i in t:
            for k in range(3):
                sums[key[i]][k] += u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2]
    return [[x / math.hypot(*sums[k]) for x in sums[k]] for k in key]


def off(a, b):
    common = a.keys() & b.keys()
    return math.sqrt(sum((a[k] - b[k]) ** 2 for k in common) / sum(b[k] ** 2 for k in common)), len(common)


class Dense(command.CommandCase):
    def baked(self, name, glb, *options):
        self.write(name + ".glb", glb)
        # All triangles, so that bakes have vertices in common to be compared at.
        self.bake(name + ".glb", name + ".out.glb", "--quality", "draft", "--scene-linear", "--no-draco", "--merge-error", "0",
                  "--report", "out.json", *options)
        return gltf_file.Asset(self.path(name + ".out.glb")), json.loads(self.read("out.json"))

    def test_ten_times_the_triangles_are_as_much_light_for_as_much_work(self):
        """160 around has the vertices of 40 around among its own."""
        coarse, before = self.baked("coarse", scene(40), "--stand-in", "0")
        dense, after = self.baked("dense", scene(160))
        few, many = before["scene"], after["scene"]
        self.assertEqual((few["stand_in_meshes"], many["stand_in_meshes"]), (0, 1))
        self.assertEqual(many["stood_in_triangles"], 160 * 158)
        self.assertLess(many["stand_in_triangles"], 1600)
        self.assertLess(many["patches"], few["patches"])
        self.assertLess(abs(after["energy"]["residual_fraction"]), 1e-9)
        for name, limit in (("sphere", 0.06), ("room", 0.03)):
            difference, points = off(by_place(dense, name), by_place(coarse, name))
            print(f"{name}: {difference:.2%} apart at {points} points")
            # Draft is good to 3 % (tests/accuracy): a difference of two bakes to twice that on the few samples of a
            # sphere, and to once that in the room.
            self.assertLess(difference, limit)
            self.assertGreater(points, 100)

    def test_a_rough_stone_is_many_shooters_and_a_ball_few(self):
        """Of what columns would take twelve times as long for."""
        def method(rough):
            made = gltf_file.Scene()
            made.add_mesh("room", gltf_file.box((-1.5, 0, -1.5), (1.5, 2.5, 1.5), inward=True), made.add_material("white", (0.7,) * 3))
            points, triangles, normals = gltf_file.sphere(160, (0, 0, 0), 0.5, 80)
            if rough:
                heights = [1 + 0.1 * math.sin(16 * x) * math.sin(16 * y) * math.sin(16 * z + 1) for x, y, z in points]
                points = [[h * x for x in p] for p, h in zip(points, heights)]
                normals = smooth_normals(points, triangles)
            made.add_mesh("stone", ([[x, y + 0.8, z] for x, y, z in points], triangles, normals), made.add_material("stone", (0.7,) * 3))
            made.add_mesh("lamp", gltf_file.lamp(0.3, 2.4), made.add_material("lamp", (0, 0, 0), (10, 10, 10)))
            self.write("stone.glb", made.glb())
            return json.loads(self.succeed("inspect", "stone.glb", "--json", "--quality", "draft").stdout)["forecast"]["method"]
        self.assertEqual(method(rough=False), "hybrid")
        self.assertEqual(method(rough=True), "rows")

    def test_what_comes_back_is_the_dense_mesh(self):
        glb = scene(100)
        self.write("in.glb", glb)
        given = gltf_file.Asset(self.path("in.glb"))
        out, report = self.baked("dense", glb)
        self.assertEqual(report["scene"]["stand_in_meshes"], 1)
        self.assertGreater(report["scene"]["stand_in_deviation"], 0)
        triangles = []
        for asset in (given, out):
            primitive, = asset.primitives("sphere")
            places = asset.values(primitive["attributes"]["POSITION"])
            index = [row[0] for row in asset.values(primitive["indices"])]
            triangles.append([tuple(places[i] for i in index[k:k + 3]) for k in range(0, len(index), 3)])
        self.assertEqual(triangles[0], triangles[1])

    def test_a_large_face_among_small_triangles_has_light_between_its_corners(self):
        """A table top of two triangles, and a ball of thousands in the same mesh: the top is bright in its middle, under the lamp."""
        made = gltf_file.Scene()
        white, light = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("lamp", (0, 0, 0), (10, 10, 10))
        ball = gltf_file.sphere(100, (1.2, 0.2, 1.2), 0.1, 50)
        places, triangles = list(ball[0]), list(ball[1])
        first = len(places)
        places += [(-1.2, 0.5, -0.4), (-1.2, 0.5, 0.4), (1.2, 0.5, 0.4), (1.2, 0.5, -0.4)]
        triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
        made.add_mesh("room", gltf_file.box((-1.5, 0, -1.5), (1.5, 2.5, 1.5), inward=True), white)
        made.add_mesh("table", (places, triangles), white)
        made.add_mesh("lamp", gltf_file.lamp(0.1, 2.4), light)
        out, report = self.baked("table", made.glb())
        self.assertEqual(report["scene"]["stand_in_meshes"], 1)
        top = {place: rgb for place, rgb in by_place(out, "table").items() if place[1] == 0.5}
        corners = [rgb for place, rgb in top.items() if abs(place[0]) == 1.2]
        middle = [rgb for place, rgb in top.items() if abs(place[0]) < 0.2]
        print(f"table: {len(top)} places, {max(middle, default=0):.3f} in the middle, {max(corners):.3f} at its ends")
        # Light falls with the fourth power of the cosine: 0.51 at 1.2 m beside a lamp 1.9 m above, and the walls give some.
        self.assertGreater(max(middle, default=0), 1.3 * max(corners))

    def test_the_same_bytes_for_any_number_of_threads(self):
        self.write("in.glb", scene(100))
        for threads in ("1", "3"):
            self.bake("in.glb", f"out{threads}.glb", "--quality", "draft", "--threads", threads)
        self.assertEqual(self.read("out1.glb"), self.read("out3.glb"))

    def test_both_sides_of_a_dense_sheet_have_their_own_light(self):
        """A level sheet of 20,000 triangles between lamp and floor: bright above, dark below."""
        n, made = 100, gltf_file.Scene()
        white, light = made.add_material("white", (0.7, 0.7, 0.7)), made.add_material("lamp", (0, 0, 0), (10, 10, 10))
        sheet = made.add_material("sheet", (0.7, 0.7, 0.7))
        made.json["materials"][sheet]["doubleSided"] = True
        places = [[-0.5 + i / n, 1 + 0.05 * math.sin(6 * i / n) * math.sin(6 * j / n), -0.5 + j / n] for i in range(n + 1) for j in range(n + 1)]
        at = lambda i, j: i * (n + 1) + j
        triangles = [t for i in range(n) for j in range(n) for t in ((at(i, j), at(i, j + 1), at(i + 1, j)), (at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)))]
        made.add_mesh("room", gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True), white)
        made.add_mesh("sheet", (places, triangles), sheet)
        made.add_mesh("lamp", gltf_file.lamp(0.3, 1.9), light)
        out, report = self.baked("sheet", made.glb())
        self.assertEqual(report["scene"]["stand_in_meshes"], 1)
        primitive, = out.primitives("sheet")
        rows = [rgb[0] for rgb in out.values(primitive["attributes"]["_RADIOSITY"])]
        self.assertEqual(len(rows), 2 * (n + 1) ** 2)
        half = len(rows) // 2
        above, below = sum(rows[:half]) / half, sum(rows[half:]) / half
        print(f"sheet: {above:.3f} above, {below:.3f} below")
        # What is below sees no lamp: less than half.
        self.assertLess(below, 0.5 * above)
        self.assertLess(max(rows[half:]), 0.7 * above)


if __name__ == "__main__":
    command.main()
