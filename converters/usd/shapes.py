# SPDX-License-Identifier: MIT
"""Which triangles stand for the shapes that have no points? Those of UsdGeom have their vertices on the surface, so that a box
around them is exact; bodies of lamps have the exact area instead, so that their power is."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from pxr import UsdGeom

Array = np.ndarray[Any, Any]
Triangles = tuple[Array, Array]  # positions (n, 3) float32, triangles (m, 3) uint32

SIDES = 32


def _grid(columns: int, rows: int) -> Array:
    """Triangles of a strip of rows that closes after its columns; counter-clockwise from outside where rows rise along the axis."""
    i, j = np.meshgrid(np.arange(columns), np.arange(rows - 1), indexing="ij")
    a, b = j * columns + i, j * columns + (i + 1) % columns
    quads = np.stack([a, b, b + columns, a + columns], axis=-1).reshape(-1, 4)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def revolved(profile: Array, sides: int) -> Triangles:
    """Turns a profile of (radius, height) around z; where the radius is 0 triangles that have no area go."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.round(np.stack([np.cos(angle), np.sin(angle)], axis=1), 15)
    points = np.concatenate([np.column_stack([r * ring, np.full(sides, z)]) for r, z in profile])
    triangles = _grid(sides, len(profile))
    kept = [t for t in triangles.tolist() if len({tuple(points[v]) for v in t}) == 3]
    return points.astype(np.float32), np.array(kept, np.uint32)


def _along(axis: str, shape: Triangles) -> Triangles:
    """From z to another axis, turned and not mirrored."""
    order = {"X": [2, 0, 1], "Y": [1, 2, 0]}.get(axis)
    return (np.ascontiguousarray(shape[0][:, order]), shape[1]) if order else shape


def sphere(radius: float, sides: int = SIDES) -> Triangles:
    angle = np.pi * (np.arange(sides // 2 + 1) / (sides // 2) - 0.5)
    return revolved(np.round(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), 12), sides)


def cube(size: float) -> Triangles:
    h = size / 2
    points = np.array([[x, y, z] for x in (-h, h) for y in (-h, h) for z in (-h, h)], np.float32)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return points, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.uint32)


def cylinder(bottom: float, top: float, height: float, sides: int = SIDES) -> Triangles:
    h = height / 2
    return revolved(np.array([(0, -h), (bottom, -h), (top, h), (0, h)]), sides)


