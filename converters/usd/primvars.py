# SPDX-License-Identifier: MIT
"""Which value does each corner of each face of a mesh have? Primvars of any interpolation, indexed or not, as an array of values
and a number a corner."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from pxr import UsdGeom

from .losses import Losses

Array = np.ndarray[Any, Any]


@dataclasses.dataclass
class Topology:
    """Faces of a mesh whose counts and indices have been checked."""

    counts: Array  # corners of each face
    corners: Array  # points of all faces, one after the other
    point_count: int

    def faces_of_corners(self) -> Array:
        return np.repeat(np.arange(len(self.counts)), self.counts)


@dataclasses.dataclass
class Values:
    """values[index[corner]]; is_constant: one value for all; per_point: index is the corner's point."""

    values: Array
    index: Array | None
    is_constant: bool = False
    per_point: bool = False


def by_corner(values: Array, interpolation: str, topology: Topology) -> Values | None:
    """None: there are too few values for the mesh."""
    if interpolation == "constant" or len(values) == 1:
        return Values(values[:1], None, is_constant=True) if len(values) else None
    if interpolation in ("vertex", "varying"):
        return Values(values, topology.corners, per_point=True) if len(values) >= topology.point_count else None
    if interpolation == "uniform":
        return Values(values, topology.faces_of_corners()) if len(values) >= len(topology.counts) else None
    return Values(values, np.arange(len(topology.corners))) if len(values) >= len(topology.corners) else None


def flatten(primvar: Any, time: Any) -> Array | None:
    """The values with their indices applied; None: none, or an index is out of range."""
    values = primvar.Get(time)
    if values is None:
        return None
    # One value that is no array, whatever the schema says: of a number, or of a colour.
    is_one = not hasattr(values, "__len__") or type(values).__module__.endswith("Gf")
    values = np.asarray(values, np.float32)
    values = values.reshape((1, -1) if values.ndim else 1) if is_one else values
    if len(values) and primvar.IsIndexed():
        indices = np.asarray(primvar.GetIndices(time))
        if len(indices) and (indices.min() < 0 or indices.max() >= len(values)):
            return None
        values = values[indices]
    return values


def read_normals(prim: Any, time: Any, topology: Topology, losses: Losses) -> Values | None:
    """The attribute normals, which is older than primvars and is none."""
    mesh = UsdGeom.Mesh(prim)
    values = mesh.GetNormalsAttr().Get(time)
    if values is None or not len(values):
        return None
    array = np.asarray(values, np.float32)
    out = by_corner(array, str(mesh.GetNormalsInterpolation()), topology) if np.isfinite(array).all() else None
    if out is None:
        losses.add(prim, f"its normals are not read, {len(array)} are too few for their interpolation '{mesh.GetNormalsInterpolation()}', or not finite")
    return out


def read(prim: Any, name: str, time: Any, topology: Topology, losses: Losses) -> Values | None:
    """The primvar of that name at the prim or, if constant, above it."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    if not primvar or not primvar.HasValue():
        return None
    values = flatten(primvar, time)
    if values is None or values.ndim != 2 or not np.isfinite(values).all():
        losses.add(prim, f"primvars:{name} is not read, it has indices out of range or numbers that are not finite")
        return None
    out = by_corner(values, str(primvar.GetInterpolation()), topology)
    if out is None and len(values):
        losses.add(prim, f"primvars:{name} is not read, {len(values)} values are too few for its interpolation '{primvar.GetInterpolation()}'")
    return out
