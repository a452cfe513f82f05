# SPDX-License-Identifier: MIT
"""Is samples/pavilion what its README says: built by its script, of the paper's size, lit by every lamp, and light-tight?

The test bakes with the sizes of the README at draft quality. Heights are y, the depth of the plan is -z.
"""

import copy
import itertools
import json
import math
import os
import subprocess
import sys

import command
import gltf_file

PAVILION = os.path.join(command.SAMPLES, "pavilion")
SIZES = ("--patch-size", "2.25", "--element-size", "0.7")
# Of the power, to save time. What is left is bounced light: test_every_lamp_shoots.
UNSHOT = 0.03

# The utility room of building.py: what is inside its walls, and how thick they are.
ROOM_X, ROOM_DEPTH, WALL = (1.4, 8.1), (12.3, 18.0), 0.3
# Names of the materials that light nothing but the utility room, and of the room's walls.
ROOM_LAMPS, ROOM_WALLS = ("bulb", "tube"), "west-walls"


def scene():
    return gltf_file.Asset(os.path.join(PAVILION, "pavilion.glb"))


def parts():
    """(name, faces) of every solid, as its script says it."""
    sys.path.insert(0, PAVILION)
    import building
    import furniture
    import lamps
    return [part for stage in (building, furniture, lamps) for part in stage.parts().items()]


def blacken(asset):
    for material in asset.json["materials"]:
        material["pbrMetallicRoughness"]["baseColorFactor"] = [0, 0, 0, 1]


def emission(material):
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
    return [strength * factor for factor in material.get("emissiveFactor", [0, 0, 0])]


def triangles(asset, primitive):
    points = asset.values(primitive["attributes"]["POSITION"])
    corners = [points[i] for (i,) in asset.values(primitive["indices"])]
    return list(zip(corners[0::3], corners[1::3], corners[2::3]))


def areas(asset):
    """(material, area) of every triangle."""
    for mesh in asset.json["meshes"]:
        for primitive in mesh["primitives"]:
            for a, b, c in triangles(asset, primitive):
                u, v = ([q[k] - a[k] for k in range(3)] for q in (b, c))
                cross = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
                yield asset.json["materials"][primitive["material"]], math.hypot(*cross) / 2


class Built(command.CommandCase):
    def test_the_script_writes_the_bytes_that_are_kept(self):
        with open(os.path.join(PAVILION, "pavilion.glb"), "rb") as f:
            kept = f.read()
        for name in ("once.glb", "again.glb"):
            subprocess.run([sys.executable, "-B", os.path.join(PAVILION, "build.py"), "-o", self.path(name)], check=True)
            self.assertTrue(self.read(name) == kept, "build.py writes another file than samples/pavilion/pavilion.glb")

    def test_every_solid_is_closed(self):
        """Each edge is gone along as often one way as the other; but for the podium's foot, which stands in the earth."""
        asset = scene()
        for node in asset.json["nodes"]:
            if "mesh" not in node:
                continue
            edges = self.edges([t for p in asset.primitives(node["name"]) for t in triangles(asset, p)])
            ground = min(p[1] for p, _ in edges)
            self.assertEqual([(p, q) for p, q in edges if edges[p, q] != edges.get((q, p), 0) and
                              not (node["name"] == "podium" and p[1] == q[1] == ground)], [], node["name"])

    def test_no_face_lies_in_another(self):
        """Rectangles of one plane, if they are square to the axes, may touch along edges and no more."""
        planes = {}
        for name, faces in parts():
            for corners, _ in faces:
                low, high = ([pick(p[k] for p in corners) for k in range(3)] for pick in (min, max))
                for k in range(3):
                    is_rectangle = len(corners) == 4 and all(p[o] in (low[o], high[o]) for p in corners for o in range(3))
                    if is_rectangle and low[k] == high[k]:
                        others = [axis for axis in range(3) if axis != k]
                        planes.setdefault((k, round(low[k], 6)), []).append((name, [(low[o], high[o]) for o in others]))
        for plane, faces in planes.items():
            for (a, r), (b, s) in itertools.combinations(faces, 2):
                overlap = min(min(r[k][1], s[k][1]) - max(r[k][0], s[k][0]) for k in range(2))
                # A micrometre is what the file's positions are rounded to.
                self.assertLess(overlap, 1e-6, f"{a} and {b} in the plane {'xyh'[plane[0]]} = {plane[1]}: {r} {s}")

    @staticmethod
    def edges(triangles):
        """How often each edge is gone along. Steps of different heights share an upright edge in pieces: it is cut there."""
        heights = {}
        for triangle in triangles:
            for x, y, z in triangle:
                heights.setdefault((x, z), set()).add(y)
        counts = {}
        for a, b, c in triangles:
            for p, q in ((a, b), (b, c), (c, a)):
                stops = [p, q]
                if (p[0], p[2]) == (q[0], q[2]):
                    between = sorted(y for y in heights[p[0], p[2]] if min(p[1], q[1]) <= y <= max(p[1], q[1]))
                    stops = [(p[0], y, p[2]) for y in (between if p[1] < q[1] else between[::-1])]
                for step in zip(stops, stops[1:]):
                    counts[step] = counts.get(step, 0) + 1
        return counts


