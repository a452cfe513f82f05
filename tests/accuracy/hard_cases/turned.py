# SPDX-License-Identifier: MIT
"""What is a case scaled, rotated or shifted? The same numbers under one more node; and what that does to a point."""

import copy
import math

from shapes import gltf_file


def rotation(axis, angle):
    """A matrix of rows, angle in degrees about a unit axis."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    x, y, z = axis
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def times(rows, p):
    return [sum(m * x for m, x in zip(row, p)) for row in rows]


class Turn:
    """scale * rotation, then a shift in metres."""

    def __init__(self, name, scale=1.0, axis=(0, 1, 0), angle=0.0, shift=(0, 0, 0)):
        self.name, self.scale, self.shift, self.rows, self.angle = name, scale, shift, rotation(axis, angle), angle
        self.upright = angle == 0 or axis == (0, 1, 0)

    def point(self, p):
        return [self.scale * x + s for x, s in zip(times(self.rows, p), self.shift)]

    def normal(self, n):
        return times(self.rows, n)

    def matrix(self):
        """Column-major, as a node has it."""
        return [self.scale * self.rows[row][column] if row < 3 else 0.0 for column in range(3) for row in range(4)] + [*self.shift, 1.0]

    def options(self, options):
        """The sun turns with the scene: its azimuth runs from north by east, against a turn about y."""
        out = list(options)
        for i, word in enumerate(out[:-1]):
            if word == "--sun":
                azimuth, rest = out[i + 1].split(",", 1)
                out[i + 1] = f"{(float(azimuth) - self.angle) % 360:g},{rest}"
        return out


# A third of a turn that is no symmetry of a box; what has a sun turns about the vertical alone.
SLANTED = Turn("rotated", axis=(0.6, 0.8, 0.0), angle=37.0)
TURNS = (Turn("scaled", scale=8.0), SLANTED, Turn("shifted", shift=(5.3, -3.1, 7.7)))
UPRIGHT = Turn("rotated", angle=37.0)


def under(scene, matrix):
    """The GLB of a scene all of which hangs under one node of that matrix. Lights without size give as much as before where they
    are as many times further away: candela grow by the square of the scale."""
    tree = copy.deepcopy(scene.json)
    scale = math.hypot(*matrix[:3])
    for light in tree.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", []):
        if light["type"] != "directional":
            light["intensity"] = light.get("intensity", 1) * scale ** 2
    tree["nodes"].append({"name": "root", "matrix": list(matrix), "children": tree["scenes"][0]["nodes"]})
    tree["scenes"][0]["nodes"] = [len(tree["nodes"]) - 1]
    tree["buffers"] = [{"byteLength": len(scene.bin)}]
    return gltf_file.glb({key: value for key, value in tree.items() if value != []}, bytes(scene.bin))


def root_at_origin(data):
    """A baked GLB whose root node, named root, is back at the origin: floats of a place 10^6 m away hold no probes."""
    import json
    import struct
    length = struct.unpack_from("<I", data, 12)[0]
    tree, binary = json.loads(data[20:20 + length]), data[28 + length:]
    for node in tree["nodes"]:
        if node.get("name") == "root":
            node.pop("matrix", None)
            node.pop("translation", None)
    return gltf_file.glb(tree, binary)
