# SPDX-License-Identifier: MIT
"""A living room: wood, cloth and pictures by textures, round furniture, two cameras, two windows for sun and sky, a garden that is only seen.

    python3 samples/scenes/interior.py FILE.glb
"""

import math
import sys

from gltf import Glb, png
from shapes import box, cushion, join, moved, quad, sphere, turned

WIDTH, DEPTH, HEIGHT = 6.0, 4.6, 2.7  # x from 0, z from 0 (the window) to the back
WINDOW = (1.0, 4.4, 0.35, 2.35)       # x, x, y, y
SIDE = (1.1, 3.1, 0.35, 2.35)         # z, z, y, y, in the left wall
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


def garden(x, y):
    """A lawn, bushes, hills and a sky with haze, all around; the horizon is at half of its height."""
    u, v = x / 2048 * 2 * math.pi, 1 - y / 512
    hills = 0.57 + 0.035 * math.sin(3 * u) + 0.02 * math.sin(7 * u + 1) + 0.006 * math.sin(19 * u)
    bushes = 0.53 + 0.02 * math.sin(5 * u + 2) + 0.012 * math.sin(11 * u) + 0.012 * abs(math.sin(31 * u)) + 0.006 * abs(math.sin(83 * u + 1))
    if v < 0.46:
        return tuple((0.85 + 0.05 * noise(x // 2, y) + 0.5 * v) * c for c in (0.20, 0.30, 0.10))
    if v < bushes:
        return tuple((0.7 + 0.12 * noise(x // 3, y // 3) + 4 * (v - 0.46)) * c for c in (0.09, 0.17, 0.07))
    if v < hills:
        return 0.36 + 0.4 * (hills - v), 0.48 + 0.2 * (hills - v), 0.55 - 0.6 * (hills - v)
    haze = min(1.0, (v - 0.5) / 0.5)
    return 0.80 - 0.42 * haze, 0.86 - 0.26 * haze, 0.93 - 0.08 * haze


def backdrop(radius, low, high, columns=48):
    """A ring about the room, seen from inside."""
    ring = [(-2 * math.pi * i / columns, i / columns) for i in range(columns + 1)]
    positions = [(WIDTH / 2 + radius * math.cos(a), y, DEPTH / 2 + radius * math.sin(a)) for y in (low, high) for a, _ in ring]
    places = [(u, v) for v in (1, 0) for _, u in ring]
    wide = columns + 1
    return positions, None, places, [t for i in range(columns) for t in ((i, i + wide, i + 1), (i + 1, i + wide, i + wide + 1))]


def pierced(place, span, hole):
    """A wall with a hole, in four pieces; place(along, up) is a point of it, span how long it is."""
    a, c, b, e = hole
    pieces = [((0, 0), (a, HEIGHT)), ((c, 0), (span, HEIGHT)), ((a, 0), (c, b)), ((a, e), (c, HEIGHT))]
    return join(*(quad(place(x, y), place(z, y), place(z, w), place(x, w)) for (x, y), (z, w) in pieces))


def reveal(place, hole):
    """The four sides of a hole; place(along, up, out)."""
    a, c, b, e = hole
    around = [(a, b), (c, b), (c, e), (a, e), (a, b)]
    return join(*(quad(place(*p, 0), place(*q, 0), place(*q, THICK), place(*p, THICK)) for p, q in zip(around, around[1:])))


def room(g, plaster, accent, floor, frame):
    x0, x1, y0, y1 = WINDOW
    w, d, h = WIDTH, DEPTH, HEIGHT
    side = (d - SIDE[1], d - SIDE[0], *SIDE[2:])  # along from the back to the window
    walls = [quad((0, h, 0), (w, h, 0), (w, h, d), (0, h, d)), quad((w, 0, 0), (w, 0, d), (w, h, d), (w, h, 0)),
             pierced(lambda x, y: (x, y, 0), w, WINDOW), reveal(lambda x, y, out: (x, y, -out), WINDOW),
             pierced(lambda x, y: (0, y, d - x), d, side), reveal(lambda x, y, out: (-out, y, d - x), side)]
    middle, z = -THICK / 2, (SIDE[0] + SIDE[1]) / 2
    bars = [box((x - 0.03, y0, middle - 0.03), (x + 0.03, y1, middle + 0.03)) for x in (x0 + (x1 - x0) / 3, x0 + 2 * (x1 - x0) / 3)]
    bars.append(box((middle - 0.03, y0, z - 0.03), (middle + 0.03, y1, z + 0.03)))
    skirting = [box((0, 0, d - 0.02), (w, 0.09, d)), box((0, 0, 0), (0.02, 0.09, d - 0.02)), box((w - 0.02, 0, 0), (w, 0.09, d - 0.02))]
    cornice = [box((0, h - 0.05, d - 0.04), (w, h, d)), box((0, h - 0.05, 0), (0.04, h, d - 0.04)), box((w - 0.04, h - 0.05, 0), (w, h, d - 0.04)),
               box((0.04, h - 0.05, 0), (w - 0.04, h, 0.04))]
    g.meshes("room", [(join(*walls), plaster), (quad((w, 0, d), (0, 0, d), (0, h, d), (w, h, d)), accent),
                      (quad((0, 0, d), (w, 0, d), (w, 0, 0), (0, 0, 0), (3, 2.3)), floor), (join(*bars, *skirting, *cornice), frame)])


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
    if len(sys.argv) != 2 or not sys.argv[1].endswith(".glb"):
        sys.exit("usage: python3 interior.py OUT.glb")
    g = Glb("samples/scenes/interior.py")
    plaster, accent = g.material("plaster", (0.84, 0.82, 0.78)), g.material("clay paint", (0.42, 0.53, 0.48))
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
    sofa(g, ochre, legs, (5.15, 0, 2.75), -60.0, 0.72)
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
    outside = g.material("garden", (1, 1, 1), g.texture(png(2048, 512, garden)), extensions={"KHR_materials_unlit": {}})
    g._use("KHR_materials_unlit")
    g.mesh("garden", backdrop(16.0, -6.5, 9.5), outside, extras={"hemibake": {"bake": False, "castShadow": False}})
    g.camera("corner", (5.7, 1.5, 0.25), (2.1, 0.9, 3.3), 56.0)
    g.camera("window", (0.4, 1.5, 4.15), (3.6, 0.8, 1.3), 56.0)
    g.write(sys.argv[1])


def turned_leg(x, z):
    return moved(turned([(0.02, 0.0, (1, 0)), (0.025, 0.36, (1, 0))], 12), (x, 0, z))


main()
