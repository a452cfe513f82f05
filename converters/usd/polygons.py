# SPDX-License-Identifier: MIT
"""Which triangles and which vertices are the faces of a mesh? Fans, or what covers a hollow polygon once; of cages fans, in the order in
which FB_ngon_encoding tells faces apart."""

from __future__ import annotations

from typing import Any

import numpy as np

from .primvars import Topology

Array = np.ndarray[Any, Any]


def starts(counts: Array) -> Array:
    """The first corner of each face."""
    return np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64) if len(counts) else np.zeros(0, np.int64)


def corner_order(topology: Topology, faces: Array | None, reverse: bool) -> tuple[Array, Array]:
    """Counts of the faces that are taken, and their corners as numbers of the mesh's corners; reversed where the mesh is
    left-handed."""
    counts, first = topology.counts, starts(topology.counts)
    if faces is not None:
        counts, first = counts[faces], first[faces]
    elif not reverse:
        return counts, np.arange(len(topology.corners))
    within = np.arange(int(counts.sum())) - np.repeat(starts(counts), counts)
    if reverse:
        within = np.repeat(counts, counts) - 1 - within
    return counts, np.repeat(first, counts) + within


def fans(counts: Array) -> Array:
    """Triangles (n, 3) as positions in the list of corners."""
    if len(counts) and (counts == 3).all():
        return np.arange(3 * len(counts)).reshape(-1, 3)
    triangles = counts - 2
    first = np.repeat(starts(counts), triangles)
    step = np.arange(int(triangles.sum())) - np.repeat(starts(triangles), triangles)
    return np.stack([first, first + step + 1, first + step + 2], axis=1)


def face_normals(counts: Array, points: Array) -> Array:
    """As long as twice the area of each face; points: of each corner. [Newell, by sums over triangles from its first corner]"""
    out, first, is_there = np.zeros((len(counts), 3)), starts(counts), counts > 0
    if not is_there.any():
        return out
    from_first = points.astype(float) - np.repeat(points[first[is_there]].astype(float), counts[is_there], axis=0)
    following = np.roll(from_first, -1, axis=0)
    following[(first + counts - 1)[is_there]] = 0
    out[is_there] = np.add.reduceat(np.cross(from_first, following), first[is_there], axis=0)
    return out


def _turns(points: Array, triangles: Array, normals: Array) -> Array:
    """Twice the area of each triangle as its face sees it, less than nothing where it lies the other way round."""
    a, b, c = (points[triangles[..., k]] for k in range(3))
    return np.einsum("...k,...k", np.cross(b - a, c - a), normals)


def _folded(counts: Array, points: Array, cut: Array) -> Array:
    """Faces one of whose triangles lies the other way round. Columns in float32 are five times as fast as np.cross."""
    columns = [np.ascontiguousarray(points[:, k], np.float32) for k in range(3)]
    u, v = ([column[cut[:, k]] - column[cut[:, 0]] for column in columns] for k in (1, 2))
    each = [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]
    first, per_face = starts(counts - 2), counts - 2
    whole = [np.add.reduceat(column, first) for column in each]
    with_face = sum(a * np.repeat(b, per_face) for a, b in zip(each, whole))
    lowest = np.minimum.reduceat(with_face, first)
    return np.nonzero(lowest < -1e-5 * sum(b * b for b in whole))[0]


def triangles(counts: Array, points: Array) -> Array:
    """As fans(), but no triangle lies beside its face: a hollow polygon is cut at other diagonals. points: of each corner."""
    out = fans(counts)
    if not len(counts) or counts.max() < 4:
        return out
    folded = _folded(counts, points, out)
    if not len(folded):
        return out
    points, whole = points.astype(float), face_normals(counts, points)
    first_triangle, first = starts(counts - 2), starts(counts)
    quads = folded[counts[folded] == 4]
    other = first[quads][:, None, None] + np.array([[1, 2, 3], [1, 3, 0]])
    better = (_turns(points, other, whole[quads][:, None]) >= 0).all(axis=1)
    for k in (0, 1):
        out[first_triangle[quads[better]] + k] = other[better, k]
    for face in folded[counts[folded] > 4].tolist():
        count, begin = int(counts[face]), int(first[face])
        cut = _ears(points[begin : begin + count], whole[face])
        if cut is not None:
            at = int(first_triangle[face])
            out[at : at + count - 2] = begin + cut
    return out


