# SPDX-License-Identifier: MIT
"""How does a bake become a stage of its own? Plain meshes with the light in primvars:displayColor, which their material shows as
emission, and the radiance itself beside it."""

from __future__ import annotations

import os
import re
import struct
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdShade, UsdUtils, Vt

from .baked import Baked, Piece
from .losses import Refused

ROOT = "Baked"
LINEAR = "lin_rec709_scene"
RADIANCE = "hemibake:radiance"


def _names(baked: Baked) -> list[str]:
    """A path below the root for each piece, like that of its prim, and with a number where that is taken: by another piece of the same
    prim, or by a prim that this one would lie below, since no mesh may lie below a mesh."""
    meshes: set[str] = set()
    groups: set[str] = set()
    out = []
    for piece in baked.pieces:
        parts = [Tf.MakeValidIdentifier(part) for part in piece.path.split("/") if part] or ["mesh"]
        for k in range(len(parts)):
            own, number = parts[k], 0
            is_mesh = k + 1 == len(parts)
            while "/".join(parts[: k + 1]) in meshes or (is_mesh and "/".join(parts[: k + 1]) in groups):
                number += 1
                parts[k] = f"{own}_{number}"
        name = "/".join(parts)
        meshes.add(name)
        groups.update("/".join(parts[:k]) for k in range(1, len(parts)))
        out.append(name)
    return out


# ---- material ----------------------------------------------------------------------------------------------------------


def _shader(stage: Any, path: Any, kind: str) -> Any:
    out = UsdShade.Shader.Define(stage, path)
    out.CreateIdAttr(kind)
    return out


def _light_material(stage: Any, path: Any, opacity: float) -> Any:
    """Shows displayColor and nothing else, whatever light there is; of glass as a share before what is behind it."""
    material = UsdShade.Material.Define(stage, path)
    reader = _shader(stage, path.AppendChild("DisplayColor"), "UsdPrimvarReader_float3")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("displayColor")
    reader.CreateOutput("result", Sdf.ValueTypeNames.Float3)
    surface = _shader(stage, path.AppendChild("Surface"), "UsdPreviewSurface")
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0))
    surface.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(1.0)
    surface.CreateInput("useSpecularWorkflow", Sdf.ValueTypeNames.Int).Set(1)
    surface.CreateInput("specularColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0))
    if opacity < 1:
        surface.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(opacity)
    surface.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).ConnectToSource(reader.ConnectableAPI(), "result")
    surface.CreateOutput("surface", Sdf.ValueTypeNames.Token)
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    return material


def _plain_material(stage: Any, path: Any, piece: Piece) -> Any:
    """Of what was not baked."""
    material = UsdShade.Material.Define(stage, path)
    surface = _shader(stage, path.AppendChild("Surface"), "UsdPreviewSurface")
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*(float(c) for c in piece.colors[0])))
    surface.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(piece.opacity)
    surface.CreateOutput("surface", Sdf.ValueTypeNames.Token)
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    return material


# ---- meshes ------------------------------------------------------------------------------------------------------------


def _write_mesh(stage: Any, path: Any, piece: Piece) -> Any:
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(piece.positions))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(piece.triangles), 3, np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(piece.triangles.ravel(), np.int32)))
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateDoubleSidedAttr(piece.double_sided)
    low, high = (Gf.Vec3f(*(float(v) for v in bound)) for bound in (piece.positions.min(axis=0), piece.positions.max(axis=0)))
    mesh.CreateExtentAttr(Vt.Vec3fArray([low, high]))
    primvars = UsdGeom.PrimvarsAPI(mesh)
    color = primvars.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, UsdGeom.Tokens.vertex)
    color.Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(piece.colors)))
    if piece.opacity < 1:
        primvars.CreatePrimvar("displayOpacity", Sdf.ValueTypeNames.FloatArray, UsdGeom.Tokens.constant).Set([piece.opacity])
    if piece.radiance is not None:
        radiance = primvars.CreatePrimvar(RADIANCE, Sdf.ValueTypeNames.Color3fArray, UsdGeom.Tokens.vertex)
        radiance.Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(piece.radiance)))
    mesh.GetPrim().SetCustomDataByKey("hemibake:path", piece.path)
    return mesh


