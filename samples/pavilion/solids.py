# SPDX-License-Identifier: MIT
"""How does a solid become faces? Each function here returns a list of (corners, material), seen counter-clockwise from outside.

Points are (x, y, h): x along the podium, y into its depth, h up, metres. A plan rectangle is (x0, y0, x1, y1).
"""

import math


def box(low, high, material, **faces):
    """Six faces; faces names those of another material: west, east, front, back, bottom, top."""
    (a, b, c), (d, e, f) = low, high
    corners = {
        "west": [(a, b, c), (a, b, f), (a, e, f), (a, e, c)],
        "east": [(d, b, c), (d, e, c), (d, e, f), (d, b, f)],
        "front": [(a, b, c), (d, b, c), (d, b, f), (a, b, f)],
        "back": [(a, e, c), (a, e, f), (d, e, f), (d, e, c)],
        "bottom": [(a, b, c), (a, e, c), (d, e, c), (d, b, c)],
        "top": [(a, b, f), (d, b, f), (d, e, f), (a, e, f)],
    }
    return [(corners[side], faces.get(side, material)) for side in corners]


def _grid(rectangles):
    xs = sorted({x for r in rectangles for x in (r[0], r[2])})
    ys = sorted({y for r in rectangles for y in (r[1], r[3])})
    return list(zip(xs, xs[1:])), list(zip(ys, ys[1:]))


def _covers(r, x, y):
    return r[0] <= x[0] and x[1] <= r[2] and r[1] <= y[0] and y[1] <= r[3]


def _riser(x, y, side, low, high):
    """The vertical face between a cell of height high and its lower neighbour on that side."""
    (a, d), (b, e) = x, y
    line = {"west": ((a, e), (a, b)), "east": ((d, b), (d, e)), "front": ((a, b), (d, b)), "back": ((d, e), (a, e))}[side]
    (p, q), (r, s) = line
    return [(p, q, low), (r, s, low), (r, s, high), (p, q, high)]


def terrace(levels, foot):
    """Ground in steps: (rectangle, height, material) each; a later one replaces what lies under it. Neighbours share
    whole edges, so that light is continuous over them. Open at the foot, which stands in the earth."""
    columns, rows = _grid([r for r, _, _ in levels])

    def cell(i, j):
        if 0 <= i < len(columns) and 0 <= j < len(rows):
            for r, height, material in reversed(levels):
                if _covers(r, columns[i], rows[j]):
                    return height, material
        return foot, None

    faces = []
    for i, x in enumerate(columns):
        for j, y in enumerate(rows):
            height, material = cell(i, j)
            if material is None:
                continue
            faces.append(([(x[0], y[0], height), (x[1], y[0], height), (x[1], y[1], height), (x[0], y[1], height)], material))
            for side, (k, l) in {"west": (i - 1, j), "east": (i + 1, j), "front": (i, j - 1), "back": (i, j + 1)}.items():
                below = cell(k, l)[0]
                if below < height:
                    faces.append((_riser(x, y, side, below, height), material))
    return faces


def wall(rectangles, low, high, material):
    """The union of plan rectangles, from low to high: closed, without inner faces."""
    top = terrace([(r, high, material) for r in rectangles], low)
    caps = [corners for corners, _ in top if all(c[2] == high for c in corners)]
    return top + [([(x, y, low) for x, y, _ in reversed(corners)], material) for corners in caps]


def loft(rings, material):
    """A closed skin over polygons of equally many corners, each counter-clockwise from above, from the lowest up."""
    n = len(rings[0])
    faces = [([rings[0][0], rings[0][i + 1], rings[0][i]], material) for i in range(1, n - 1)]
    for lower, upper in zip(rings, rings[1:]):
        for i in range(n):
            j = (i + 1) % n
            faces.append(([lower[i], lower[j], upper[j], upper[i]], material))
    return faces + [([rings[-1][0], rings[-1][i], rings[-1][i + 1]], material) for i in range(1, n - 1)]


def ring(centre, radius, h, sides=8):
    """A regular polygon in plan; radius may be (along x, along y)."""
    rx, ry = radius if isinstance(radius, tuple) else (radius, radius)
    turn = [2 * math.pi * (k + 0.5) / sides for k in range(sides)]
    return [(centre[0] + rx * math.cos(t), centre[1] + ry * math.sin(t), h) for t in turn]


def pleats(start, end, depth, thickness, count, low, high, material):
    """A hanging in zigzag folds along x at y = start[1]: every fold a pair of faces in front and behind."""
    step = (end - start[0]) / (2 * count)
    line = [(start[0] + k * step, start[1] + (depth if k % 2 else 0.0)) for k in range(2 * count + 1)]
    back = [(x, y + thickness) for x, y in line]
    faces = []
    for k in range(2 * count):
        (a, b), (c, d), (e, f), (g, i) = line[k], line[k + 1], back[k + 1], back[k]
        faces.append(([(a, b, low), (c, d, low), (c, d, high), (a, b, high)], material))
        faces.append(([(e, f, low), (g, i, low), (g, i, high), (e, f, high)], material))
        faces.append(([(a, b, high), (c, d, high), (e, f, high), (g, i, high)], material))
        faces.append(([(a, b, low), (g, i, low), (e, f, low), (c, d, low)], material))
    for (p, q), flip in ((line[0], False), (line[-1], True)):
        end_face = [(p, q, low), (p, q, high), (p, q + thickness, high), (p, q + thickness, low)]
        faces.append((end_face[::-1] if flip else end_face, material))
    return faces


def tilted(faces, pivot, degrees):
    """Turned about the line through pivot along y: the +x end goes up."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def turn(p):
        x, h = p[0] - pivot[0], p[2] - pivot[1]
        return (pivot[0] + c * x - s * h, p[1], pivot[1] + s * x + c * h)

    return [([turn(p) for p in corners], material) for corners, material in faces]


def placed(faces, at, degrees=0.0):
    """Turned counter-clockwise as seen from above, about the origin, then moved to at = (x, y, h)."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [([(at[0] + c * x - s * y, at[1] + s * x + c * y, at[2] + h) for x, y, h in corners], material)
            for corners, material in faces]
