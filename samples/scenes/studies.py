# SPDX-License-Identifier: MIT
"""Four small scenes that each ask one thing of a bake.

    python3 samples/scenes/studies.py cornell|smooth|cage|hard FILE.glb

cornell: the box that Cornell's graphics lab photographed, from its published measures; does it look as everybody knows it? smooth: a sphere with normals on a pillar under a lamp; does it look round? cage: a coarse cage under the sky, baked with --subdivide 3;
is its limit surface lit? hard: a wall on a larger floor, a rug 0.1 mm above it, two skins in one plane, a grille, a pane of glass; does
light stop where things meet?
"""

import sys

from gltf import Glb
from shapes import box, join, quad, sphere


def walls(g, materials, size=3.0):
    """Floor, ceiling, back, left and right of a room that is open to the front."""
    s = size
    faces = {"floor": ((0, 0, s), (s, 0, s), (s, 0, 0), (0, 0, 0)), "ceiling": ((0, s, 0), (s, s, 0), (s, s, s), (0, s, s)),
             "back": ((0, 0, 0), (s, 0, 0), (s, s, 0), (0, s, 0)), "left": ((0, 0, s), (0, 0, 0), (0, s, 0), (0, s, s)),
             "right": ((s, 0, 0), (s, 0, s), (s, s, s), (s, s, 0))}
    for name, corners in faces.items():
        g.mesh(name, quad(*corners), materials.get(name, materials["back"]))


# Corners of the two blocks on the floor, counter-clockwise from above, and their heights; millimetres from the lab's data sheet.
BLOCKS = {"short block": (((130, 65), (82, 225), (240, 272), (290, 114)), 165), "tall block": (((423, 247), (265, 296), (314, 456), (472, 406)), 330)}


def cornell(g):
    """556 mm wide, 548.8 mm high, 559.2 mm deep, which are taken as centimetres; reflectances are those of its spectra in rgb."""
    white = g.material("white", (0.725, 0.71, 0.68))
    red, green = g.material("red", (0.63, 0.065, 0.05)), g.material("green", (0.14, 0.45, 0.091))
    lamp = g.material("lamp", (0.78, 0.78, 0.78), emission=(17, 12, 4))

    def at(x, y, z):
        return (556 - x) / 100, y / 100, (559.2 - z) / 100  # the sheet's x points left, its z away from the camera

    def face(*corners):
        return quad(*(at(*corner) for corner in corners))

    w, h, d = 552.8, 548.8, 559.2
    g.mesh("floor", face((w, 0, 0), (0, 0, 0), (0, 0, d), (w, 0, d)), white)
    g.mesh("ceiling", face((0, h, 0), (w, h, 0), (w, h, d), (0, h, d)), white)
    g.mesh("back", face((w, 0, d), (0, 0, d), (0, h, d), (w, h, d)), white)
    g.mesh("right wall", face((0, 0, d), (0, 0, 0), (0, h, 0), (0, h, d)), green)
    g.mesh("left wall", face((w, 0, 0), (w, 0, d), (w, h, d), (w, h, 0)), red)
    g.mesh("lamp", face((213, h - 0.5, 227), (343, h - 0.5, 227), (343, h - 0.5, 332), (213, h - 0.5, 332)), lamp)
    for name, (foot, height) in BLOCKS.items():
        sides = [face((x, 0, z), (x, height, z), (u, height, v), (u, 0, v)) for (u, v), (x, z) in zip(foot, foot[1:] + foot[:1])]
        g.mesh(name, join(*sides, face(*((x, height, z) for x, z in foot))), white)
    g.camera("front", at(278, 273, -800), at(278, 273, 0), 39.3)


def smooth(g):
    white, red = g.material("white", (0.75, 0.75, 0.75)), g.material("red", (0.63, 0.09, 0.07))
    blue = g.material("blue", (0.09, 0.12, 0.58))
    lamp = g.material("lamp", (0, 0, 0), emission=(16, 15, 13))
    walls(g, {"back": white, "left": red, "right": blue})
    g.mesh("lamp", quad((1.1, 2.95, 1.1), (1.9, 2.95, 1.1), (1.9, 2.95, 1.9), (1.1, 2.95, 1.9)), lamp)
    g.mesh("pillar", box((1.1, 0.001, 1.1), (1.9, 1.0, 1.9)), white)
    g.mesh("sphere", sphere(0.45, 48, 24), white, (1.5, 1.451, 1.5))
    g.camera("front", (1.5, 1.5, 6.6), (1.5, 1.45, 1.5), 36.0)


