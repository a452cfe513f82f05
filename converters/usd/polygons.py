# SPDX-License-Identifier: MIT
"""Which triangles and which vertices are the faces of a mesh? Fans, as Hydra draws polygons, and for cages in the order in which
FB_ngon_encoding tells faces apart."""

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
        key = key * (int(other.max()) + 1) + other if len(other) else key
    _, first, vertex = np.unique(key, return_index=True, return_inverse=True)
    return first, vertex
