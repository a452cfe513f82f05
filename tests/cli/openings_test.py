# SPDX-License-Identifier: MIT
"""Does all of a room see a window that hardly any ray finds? A black room of 6 x 4 m under a sky of radiance 1, whose grey floor has the
form factor of the window, in closed form. (tests/field has windows of 1.2 and 0.2 m.)"""

import math
import os
import sys
import unittest

import command
import gltf_file

sys.path.insert(0, os.path.join(command.ROOT, "tests", "field"))
from geometry_cases import window_factor  # noqa: E402

SIDE, HEIGHT, DEPTH, RHO, MIDDLE = 3.0, 2.7, 4.0, 0.5, 1.6


def quad(origin, u, v):
    ends = [origin, [a + b for a, b in zip(origin, u)], [a + b + c for a, b, c in zip(origin, u, v)], [a + b for a, b in zip(origin, v)]]
    return [tuple(p) for p in ends], [(0, 1, 2), (0, 2, 3)]


def joined(*parts):
    points, triangles = [], []
    for p, t in parts:
        triangles += [tuple(i + len(points) for i in three) for three in t]
        points += p
    return points, triangles


def window(width):
    return MIDDLE - width / 2, MIDDLE + width / 2


def room(width):
    low, high = window(width)
    half = width / 2
    shell = joined(quad((-SIDE, HEIGHT, 0), (2 * SIDE, 0, 0), (0, 0, DEPTH)), quad((SIDE, 0, 0), (0, 0, DEPTH), (0, HEIGHT, 0)),
                   quad((-SIDE, 0, DEPTH), (0, 0, -DEPTH), (0, HEIGHT, 0)), quad((SIDE, 0, DEPTH), (-2 * SIDE, 0, 0), (0, HEIGHT, 0)),
                   quad((-SIDE, 0, 0), (SIDE - half, 0, 0), (0, HEIGHT, 0)), quad((half, 0, 0), (SIDE - half, 0, 0), (0, HEIGHT, 0)),
                   quad((-half, 0, 0), (width, 0, 0), (0, low, 0)), quad((-half, high, 0), (width, 0, 0), (0, HEIGHT - high, 0)))
    made = gltf_file.Scene()
    made.add_mesh("floor", quad((-SIDE, 0, DEPTH), (2 * SIDE, 0, 0), (0, 0, -DEPTH)), made.add_material("grey", (RHO,) * 3))
    made.add_mesh("shell", shell, made.add_material("black", (0, 0, 0)))
    return made.glb()


class Openings(command.CommandCase):
    def off(self, width, seed, quality):
        """Rms over the rms of what should be, of the floor's vertices away from its edges."""
        name = f"window-{width}-{seed}-{quality}"
        self.write(name + ".glb", room(width))
        self.bake(name + ".glb", name + ".out.glb", "--quality", quality, "--scene-linear", "--no-draco", "--merge-error", "0",
                  "--environment", "1,1,1", "--seed", str(seed))
        asset = gltf_file.Asset(self.path(name + ".out.glb"))
        errors = squares = 0.0
        count = 0
        for primitive in asset.primitives("floor"):
            attributes = primitive["attributes"]
            for (x, _, z), rgb in zip(asset.values(attributes["POSITION"]), asset.values(attributes["_RADIOSITY"])):
                if abs(x) > 2.4 or not 0.15 < z < 3.85:
                    continue
                expected = RHO * window_factor(x, z, width, *window(width))
                errors += (rgb[0] - expected) ** 2
                squares += expected ** 2
                count += 1
        self.assertGreater(count, 600)
        return math.sqrt(errors / squares)

    def test_a_window_that_corners_of_the_room_do_not_find_lights_them(self):
        draft = ((0.2, 1), (0.14, 1), (0.14, 2), (0.1, 3), (0.07, 2))
        # Elements are so small at medium that groups of them that see the window lie far from those that do not.
        for width, seed, quality in (*((*one, "draft") for one in draft), (0.04, 1, "medium")):
            off = self.off(width, seed, quality)
            print(f"a window of {100 * width:.0f} cm, seed {seed}, {quality}: off by {100 * off:.1f} %", flush=True)
            self.assertLess(off, 0.05)


if __name__ == "__main__":
    unittest.main()
