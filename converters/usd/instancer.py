# SPDX-License-Identifier: MIT
"""Where does a PointInstancer put copies of what? Ids, orientations, scales and what is invisible, as pxr computes them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import UsdGeom

from .items import Copies

if TYPE_CHECKING:
    from .reader import Inherited, Reader

Array = np.ndarray[Any, Any]


def _floats(attribute: Any, time: Any, width: int) -> Array | None:
    value = attribute.Get(time) if attribute else None
    return None if value is None or not len(value) else np.asarray(value, float).reshape(-1, width)


def _quaternions(schema: Any, time: Any) -> Array | None:
    """(x, y, z, w); orientationsf goes before orientations, as in pxr."""
    for name in ("orientationsf", "orientations"):
        attribute = schema.GetPrim().GetAttribute(name)
        value = attribute.Get(time) if attribute else None
        if value is not None and len(value):
            return np.asarray(value, float).reshape(-1, 4)
    return None


def rotations(q: Array) -> Array:
    """Rows are images of the axes; q is (x, y, z, w), of any length."""
    norm = np.linalg.norm(q, axis=1, keepdims=True)
    x, y, z, w = (np.where(norm > 0, q / np.maximum(norm, 1e-300), [0, 0, 0, 1])).T
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1),
        np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1),
        np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1),
    ], axis=1)  # fmt: skip


def _matrices(schema: Any, time: Any, count: int) -> Array | None:
    """Scale, then rotation, then position. None: the arrays do not fit together."""
    positions = _floats(schema.GetPositionsAttr(), time, 3)
    scales, turns = _floats(schema.GetScalesAttr(), time, 3), _quaternions(schema, time)
    if positions is None or any(a is not None and len(a) != count for a in (positions, scales, turns)):
        return None
    out = np.tile(np.eye(4), (count, 1, 1))
    if turns is not None:
        out[:, :3, :3] = rotations(turns)
    if scales is not None:
        out[:, :3, :3] *= scales[:, :, None]
    out[:, 3, :3] = positions
    return out


def read_copies(reader: Reader, prim: Any, here: Inherited) -> list[Copies]:
    """One for each prototype that has copies."""
    time, losses = reader.time, reader.losses
    schema = UsdGeom.PointInstancer(prim)
    which = np.asarray(schema.GetProtoIndicesAttr().Get(time) or [], np.int64)
    targets = schema.GetPrototypesRel().GetForwardedTargets()
    if not len(which) or not targets:
        return []
    matrices = _matrices(schema, time, len(which))
    if matrices is None or which.min() < 0 or which.max() >= len(targets):
        losses.add(prim, "not baked, its arrays do not fit together")
        return []
    mask = schema.ComputeMaskAtTime(time)
    shown = np.asarray(mask, bool) if mask else np.ones(len(which), bool)
    shown &= np.isfinite(matrices).all(axis=(1, 2))
    out = []
    for number, path in enumerate(targets):
        placed = matrices[shown & (which == number)]
        prototype = prim.GetStage().GetPrimAtPath(path)
        if not prototype:
            losses.add(prim, f"its prototype {path} is not there")
        elif len(placed):
            item = reader.item(prototype, here)
            if item:
                out.append(Copies(item, str(path), placed))
    return out


# ---- translation, rotation and scale, for EXT_mesh_gpu_instancing --------------------------------------------------------


def quaternions(rows: Array) -> Array:
    """(x, y, z, w) of rotations whose rows are images of the axes, w not negative."""
    m = rows.transpose(0, 2, 1)
    trace = m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]
    four = np.stack([1 + 2 * m[:, 0, 0] - trace, 1 + 2 * m[:, 1, 1] - trace, 1 + 2 * m[:, 2, 2] - trace, 1 + trace], axis=1)
    largest = four.argmax(axis=1)
    products = {
        0: np.stack([four[:, 0], m[:, 0, 1] + m[:, 1, 0], m[:, 0, 2] + m[:, 2, 0], m[:, 2, 1] - m[:, 1, 2]], axis=1),
        1: np.stack([m[:, 0, 1] + m[:, 1, 0], four[:, 1], m[:, 1, 2] + m[:, 2, 1], m[:, 0, 2] - m[:, 2, 0]], axis=1),
        2: np.stack([m[:, 0, 2] + m[:, 2, 0], m[:, 1, 2] + m[:, 2, 1], four[:, 2], m[:, 1, 0] - m[:, 0, 1]], axis=1),
        3: np.stack([m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1], four[:, 3]], axis=1),
    }
    q = np.choose(largest[:, None], [products[k] for k in range(4)])
    q /= np.maximum(np.linalg.norm(q, axis=1, keepdims=True), 1e-300)
    return q * np.where(q[:, 3:] < 0, -1.0, 1.0)


def decomposed(matrices: Array) -> tuple[Array, Array, Array] | None:
    """Translations, rotations and scales as float32. None: a matrix shears, or its numbers would not survive."""
    linear = matrices[:, :3, :3]
    scales = np.linalg.norm(linear, axis=2)
    if not (scales > 0).all():
        return None
    scales[:, 0] *= np.where(np.linalg.det(linear) < 0, -1.0, 1.0)
    turns = quaternions(linear / scales[:, :, None])
    if np.abs(rotations(turns) * scales[:, :, None] - linear).max() > 1e-5 * np.abs(scales).max():
        return None
    return matrices[:, 3, :3].astype(np.float32), turns.astype(np.float32), scales.astype(np.float32)
