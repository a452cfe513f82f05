# SPDX-License-Identifier: MIT
"""What is a small asset? A room, a box on its floor and a lamp under its ceiling: 24 triangles, three materials.

    python3 tests/bench/small_room.py OUT.glb
"""

import sys

import numpy

from radiance_glb import write_scene

MATERIALS = [
    {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.7, 0.7, 1], "metallicFactor": 0}},
    {"pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.2, 0.1, 1], "metallicFactor": 0}},
    {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": [1, 0.95, 0.85],
     "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 12}}},
]


def quad(origin, right, up):
    """Counter-clockwise from its front, to which right x up points."""
    o, r, u = (numpy.array(v, dtype=float) for v in (origin, right, up))
    return [o, o + r, o + r + u, o + u]


def box(low, size, inward):
    """Six faces; inward: their fronts look inside."""
    (x, y, z), (a, b, c) = low, size
    faces = [quad((x, y, z), (a, 0, 0), (0, 0, c)), quad((x, y + b, z), (0, 0, c), (a, 0, 0)), quad((x, y, z), (0, 0, c), (0, b, 0)),
             quad((x + a, y, z), (0, b, 0), (0, 0, c)), quad((x, y, z), (0, b, 0), (a, 0, 0)), quad((x, y, z + c), (a, 0, 0), (0, b, 0))]
    return [face[::-1] if inward else face for face in faces]


def joined(quads, material):
    """A part of write_scene."""
    corners = numpy.concatenate(quads)
    first = 4 * numpy.arange(len(quads))[:, None, None]
    return corners, (first + numpy.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3), material


def small_room(path, roof=True):
    """Without a roof there is no lamp either."""
    room = box((0, 0, 0), (4, 3, 3), True)
    crate = [face for face in box((1, 0, 1), (1, 1.2, 0.8), False) if any(corner[1] > 0 for corner in face)]
    lamp = quad((1.5, 2.95, 1), (1, 0, 0), (0, 0, 1))
    if not roof:
        room = [face for face in room if any(corner[1] < 3 for corner in face)]
    parts = [joined(room, 0), joined(crate, 1)]
    write_scene(path, parts + [joined([lamp], 2)] if roof else parts, MATERIALS)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    small_room(sys.argv[1])
