# SPDX-License-Identifier: MIT
"""Which shapes do the scenes stand on? Each is (positions, normals or None, texture coordinates or None, triangles); fronts outside."""

import math


def quad(a, b, c, d, repeat=(1, 1)):
    """Counter-clockwise seen from its front; the texture repeats along ab and ad."""
    return [a, b, c, d], None, [(0, repeat[1]), (repeat[0], repeat[1]), (repeat[0], 0), (0, 0)], [(0, 1, 2), (0, 2, 3)]


def join(*shapes):
    """One mesh of shapes that have the same attributes."""
    positions, normals, places, triangles = [], [], [], []
    for p, n, t, faces in shapes:
        first = len(positions)
        positions += p
        normals += n or []
        places += t or []
        triangles += [tuple(first + i for i in face) for face in faces]
    return positions, normals or None, places or None, triangles


def moved(shape, by):
    positions, normals, places, triangles = shape
    return [tuple(x + d for x, d in zip(p, by)) for p in positions], normals, places, triangles


def box(low, high):
    """Flat, without textures."""
    x, y, z = zip(low, high)
    corner = [(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)]
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    parts = [quad(*(corner[i] for i in face)) for face in faces]
    return join(*((p, None, None, t) for p, _, _, t in parts))


def grid(columns, rows, at):
    """at(u, v) gives (position, normal), u and v in [0,1]; fronts are where u to v turns counter-clockwise."""
    points = [at(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            triangles += [(a, a + 1, a + columns + 2), (a, a + columns + 2, a + columns + 1)]
    positions = [p for p, _ in points]
    return positions, [n for _, n in points], None, [t for t in triangles if len({positions[i] for i in t}) == 3]


def sphere(radius, columns=32, rows=16, squash=1.0):
    """About the origin, with the normals of the surface; squash: its height as a share of its width."""
    def at(u, v):
        turn, down = -2 * math.pi * u, math.pi * v
        n = (math.sin(down) * math.cos(turn), math.cos(down), math.sin(down) * math.sin(turn))
        length = math.sqrt(n[0] ** 2 + (n[1] / squash) ** 2 + n[2] ** 2)
        place = tuple(round(radius * k, 7) + 0.0 for k in (n[0], n[1] * squash, n[2]))
        return place, tuple(k / length for k in (n[0], n[1] / squash, n[2]))

    return grid(columns, rows, lambda u, v: at(u, 1 - v))


def turned(profile, columns=32):
    """A profile of (radius, height, outward slope normal) from below to above, about the y axis."""
    def at(u, v):
        radius, height, (out, up) = profile[round(v * (len(profile) - 1))]
        turn = -2 * math.pi * u
        place = (round(radius * math.cos(turn), 7) + 0.0, height, round(radius * math.sin(turn), 7) + 0.0)
        return place, (out * math.cos(turn), up, out * math.sin(turn))

    return grid(columns, len(profile) - 1, at)


def cushion(size, radius, steps=4):
    """A box with round edges from the origin's floor up: width, height, depth."""
    half = [s / 2 - radius for s in size]

    def at(direction):
        length = math.sqrt(sum(k * k for k in direction))
        n = [k / length for k in direction]
        middle = [math.copysign(h, k) if abs(k) > 1e-9 else 0.0 for h, k in zip(half, n)]
        return n, middle

    # Every sixth of a sphere's cube, its middle widened to the flat of the box.
    lines = [math.tan(math.pi / 4 * (2 * i / steps - 1)) for i in range(steps + 1)]
    ticks = [(k, -1) for k in lines if k < 1e-9] + [(k, 1) for k in lines if k > -1e-9]
    parts = []
    for axis in range(3):
        for side in (-1, 1):
            b, c = (axis + 1) % 3, (axis + 2) % 3
            rows = []
            for kc, sc in ticks:
                for kb, sb in ticks:
                    direction = [0.0, 0.0, 0.0]
                    direction[axis], direction[b], direction[c] = side, kb * side, kc
                    n, _ = at(direction)
                    signs = [0.0, 0.0, 0.0]
                    signs[axis], signs[b], signs[c] = side, sb * side, sc
                    position = tuple(round(s * h + radius * k, 7) + 0.0 for s, h, k in zip(signs, half, n))
                    rows.append((position, tuple(n)))
            wide = len(ticks)
            corners = [j * wide + i for j in range(wide - 1) for i in range(wide - 1)]
            faces = [t for k in corners for t in ((k, k + 1, k + wide + 1), (k, k + wide + 1, k + wide))]
            positions = [p for p, _ in rows]
            parts.append((positions, [n for _, n in rows], None, [t for t in faces if len({positions[i] for i in t}) == 3]))
    return moved(join(*parts), (0.0, size[1] / 2, 0.0))