def capsule(bottom: float, top: float, height: float, sides: int = SIDES) -> Triangles:
    angle = 0.5 * np.pi * np.arange(sides // 4 + 1) / (sides // 4)
    low = [(bottom * math.sin(a), -height / 2 - bottom * math.cos(a)) for a in angle]
    high = [(top * math.cos(a), height / 2 + top * math.sin(a)) for a in angle]
    return revolved(np.round(np.array(low + high), 12), sides)


def plane(width: float, length: float, axis: str) -> Triangles:
    """Width and length as the schema lays them: X: z and y; Y: x and z; Z: x and y."""
    w, h = width / 2, length / 2
    square = np.array([[-w, -h], [w, -h], [w, h], [-w, h]])
    zero = np.zeros(4)
    columns = {"X": (zero, square[:, 1], -square[:, 0]), "Y": (square[:, 0], zero, -square[:, 1])}.get(axis, (square[:, 0], square[:, 1], zero))
    return np.stack(columns, axis=1).astype(np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


# Faces that meet at less than this, degrees, are of one round surface: those of SIDES do at 11, caps at 90.
CREASE = 40.0


def smooth_normals(shape: Triangles) -> tuple[Array, Array, Array]:
    """Positions, triangles and normals, with a vertex more where a cap meets a side: round shapes are round, of however many faces."""
    triangles = shape[1]
    corners = shape[0].astype(float)[triangles]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    wide = np.cross(ahead, behind)
    faces = wide[:, 0] / np.linalg.norm(wide[:, 0], axis=1, keepdims=True)
    # Each counts by its angle there, so that it does not matter which way a quad was cut.
    angles = np.arctan2(np.linalg.norm(wide, axis=2), (ahead * behind).sum(axis=2))
    around: dict[bytes, list[tuple[int, int]]] = {}
    for t in range(len(triangles)):
        for k, v in enumerate(triangles[t]):
            around.setdefault(shape[0][v].tobytes(), []).append((t, k))
    numbers: dict[tuple[int, bytes], int] = {}
    out = np.empty_like(triangles)
    normals = []
    for t in range(len(triangles)):
        for k, v in enumerate(triangles[t]):
            near, at = np.array(around[shape[0][v].tobytes()]).T
            is_round = faces[near] @ faces[t] > math.cos(math.radians(CREASE))
            normal = angles[near[is_round], at[is_round]] @ faces[near[is_round]]
            normal = np.round(normal / np.linalg.norm(normal), 6).astype(np.float32) + np.float32(0)
            key = (int(v), normal.tobytes())
            if key not in numbers:
                numbers[key] = len(normals)
                normals.append(normal)
            out[t, k] = numbers[key]
    return shape[0][[v for v, _ in numbers]], out, np.array(normals, np.float32)


# ---- gprims ------------------------------------------------------------------------------------------------------------


def _two_radii(schema: Any, get: Callable[[Any], Any]) -> tuple[float, float]:
    return float(get(schema.GetRadiusBottomAttr())), float(get(schema.GetRadiusTopAttr()))


def of_prim(prim: Any, time: Any, sides: int = SIDES) -> Triangles | None:
    """None: it is none of these."""
    kind = prim.GetTypeName()

    def get(attribute: Any) -> Any:
        return attribute.Get(time)

    if kind == "Sphere":
        return sphere(float(get(UsdGeom.Sphere(prim).GetRadiusAttr())), sides)
    if kind == "Cube":
        return cube(float(get(UsdGeom.Cube(prim).GetSizeAttr())))
    if kind == "Plane":
        s = UsdGeom.Plane(prim)
        return plane(float(get(s.GetWidthAttr())), float(get(s.GetLengthAttr())), str(get(s.GetAxisAttr())))
    if kind in ("Cylinder", "Cone", "Capsule"):
        s = getattr(UsdGeom, kind)(prim)
        radius, height = float(get(s.GetRadiusAttr())), float(get(s.GetHeightAttr()))
        made = capsule(radius, radius, height, sides) if kind == "Capsule" else cylinder(radius, 0.0 if kind == "Cone" else radius, height, sides)
        return _along(str(get(s.GetAxisAttr())), made)
    if kind in ("Cylinder_1", "Capsule_1"):
        s = getattr(UsdGeom, kind)(prim)
        bottom, top = _two_radii(s, get)
        return _along(str(get(s.GetAxisAttr())), (capsule if kind == "Capsule_1" else cylinder)(bottom, top, float(get(s.GetHeightAttr())), sides))
    return None


def is_inside_out(prim: Any, time: Any) -> bool:
    """By a size below 0."""
    sizes = (prim.GetAttribute(name).Get(time) for name in ("size", "radius", "height", "radiusTop", "radiusBottom", "width", "length") if prim.HasAttribute(name))
    return any(size is not None and size < 0 for size in sizes)


# ---- bodies of lamps ---------------------------------------------------------------------------------------------------


def area(shape: Triangles, matrix: Array | None = None) -> float:
    """Of the triangles after a matrix whose rows are images of the axes."""
    points = shape[0].astype(float) if matrix is None else shape[0].astype(float) @ matrix[:3, :3]
    a, b, c = (points[shape[1][:, k]] for k in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def true_area(prim: Any, time: Any, matrix: Array) -> float:
    """Of the shape itself after a matrix: what is missing falls with the square of the sides, so two numbers of them say it."""
    coarse, fine = (of_prim(prim, time, sides) for sides in (SIDES, 2 * SIDES))
    return (4 * area(fine, matrix) - area(coarse, matrix)) / 3 if coarse and fine else 0.0


def rectangle(width: float, height: float) -> Triangles:
    """Shines along -z."""
    w, h = width / 2, height / 2
    return np.array([[-w, -h, 0], [w, -h, 0], [w, h, 0], [-w, h, 0]], np.float32), np.array([[0, 2, 1], [0, 3, 2]], np.uint32)


def disk(radius: float, sides: int = 24) -> Triangles:
    """Shines along -z."""
    r = radius * math.sqrt(2 * math.pi / (sides * math.sin(2 * math.pi / sides)))
    angle = 2 * np.pi * np.arange(sides) / sides
    points = np.concatenate([[[0, 0, 0]], np.column_stack([r * np.cos(angle), r * np.sin(angle), np.zeros(sides)])])
    at = np.arange(sides)
    return points.astype(np.float32), np.column_stack([np.zeros(sides, int), (at + 1) % sides + 1, at + 1]).astype(np.uint32)


def tube(radius: float, length: float, sides: int = 24) -> Triangles:
    """Along x, without caps."""
    r = radius * math.pi / (sides * math.sin(math.pi / sides))
    return _along("X", revolved(np.array([(r, -length / 2), (r, length / 2)]), sides))


def ball(radius: float) -> Triangles:
    """An octahedron split twice: 128 faces of much the same size. A convex body shows a quarter of its area on average, so the
    light that falls somewhere is right on average over directions too."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    vertices, triangles = np.array(points, float), np.array(faces)
    for _ in range(2):
        corners = vertices[triangles]
        middles = (corners + np.roll(corners, -1, axis=1)) / 2
        a, b, c = (corners[:, k] for k in range(3))
        ab, bc, ca = (middles[:, k] for k in range(3))
        soup = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1).reshape(-1, 3)
        soup /= np.linalg.norm(soup, axis=1, keepdims=True)
        vertices, inverse = np.unique(np.round(soup, 12), axis=0, return_inverse=True)
        triangles = inverse.reshape(-1, 3)
    made = (vertices.astype(np.float32), triangles.astype(np.uint32))
    scale = radius * math.sqrt(4 * math.pi / area(made))
    return (made[0] * np.float32(scale)).astype(np.float32), made[1]