def _define_parents(stage: Any, path: Any) -> None:
    for parent in reversed([p for p in path.GetAncestorsRange()][1:]):
        if parent != Sdf.Path.absoluteRootPath and not stage.GetPrimAtPath(parent):
            UsdGeom.Xform.Define(stage, parent)


def _stamp(stage: Any, baked: Baked) -> None:
    """What was asked for and what came of it, as the program stamps every output; no place and no time."""
    stamp = baked.stamp
    data = {"version": str(stamp.get("version", "")), "report_sha256": str(stamp.get("report_sha256", ""))}
    given = {re.sub(r"\W", "_", key): value if isinstance(value, bool) else str(value) for key, value in sorted(stamp.get("options", {}).items())}
    layer = stage.GetRootLayer()
    layer.customLayerData = {"hemibake": {**data, "options": given}}


def _fill(stage: Any, baked: Baked) -> None:
    root = UsdGeom.Xform.Define(stage, f"/{ROOT}")
    stage.SetDefaultPrim(root.GetPrim())
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    if hasattr(Usd, "ColorSpaceAPI"):
        Usd.ColorSpaceAPI.Apply(root.GetPrim()).CreateColorSpaceNameAttr(LINEAR)
    looks = root.GetPath().AppendChild("HemibakeLooks")
    UsdGeom.Scope.Define(stage, looks)
    shown: dict[float, Any] = {}
    for number, (name, piece) in enumerate(zip(_names(baked), baked.pieces)):
        if not len(piece.triangles):
            continue
        path = root.GetPath().AppendPath(name)
        _define_parents(stage, path)
        mesh = _write_mesh(stage, path, piece)
        if piece.radiance is not None and piece.opacity not in shown:
            name = "Light" if piece.opacity >= 1 else f"Glass_{number}"
            shown[piece.opacity] = _light_material(stage, looks.AppendChild(name), piece.opacity)
        material = shown[piece.opacity] if piece.radiance is not None else _plain_material(stage, looks.AppendChild(f"Plain_{number}"), piece)
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    _stamp(stage, baked)


# ---- files -------------------------------------------------------------------------------------------------------------


def write_stage(baked: Baked, path: str, name: str) -> None:
    """path: .usda, .usdc, .usd or .usdz; name: how the file will be called, after which a package calls what is in it."""
    if not any(len(piece.triangles) for piece in baked.pieces):
        raise Refused("nothing is left to write")
    packaged = path.endswith(".usdz")
    inner = os.path.join(os.path.dirname(path), Tf.MakeValidIdentifier(os.path.splitext(name)[0]) + ".usdc") if packaged else path
    stage = Usd.Stage.CreateNew(inner)
    _fill(stage, baked)
    stage.GetRootLayer().Save()
    del stage
    if not packaged:
        return
    try:
        if not UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(inner), path):
            raise Refused("the package cannot be written")
    finally:
        os.unlink(inner)
    _without_times(path)


def _without_times(path: str) -> None:
    """A package says when its files were written; the same bake is the same bytes whenever it is made."""
    with open(path, "r+b") as f:
        data = bytearray(f.read())
        end = data.rfind(b"PK\5\6")
        count, at = struct.unpack_from("<H", data, end + 10)[0], struct.unpack_from("<I", data, end + 16)[0]
        for _ in range(count):
            name, extra, comment = struct.unpack_from("<3H", data, at + 28)
            (local,) = struct.unpack_from("<I", data, at + 42)
            # The first day that a zip can name.
            data[at + 12 : at + 16] = data[local + 10 : local + 14] = struct.pack("<2H", 0, 0x21)
            at += 46 + name + extra + comment
        f.seek(0)
        f.write(data)
