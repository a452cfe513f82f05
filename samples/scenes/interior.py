# SPDX-License-Identifier: MIT
"""A living room: wood, cloth and pictures by textures, round furniture, two cameras, a window for sun and sky.

    python3 samples/scenes/interior.py FILE.glb
"""

import math
import sys

from gltf import Glb, png
from shapes import box, cushion, join, moved, quad, sphere, turned

WIDTH, DEPTH, HEIGHT = 6.0, 4.6, 2.7  # x from 0, z from 0 (the window) to the back
WINDOW = (1.0, 4.4, 0.35, 2.35)       # x, x, y, y
THICK = 0.25


def noise(*at):
    """In [0,1), the same everywhere."""
    n = 0
    for k in at:
        n = (n * 1103515245 + int(k) * 12345 + 1013904223) & 0xFFFFFFFF
        n ^= n >> 13
    return (n * 2654435761 & 0xFFFFFFFF) / 2 ** 32


def wood(x, y):
    """Planks, eight across, each of a tone of its own, with a grain along it and a dark joint."""
    plank, along = x // 32, (y + 61 * (x // 32)) % 256
    grain = 0.5 + 0.5 * math.sin(0.9 * (x % 32) + 2.5 * math.sin(along / 256 * 2 * math.pi + 5 * noise(plank)) + 6 * noise(plank, 3))
    tone = (0.75 + 0.4 * noise(plank, along // 128, 1)) * (0.86 + 0.14 * grain) * (0.45 if x % 32 == 0 or along % 128 == 0 else 1.0)
    return 0.42 * tone, 0.25 * tone, 0.13 * tone


def weave(x, y):
    """A rug: stripes with a border."""
    edge = min(x, y, 127 - x, 127 - y)
    tone = 0.85 + 0.3 * noise(x, y)
    color = (0.05, 0.10, 0.16) if edge < 8 else (0.55, 0.47, 0.36) if (y // 8) % 3 else (0.46, 0.12, 0.07)
    return tuple(tone * c for c in color)


def painting(x, y):
    """Hills under a low sun."""
    u, v = x / 128, 1 - y / 96
    sun = math.hypot(u - 0.68, (v - 0.55) * 0.75) < 0.11
    for i, color in enumerate(((0.05, 0.09, 0.12), (0.10, 0.20, 0.20), (0.22, 0.32, 0.28))):
        if v < 0.16 + 0.13 * i + 0.06 * math.sin(7 * u + 2 * i) + 0.03 * math.sin(17 * u + i):
            return color
    return (0.95, 0.62, 0.25) if sun else (0.75 - 0.3 * v, 0.42 + 0.1 * v, 0.26 + 0.35 * v)


def room(g, plaster, accent, floor, frame):
    x0, x1, y0, y1 = WINDOW
    w, d, h = WIDTH, DEPTH, HEIGHT
    g.mesh("floor", quad((0, 0, d), (w, 0, d), (w, 0, 0), (0, 0, 0), (3, 2.3)), floor)
    g.mesh("ceiling", quad((0, h, 0), (w, h, 0), (w, h, d), (0, h, d)), plaster)
    g.mesh("back wall", quad((w, 0, d), (0, 0, d), (0, h, d), (w, h, d)), accent)
    g.mesh("left wall", quad((0, 0, d), (0, 0, 0), (0, h, 0), (0, h, d)), plaster)
    g.mesh("right wall", quad((w, 0, 0), (w, 0, d), (w, h, d), (w, h, 0)), plaster)
    pieces = [((0, 0), (x0, h)), ((x1, 0), (w, h)), ((x0, 0), (x1, y0)), ((x0, y1), (x1, h))]
    g.mesh("window wall", join(*(quad((a, b, 0), (c, b, 0), (c, e, 0), (a, e, 0)) for (a, b), (c, e) in pieces)), plaster)
    reveal = [quad((x0, y0, 0), (x1, y0, 0), (x1, y0, -THICK), (x0, y0, -THICK)),
              quad((x0, y1, -THICK), (x1, y1, -THICK), (x1, y1, 0), (x0, y1, 0)),
              quad((x0, y0, 0), (x0, y0, -THICK), (x0, y1, -THICK), (x0, y1, 0)),
              quad((x1, y0, -THICK), (x1, y0, 0), (x1, y1, 0), (x1, y1, -THICK))]
    g.mesh("reveal", join(*reveal), plaster)
    middle = -THICK / 2
    for x in (x0 + (x1 - x0) / 3, x0 + 2 * (x1 - x0) / 3):
        g.mesh("mullion", box((x - 0.03, y0, middle - 0.03), (x + 0.03, y1, middle + 0.03)), frame)
    skirting = [box((0, 0, d - 0.02), (w, 0.09, d)), box((0, 0, 0), (0.02, 0.09, d - 0.02)), box((w - 0.02, 0, 0), (w, 0.09, d - 0.02))]
    g.mesh("skirting", join(*skirting), frame)


def sofa(g, cloth, legs, at, turn, wide):
    parts = [moved(cushion((wide, 0.26, 0.92), 0.07), (0, 0.14, 0)), moved(cushion((wide, 0.5, 0.24), 0.1), (0, 0.36, -0.36))]
    parts += [moved(cushion((0.2, 0.48, 0.92), 0.08), (s * (wide / 2 + 0.06), 0.14, 0)) for s in (-1, 1)]
    seats = max(1, round(wide / 0.75))
    each = (wide - 0.06) / seats
    parts += [moved(cushion((each - 0.02, 0.16, 0.7), 0.06), (each * (i + 0.5) - wide / 2 + 0.03, 0.38, 0.1)) for i in range(seats)]
    g.mesh("sofa", join(*parts), cloth, at, turn)
    feet = (box((x - 0.03, 0, z - 0.03), (x + 0.03, 0.15, z + 0.03)) for x in (-wide / 2, wide / 2) for z in (-0.38, 0.38))
    g.mesh("feet", join(*feet), legs, at, turn)


def disc_profile(radius, low, high, edge):
    """A round slab with a round rim."""
    rim = [(radius - edge + edge * math.cos(a), (low + high) / 2 + edge * math.sin(a), (math.cos(a), math.sin(a)))
           for a in (math.pi * k / 8 for k in range(-4, 5))]
    return [(0.0, low, (0, -1)), (radius - edge, low, (0, -1)), *rim, (radius - edge, high, (0, 1)), (0.0, high, (0, 1))]


def main():
    g = Glb("samples/scenes/interior.py")
    plaster, accent = g.material("plaster", (0.78, 0.76, 0.72)), g.material("clay paint", (0.36, 0.44, 0.40))
    floor = g.material("oak planks", (1, 1, 1), g.texture(png(256, 256, wood)))
    frame, legs = g.material("white paint", (0.82, 0.82, 0.80)), g.material("dark oak", (0.16, 0.09, 0.05))
    linen, ochre = g.material("linen", (0.60, 0.56, 0.49)), g.material("ochre velvet", (0.62, 0.36, 0.08))
    rug = g.material("rug", (1, 1, 1), g.texture(png(128, 128, weave)))
    picture = g.material("picture", (1, 1, 1), g.texture(png(128, 96, painting)))
    clay, leaf = g.material("terracotta", (0.45, 0.17, 0.09)), g.material("leaf", (0.07, 0.18, 0.05), doubleSided=True)
    shade = g.material("lampshade", (0.8, 0.74, 0.62))
    room(g, plaster, accent, floor, frame)
    g.mesh("rug", quad((1.5, 0.012, 3.3), (4.7, 0.012, 3.3), (4.7, 0.012, 1.2), (1.5, 0.012, 1.2)), rug)
    sofa(g, linen, legs, (3.1, 0, 3.85), 180.0, 2.1)
    sofa(g, ochre, legs, (5.1, 0, 2.1), -70.0, 0.72)
    for x, tint in ((-0.75, ochre), (0.7, accent)):
        g.mesh("pillow", cushion((0.42, 0.4, 0.16), 0.075), tint, (3.1 + x, 0.53, 3.92), 12 * x)
    g.mesh("table top", turned(disc_profile(0.48, 0.36, 0.40, 0.02)), legs, (3.0, 0, 2.35))
    g.mesh("table legs", join(*(turned_leg(0.34 * math.cos(a), 0.34 * math.sin(a)) for a in (0.5, 2.6, 4.7))), legs, (3.0, 0, 2.35))
    g.mesh("bowl", sphere(0.13, squash=0.55), frame, (2.9, 0.47, 2.3))
    g.mesh("orange", sphere(0.045, 24, 12), ochre, (3.22, 0.445, 2.42))
    g.mesh("picture", quad((3.9, 1.3, 4.58), (2.3, 1.3, 4.58), (2.3, 2.25, 4.58), (3.9, 2.25, 4.58)), picture)
    g.mesh("picture frame", box((2.26, 1.26, 4.581), (3.94, 2.29, 4.6)), legs)
    pot = [(0.0, 0.0, (0, -1)), (0.16, 0.0, (0, -1)), (0.16, 0.0, (1, 0)), (0.21, 0.36, (1, 0)), (0.21, 0.36, (0, 1)), (0.0, 0.33, (0, 1))]
    g.mesh("pot", turned(pot), clay, (0.55, 0, 0.75))
    leaves = []
    for i in range(22):
        a, up, reach = 2.4 * i, 0.55 + 0.5 * noise(i), 0.22 + 0.3 * noise(i, 1)
        c, s, wide = math.cos(a), math.sin(a), 0.07
        tip = (reach * c, 0.33 + up, reach * s)
        side = (-wide * s, 0.0, wide * c)
        half = (0.55 * reach * c, 0.33 + 0.8 * up, 0.55 * reach * s)
        left, right = tuple(m + k for m, k in zip(half, side)), tuple(m - k for m, k in zip(half, side))
        leaves.append(([(0.02 * c, 0.33, 0.02 * s), left, tip, right], None, None, [(0, 1, 2), (0, 2, 3)]))
    g.mesh("plant", join(*leaves), leaf, (0.55, 0, 0.75))
    foot = join(turned(disc_profile(0.15, 0.0, 0.03, 0.012)), turned([(0.012, 0.03, (1, 0)), (0.012, 1.35, (1, 0))], 12))
    g.mesh("lamp foot", foot, legs, (5.35, 0, 3.95))
    g.mesh("lamp shade", turned([(0.24, 1.3, (0.95, 0.3)), (0.15, 1.62, (0.95, 0.3)), (0.0, 1.62, (0, 1))]), shade, (5.35, 0, 3.95))
    g.camera("corner", (0.45, 1.5, 4.15), (3.6, 0.75, 1.5), 52.0)
    g.camera("window", (4.2, 1.45, 0.35), (2.7, 0.8, 3.6), 58.0)
    g.write(sys.argv[1])


def turned_leg(x, z):
    return moved(turned([(0.02, 0.0, (1, 0)), (0.025, 0.36, (1, 0))], 12), (x, 0, z))


main()