def _ears(points: Array, normal: Array) -> Array | None:
    """A polygon by corners whose triangles hold no other [Meisters 1975]; where two places are one, as at a bridge to a hole, they are not
    in each other's way. None: its edges cross."""
    axis = int(np.abs(normal).argmax())
    flat = np.roll(points, -1 - axis, axis=1)[:, :2]
    if normal[axis] < 0:
        flat = flat[:, ::-1]
    left, out, at, tried = list(range(len(flat))), [], 0, 0
    while len(left) > 3 and tried < len(left):
        corner = [left[at - 1], left[at], left[(at + 1) % len(left)]]
        if _is_ear(flat, corner, left):
            out.append(corner)
            del left[at]
            at, tried = at % len(left), 0
        else:
            at, tried = (at + 1) % len(left), tried + 1
    return np.array([*out, left]) if len(left) == 3 else None


def _is_ear(flat: Array, corner: list[int], left: list[int]) -> bool:
    a, b, c = flat[corner]
    others = flat[left]
    others = others[~((others == a).all(axis=1) | (others == b).all(axis=1) | (others == c).all(axis=1))]

    def side(p: Array, q: Array, r: Array) -> Array:
        return (q[0] - p[0]) * (r[..., 1] - p[1]) - (q[1] - p[1]) * (r[..., 0] - p[0])

    inside = (side(a, b, others) >= 0) & (side(b, c, others) >= 0) & (side(c, a, others) >= 0)
    return bool(side(a, b, c) > 0) and not inside.any()


def tell_apart(counts: Array, vertices: Array) -> Array:
    """Corners of the faces, turned so that no fan reads as a part of the one before it: the first two vertices of a face are not
    the first and the last of its neighbour in the list."""
    out, first = vertices.copy(), starts(counts)
    last = first + counts - 1
    for _ in range(64):
        joined = np.nonzero((out[first[1:]] == out[first[:-1]]) & (out[first[1:] + 1] == out[last[:-1]]))[0] + 1
        if not len(joined):
            break
        for face in joined.tolist():
            begin, end = int(first[face]), int(last[face]) + 1
            out[begin:end] = np.roll(out[begin:end], -1)
    return out


# ---- welding -----------------------------------------------------------------------------------------------------------


def equal_rows(values: Array) -> Array:
    """A number a row, the same where rows have the same bits. Rows are told apart by a hash of 64 bits, which is checked."""
    bits = np.ascontiguousarray(values, np.float32).view(np.uint32).reshape(len(values), -1)
    key = np.zeros(len(values), np.uint64)
    for column, factor in zip(bits.T, (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x27D4EB2F165667C5)):
        key = (key ^ (column.astype(np.uint64) + np.uint64(1))) * np.uint64(factor)
        key ^= key >> np.uint64(29)
    _, first, row = np.unique(key, return_index=True, return_inverse=True)
    if (bits[first[row]] != bits).any():
        return np.arange(len(values))
    return row


def _by_point(points: Array) -> tuple[Array, Array]:
    """The same without sorting, for a million corners."""
    first = np.full(int(points.max()) + 1 if len(points) else 0, -1, np.int64)
    first[points[::-1]] = np.arange(len(points))[::-1]
    used = first >= 0
    return first[used], (np.cumsum(used) - 1)[points]


def weld(points: Array, keys: list[Array]) -> tuple[Array, Array]:
    """One vertex for all corners that share a point and every attribute: a corner of each vertex, and each corner's vertex."""
    if not keys:
        return _by_point(points)
    key = points.astype(np.int64)
    for other in keys:
        if len(other) and (int(key.max()) + 1) * (int(other.max()) + 1) > 2**62:
            key = np.unique(key, return_inverse=True)[1]
        key = key * (int(other.max()) + 1) + other if len(other) else key
    _, first, vertex = np.unique(key, return_index=True, return_inverse=True)
    return first, vertex