def cage(g):
    """A cross of seven cubes, welded, on a base that is a cage too: --subdivide takes all meshes of a file."""
    stone, ground = g.material("stone", (0.62, 0.54, 0.42)), g.material("grass", (0.12, 0.17, 0.06))
    cells = {(0, 0, 0), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)}
    points, triangles = {}, []
    for cell in sorted(cells):
        for axis in range(3):
            for side in (-1, 1):
                if tuple(c + (side if k == axis else 0) for k, c in enumerate(cell)) in cells:
                    continue
                b, c = (axis + 1) % 3, (axis + 2) % 3
                ring = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
                corners = []
                for p, q in ring if side > 0 else ring[::-1]:
                    at = [0.0, 0.0, 0.0]
                    at[axis], at[b], at[c] = 2 * cell[axis] + side, 2 * cell[b] + p, 2 * cell[c] + q
                    corners.append(points.setdefault(tuple(round(0.2 * x, 6) for x in at), len(points)))
                triangles += [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
    g.mesh("cross", (list(points), None, None, triangles), stone, (0, 0.62, 0), 30.0)
    g.mesh("ground", quad((-5, 0, 5), (5, 0, 5), (5, 0, -5), (-5, 0, -5)), ground)
    g.camera("front", (2.1, 2.9, 2.5), (0, 0.42, 0), 27.0)


def hard(g):
    white, clay = g.material("white", (0.75, 0.75, 0.75)), g.material("clay", (0.5, 0.25, 0.15))
    cloth = g.material("cloth", (0.2, 0.3, 0.45))
    glass = g.material("glass", (0.6, 0.85, 0.7), extensions={"KHR_materials_transmission": {"transmissionFactor": 0.9}})
    g._use("KHR_materials_transmission")
    lamp = g.material("lamp", (0, 0, 0), emission=(20, 18, 15))
    walls(g, {"back": white})
    g.mesh("lamp", quad((0.4, 2.9, 0.4), (0.9, 2.9, 0.4), (0.9, 2.9, 0.9), (0.4, 2.9, 0.9)), lamp)
    g.mesh("lamp", quad((2.2, 2.9, 1.8), (2.6, 2.9, 1.8), (2.6, 2.9, 2.2), (2.2, 2.9, 2.2)), lamp)
    g.mesh("partition", box((1.45, 0, 0.3), (1.55, 2.2, 2.2)), clay)
    g.mesh("rug", quad((0.2, 0.0001, 2.7), (1.3, 0.0001, 2.7), (1.3, 0.0001, 1.7), (0.2, 0.0001, 1.7)), cloth)
    g.mesh("skins", join(quad((0.2, 0.8, 1.2), (0.9, 0.8, 1.2), (0.9, 1.5, 1.2), (0.2, 1.5, 1.2)),
                         quad((0.9, 0.8, 1.2), (0.2, 0.8, 1.2), (0.2, 1.5, 1.2), (0.9, 1.5, 1.2))), cloth)
    g.mesh("grille", join(*(box((1.7 + 0.12 * i, 0, 1.6), (1.73 + 0.12 * i, 1.4, 1.63)) for i in range(10))), clay)
    g.mesh("pane", quad((0.3, 1.9, 1.0), (1.0, 1.9, 1.0), (1.0, 1.9, 0.3), (0.3, 1.9, 0.3)), glass, (0, 0.4, 0))
    g.camera("front", (1.5, 1.7, 6.2), (1.5, 1.3, 1.5), 40.0)


SCENES = {"cornell": cornell, "smooth": smooth, "cage": cage, "hard": hard}


def main():
    if len(sys.argv) != 3 or sys.argv[1] not in SCENES:
        sys.exit(f"usage: python3 studies.py {'|'.join(SCENES)} OUT.glb")
    g = Glb("samples/scenes/studies.py")
    SCENES[sys.argv[1]](g)
    g.write(sys.argv[2])


main()