class Baked(command.CommandCase):
    def bake_linear(self, asset, *arguments):
        self.write("pavilion.glb", gltf_file.glb(asset.json, asset.bin))
        self.bake("pavilion.glb", "out.glb", "--quality", "draft", *SIZES, "--scene-linear", "--no-draco", "--report",
                  "out.json", *arguments)
        return gltf_file.Asset(self.path("out.glb")), json.loads(self.read("out.json"))

    @staticmethod
    def radiances(asset, name):
        """(position, rgb) of each vertex of a node."""
        return [pair for primitive in asset.primitives(name)
                for pair in zip(asset.values(primitive["attributes"]["POSITION"]),
                                asset.values(primitive["attributes"]["_RADIOSITY"]))]

    def test_it_has_the_papers_size_and_its_books_close(self):
        """2,676 patches and 10,041 elements in the paper; light escapes to the sky; the wall of onyx is golden."""
        baked, report = self.bake_linear(scene(), "--unshot", str(UNSHOT))
        # Those of the paper, and what is cut along the lines in which solids touch, which the paper knows nothing of: a
        # third as many patches again, which cut more elements (3,606 and 17,334).
        self.assertGreater(report["scene"]["patches"], 2550)
        self.assertLess(report["scene"]["patches"], 1.5 * 2676)
        self.assertGreater(report["scene"]["elements"], 9500)
        self.assertLess(report["scene"]["elements"], 2 * 10041)
        self.assertLess(abs(report["energy"]["residual_fraction"]), 1e-6)
        self.assertTrue(report["solver"]["converged"])
        self.assertLessEqual(report["solver"]["unshot_fraction"], UNSHOT)
        self.assertGreater(report["energy"]["escaped"], 0.05 * report["energy"]["emitted"])
        onyx = [rgb for p, rgb in self.radiances(baked, "onyx-wall") if 0.5 < p[1] < 2.5]
        self.assertGreater(len(onyx), 10)
        self.assertTrue(all(r > g > b > 0 for r, g, b in onyx), onyx)

    def test_every_lamp_shoots(self):
        """Where nothing reflects, each lamp shoots once and nothing is left; the power is pi L A of the lamps' faces."""
        asset = scene()
        blacken(asset)
        _, report = self.bake_linear(asset, "--unshot", "1e-9")
        power = sum(math.pi * sum(emission(m)) * area for m, area in areas(asset))
        self.assertEqual(report["solver"]["shots"], report["scene"]["lights"])
        self.assertLess(report["energy"]["unshot"], 1e-9 * report["energy"]["emitted"])  # roundings of sums
        # Radiances and positions are floats; the report's watts are summed over rgb.
        self.assertLess(abs(report["energy"]["emitted"] / power - 1), 1e-5)

    def test_no_light_goes_through_the_walls_of_the_utility_room(self):
        """Only the room's lamps burn, and only its walls reflect. They are two boxes nested: the outer face of the back
        wall sees no lamp and none of the other walls' faces, so it has exactly no light unless a wall lets light through.
        The faces inside see lamps and one another."""
        asset = scene()
        walls = next(n for n in asset.json["nodes"] if n.get("name") == ROOM_WALLS)
        primitive, = asset.json["meshes"][walls["mesh"]]["primitives"]
        plaster = copy.deepcopy(asset.json["materials"][primitive["material"]])
        blacken(asset)
        for material in asset.json["materials"]:
            if material["name"] not in ROOM_LAMPS:
                material["emissiveFactor"] = [0, 0, 0]
        asset.json["materials"].append(dict(plaster, name="room walls"))
        primitive["material"] = len(asset.json["materials"]) - 1
        baked, report = self.bake_linear(asset)
        self.assertGreater(report["energy"]["emitted"], 0)
        inside, outside = [], []
        for (x, y, z), rgb in self.radiances(baked, ROOM_WALLS):
            if not (ROOM_X[0] < x < ROOM_X[1] and 0.2 < y < 2.9):
                continue
            if abs(-z - ROOM_DEPTH[1]) < 1e-4:
                inside.append(rgb)
            elif abs(-z - ROOM_DEPTH[1] - WALL) < 1e-4:
                outside.append(rgb)
        self.assertGreater(len(inside), 10)
        self.assertGreater(len(outside), 10)
        brightest = max(max(rgb) for rgb in inside)
        lit = [rgb for rgb in inside if min(rgb) > 0.01 * brightest]
        self.assertGreater(len(lit), 0.8 * len(inside))  # the rest is behind what lies in the shelf
        # Floats of the file: what is summed to nothing is nothing; a millionth is their precision against the inside.
        self.assertLess(max(max(rgb) for rgb in outside), 1e-6 * brightest)


if __name__ == "__main__":
    command.main()
