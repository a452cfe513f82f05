# SPDX-License-Identifier: MIT
"""Which primitives is a UsdGeomMesh? Its faces by material, and of a subdivision surface the whole cage once a material, with the
faces of other materials as holes: so there is no crack between them."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from pxr import UsdGeom

from . import polygons, primvars
from .losses import Losses
from .materials import GONE, Material, uncolored
from .primvars import Topology, Values

Array = np.ndarray[Any, Any]

SCHEMES = {"catmullClark": "catmull-clark", "loop": "loop", "bilinear": "bilinear"}
BOUNDARIES = {"edgeAndCorner": "edge-and-corner", "edgeOnly": "edge-only", "none": "none"}
LINEAR = {"cornersPlus1": "corners-plus-1", "none": "none", "cornersOnly": "corners-only", "cornersPlus2": "corners-plus-2",
          "boundaries": "boundaries", "all": "all"}  # fmt: skip

# A single st that nothing is connected to reads the lower left texel; the margin keeps it off the wrap.
UNCONNECTED = (1e-5, 1e-5)


@dataclasses.dataclass
class Primitive:
    """Arrays of a glTF primitive, and what goes into its extras."""

    positions: Array
    triangles: Array
    texcoords: list[Array]
    colors: Array | None
    material: Material
    cage: dict[str, Any] | None = None
    ngons: bool = False
    normals: Array | None = None


@dataclasses.dataclass
class Faces:
    """A mesh that has been checked."""

    prim: Any
    topology: Topology
    points: Array
    scheme: str
    reverse: bool
    kept: Array | None  # faces of three corners and more that are no holes, but cages know their holes; None: all


def _values(attribute: Any, time: Any, kind: Any) -> Array:
    value = attribute.Get(time)
    return np.zeros(0, kind) if value is None else np.asarray(value, kind)


def _fault(counts: Array, corners: Array, points: Array) -> str | None:
    if counts.size and counts.min() < 0:
        return "a face has fewer than no corners"
    if int(counts.sum()) != len(corners):
        return f"its faces have {int(counts.sum())} corners but faceVertexIndices has {len(corners)}"
    if corners.size and (corners.min() < 0 or corners.max() >= len(points)):
        return f"faceVertexIndices names a point beyond its {len(points)}"
    if not np.isfinite(points).all():
        return "a point is not finite"
    return None


def read_faces(prim: Any, time: Any, losses: Losses) -> Faces | None:
    """None: there is nothing to bake, and a line says why."""
    mesh = UsdGeom.Mesh(prim)
    counts = _values(mesh.GetFaceVertexCountsAttr(), time, np.int64)
    corners = _values(mesh.GetFaceVertexIndicesAttr(), time, np.int64)
    points = _values(mesh.GetPointsAttr(), time, np.float32).reshape(-1, 3)
    fault = _fault(counts, corners, points)
    if not fault and not (counts >= 3).any():
        fault = "it has no faces"
    if fault:
        losses.add(prim, f"not baked, {fault}")
        return None
    scheme = str(mesh.GetSubdivisionSchemeAttr().Get())
    if scheme != "none" and scheme not in SCHEMES:
        losses.add(prim, f"subdivisionScheme '{scheme}' is none that USD has; its polygons are taken as they are")
        scheme = "none"
    solid = counts >= 3
    holes = _values(mesh.GetHoleIndicesAttr(), time, np.int64) if scheme == "none" else ()
    solid[[h for h in holes if 0 <= h < len(counts)]] = False
    kept = None if solid.all() else np.nonzero(solid)[0]
    reverse = mesh.GetOrientationAttr().Get(time) == "leftHanded"
    return Faces(prim, Topology(counts, corners, len(points)), points, scheme, reverse, kept)


def triangles_of(faces: Faces) -> tuple[Array, Array]:
    """Its faces as polygons, whatever its scheme."""
    counts, order = polygons.corner_order(faces.topology, faces.kept, False)
    corners = faces.topology.corners[order]
    return faces.points, corners[polygons.triangles(counts, faces.points[corners])]


# ---- subdivision -------------------------------------------------------------------------------------------------------


def _sharp_edges(mesh: Any, time: Any, faces: Faces) -> list[tuple[int, int, float]]:
    lengths = _values(mesh.GetCreaseLengthsAttr(), time, np.int64)
    chain = _values(mesh.GetCreaseIndicesAttr(), time, np.int64)
    sharpness = _values(mesh.GetCreaseSharpnessesAttr(), time, float)
    if not len(lengths):
        return []
    one_each = len(sharpness) == len(lengths)
    edges = int((lengths - 1).sum())
    if int(lengths.sum()) != len(chain) or not (one_each or len(sharpness) == edges) or (lengths < 2).any():
        raise ValueError("its creases do not fit together")
    values = np.repeat(sharpness, lengths - 1) if one_each else sharpness
    inner = np.ones(len(chain), bool)
    inner[np.cumsum(lengths) - 1] = False
    begin = np.nonzero(inner)[0]
    return [(int(chain[i]), int(chain[i + 1]), float(v)) for i, v in zip(begin, values) if v > 0]


def _sharp_points(mesh: Any, time: Any) -> list[tuple[int, float]]:
    corners = _values(mesh.GetCornerIndicesAttr(), time, np.int64)
    sharpness = _values(mesh.GetCornerSharpnessesAttr(), time, float)
    if len(corners) != len(sharpness):
        raise ValueError("its corners do not fit together")
    return [(int(p), float(v)) for p, v in zip(corners, sharpness) if v > 0]


def _cage(faces: Faces, time: Any, losses: Losses) -> dict[str, Any]:
    """extras.hemibake_subdivision with points of the mesh as vertices, and its own holes."""
    mesh = UsdGeom.Mesh(faces.prim)
    out: dict[str, Any] = {"scheme": SCHEMES[faces.scheme], "level": "auto"}
    out["boundary"] = BOUNDARIES.get(str(mesh.GetInterpolateBoundaryAttr().Get(time)), "edge-and-corner")
    out["faceVarying"] = LINEAR.get(str(mesh.GetFaceVaryingLinearInterpolationAttr().Get(time)), "corners-plus-1")
    if mesh.GetTriangleSubdivisionRuleAttr().Get(time) == "smooth" and faces.scheme == "catmullClark":
        losses.add(faces.prim, "triangleSubdivisionRule 'smooth' is read as catmullClark")
    used = set(np.unique(faces.topology.corners).tolist())
    try:
        creases, corners = _sharp_edges(mesh, time, faces), _sharp_points(mesh, time)
    except ValueError as fault:
        losses.add(faces.prim, f"{fault} and are not read")
        creases, corners = [], []
    out["creases"] = [edge for edge in creases if edge[0] in used and edge[1] in used and edge[0] != edge[1]]
    out["corners"] = [corner for corner in corners if corner[0] in used]
    holes = _values(mesh.GetHoleIndicesAttr(), time, np.int64)
    out["holes"] = sorted({int(h) for h in holes if 0 <= h < len(faces.topology.counts)})
    return out


def _cage_of(faces: Faces, cage: dict[str, Any], vertex_of: Array, others: set[int]) -> dict[str, Any]:
    """The cage in the numbers of a primitive: vertices by a vertex of each point, faces without those that were dropped."""
    out = {**cage}
    out["creases"] = [[int(vertex_of[a]), int(vertex_of[b]), s] for a, b, s in cage["creases"]]
    out["corners"] = [[int(vertex_of[p]), s] for p, s in cage["corners"]]
    holes = sorted(set(cage["holes"]) | others)
    if faces.kept is not None:
        place = {int(face): i for i, face in enumerate(faces.kept)}
        holes = [place[h] for h in holes if h in place]
    out["holes"] = holes
    return {key: value for key, value in out.items() if value not in ([], None)}


def _drawn(faces: Faces, cage: dict[str, Any] | None) -> Array | None:
    """Faces that something is seen of; None: all. Without interpolation of the boundary, faces that touch it only hold up others."""
    if cage is None or not (cage["holes"] or faces.kept is not None or cage["boundary"] == "none"):
        return faces.kept
    shown = np.zeros(len(faces.topology.counts), bool)
    shown[faces.kept if faces.kept is not None else slice(None)] = True
    shown[cage["holes"]] = False
    if cage["boundary"] == "none" and not cage["creases"]:
        on_boundary = np.zeros(faces.topology.point_count, bool)
        on_boundary[_boundary_points(faces.topology)] = True
        first = polygons.starts(faces.topology.counts)[faces.topology.counts > 0]
        shown[faces.topology.counts > 0] &= ~np.logical_or.reduceat(on_boundary[faces.topology.corners], first)
    return np.nonzero(shown)[0]


def _boundary_points(topology: Topology) -> Array:
    """Ends of edges that one face alone has."""
    a, last = topology.corners, polygons.starts(topology.counts) + topology.counts - 1
    following = np.arange(1, len(a) + 1)
    following[last[topology.counts > 0]] = polygons.starts(topology.counts)[topology.counts > 0]
    b = a[following]
    edges, count = np.unique(np.stack([np.minimum(a, b), np.maximum(a, b)], axis=1), axis=0, return_counts=True)
    return np.unique(edges[count == 1])


# ---- attributes --------------------------------------------------------------------------------------------------------


def _attributes(faces: Faces, material: Material, time: Any, losses: Losses) -> tuple[list[Values], Values | None]:
    """What the material reads of the mesh: texture coordinates in its order, and a colour."""
    coordinates = []
    for name in material.coordinates:
        found = primvars.read(faces.prim, name, time, faces.topology, losses) if name else None
        if name and not UsdGeom.PrimvarsAPI(faces.prim).FindPrimvarWithInheritance(name).HasValue():
            losses.add(faces.prim, f"it has no primvars:{name}, by which a picture is looked up; all of it has one texel")
        if found is not None and found.values.shape[1] != 2:
            found = dataclasses.replace(found, values=found.values[:, :2]) if found.values.shape[1] > 2 else None
        coordinates.append(found or Values(np.array([UNCONNECTED], np.float32), None, is_constant=True))
    color = primvars.read(faces.prim, material.color_primvar, time, faces.topology, losses) if material.color_primvar else None
    if color is not None and color.values.shape[1] > 3:
        color = dataclasses.replace(color, values=color.values[:, :3])
    return coordinates, color if color is None or color.values.shape[1] == 3 else None


def _normals(faces: Faces, time: Any, losses: Losses) -> Values | None:
    """Of polygons; primvars:normals goes before normals, and a subdivision surface has its own [UsdGeomMesh]."""
    if faces.scheme != "none":
        return None
    found = primvars.read(faces.prim, "normals", time, faces.topology, losses)
    if found is None:
        found = primvars.read_normals(faces.prim, time, faces.topology, losses)
    if found is None or found.values.shape[1] != 3:
        return None
    lengths = np.linalg.norm(found.values.astype(float), axis=1, keepdims=True)
    if not (lengths > 0).all():
        found = _with_facets(faces, found, lengths[:, 0] > 0)
        lengths = np.maximum(np.linalg.norm(found.values.astype(float), axis=1, keepdims=True), 1e-300)
    return dataclasses.replace(found, values=(found.values / lengths).astype(np.float32))


def _with_facets(faces: Faces, normals: Values, is_there: Array) -> Values:
    """A normal a corner: where one has no length, as modellers leave them at faces without an area, that of the face."""
    corners = faces.topology.corners
    index = np.zeros(len(corners), np.int64) if normals.index is None else normals.index
    facets = polygons.face_normals(faces.topology.counts, faces.points[corners]) * (-1 if faces.reverse else 1)
    facets[~facets.any(axis=1)] = (0, 1, 0)
    out = np.where(is_there[index][:, None], normals.values[index], facets[faces.topology.faces_of_corners()])
    return Values(out, np.arange(len(corners)))


def _take(values: Values, corners: Array) -> Array:
    return np.broadcast_to(values.values[0], (len(corners), values.values.shape[1])) if values.index is None else values.values[values.index[corners]]


def _vertices(points: Array, order: Array, attributes: list[Values]) -> tuple[Array, Array]:
    """A corner of each vertex, and the vertex of each corner in order."""
    corner_points = points[order]
    keys = [polygons.equal_rows(a.values)[a.index[order]] for a in attributes if a.index is not None and not a.per_point]
    return polygons.weld(corner_points, keys)


# ---- primitives --------------------------------------------------------------------------------------------------------


def make_primitive(faces: Faces, part: Array | None, material: Material, time: Any, losses: Losses, cage: dict[str, Any] | None) -> Primitive:
    """part: which faces have the material; None: all."""
    taken = part if cage is None else None
    if taken is None:
        taken = faces.kept
    elif faces.kept is not None:
        taken = np.intersect1d(taken, faces.kept)
    coordinates, color = _attributes(faces, material, time, losses)
    if color is None and material.color_primvar:
        material = uncolored(material)
    normals = _normals(faces, time, losses)
    counts, order = polygons.corner_order(faces.topology, taken, faces.reverse)
    attributes = [*coordinates, *(a for a in (color, normals) if a)]
    first, vertex = _vertices(faces.topology.corners, order, attributes)
    at = order[first]  # a corner of the mesh for each vertex
    with_ngons = cage is not None and faces.scheme != "loop"
    if with_ngons:
        vertex = polygons.tell_apart(counts, vertex)
    cut = polygons.fans(counts) if with_ngons else polygons.triangles(counts, faces.points[faces.topology.corners[order]])
    out = Primitive(faces.points[faces.topology.corners[at]], vertex[cut].astype(np.uint32), [], None, material)
    out.texcoords = [_take(c, at) * np.float32([1, -1]) + np.float32([0, 1]) for c in coordinates]
    out.colors = _take(color, at) if color else None
    out.normals = np.ascontiguousarray(_take(normals, at)) if normals else None
    if cage is not None:
        vertex_of = np.zeros(len(faces.points), np.int64)
        vertex_of[faces.topology.corners[at][::-1]] = np.arange(len(at))[::-1]
        others = set() if part is None else set(range(len(faces.topology.counts))) - set(part.tolist())
        out.cage = _cage_of(faces, cage, vertex_of, others)
        out.ngons = with_ngons
    return out


def primitives(faces: Faces, parts: list[tuple[Array | None, Material]], time: Any, losses: Losses) -> list[Primitive]:
    """One for each material of the mesh."""
    cage = None if faces.scheme == "none" else _cage(faces, time, losses)
    drawn = _drawn(faces, cage)
    if drawn is not None and not len(drawn):
        losses.add(faces.prim, "not baked, every face is a hole or a border that is not drawn")
        return []
    out = []
    for part, material in parts:
        if material.mode == GONE or (part is not None and drawn is not None and not len(np.intersect1d(part, drawn))):
            continue
        out.append(make_primitive(faces, part, material, time, losses, cage))
    return out
