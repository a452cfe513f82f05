# SPDX-License-Identifier: MIT
"""Where does a PointInstancer put copies of what? Ids, orientations, scales and what is invisible, as pxr computes them."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import UsdGeom

from .items import Copies
from .transforms import rotations

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
    if mask and len(mask) != len(which):
        losses.add(prim, "its ids do not fit its copies and hide none")
        mask = None
    shown = np.asarray(mask, bool) if mask else np.ones(len(which), bool)
    shown &= np.isfinite(matrices).all(axis=(1, 2))
    own = prim.GetPath()
    if own in reader.instancers or any(own.HasPrefix(path) for path in targets):
        losses.add(prim, "not baked, it is in a prototype of its own")
        return []
    reader.instancers.append(own)
    try:
        return _copies(reader, prim, here, [(path, matrices[shown & (which == number)]) for number, path in enumerate(targets)])
    finally:
        reader.instancers.pop()


def _copies(reader: Reader, prim: Any, here: Inherited, placed: list[tuple[Any, Array]]) -> list[Copies]:
    out = []
    for path, matrices in placed:
        prototype = prim.GetStage().GetPrimAtPath(path)
        if not prototype or not prototype.IsActive():
            reader.losses.add(prim, f"its prototype {path} is not {'active' if prototype else 'there'}")
        elif len(matrices):
            item = reader.item(prototype, dataclasses.replace(here, is_kept=prototype.IsAbstract() or not prototype.IsDefined()))
            if item:
                out.append(Copies(item, str(path), matrices))
    return out
