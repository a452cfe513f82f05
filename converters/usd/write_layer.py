# SPDX-License-Identifier: MIT
"""How does a pipeline get the bake without a changed file? By a thin layer over the untouched stage, whose variant set `hemibake` has two
choices: `baked` deactivates what was lit and adds the baked stage as a payload, `source` is the stage as it was."""

from __future__ import annotations

import argparse
import os
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

from . import lights
from .baked import Baked
from .losses import Losses
from .reader import UNREAD
from .stage import Source, open_source

SET, BAKED, SOURCE, CHILD = "hemibake", "baked", "source", "HemibakeBaked"
PROXIES = Usd.TraverseInstanceProxies()


def _relative(path: str, place: str) -> str:
    """As an asset path beside the layer: one that does not begin with . is searched for elsewhere."""
    out = os.path.relpath(os.path.abspath(path), os.path.dirname(os.path.abspath(place)) or ".")
    return out if out.startswith(".") else "./" + out


# ---- what was lit ------------------------------------------------------------------------------------------------------


def _root_of_instance(prim: Any) -> Any:
    """The outermost instance that a prim is in; itself if it is in none."""
    while prim.IsInstanceProxy():
        prim = prim.GetParent()
    return prim


def _is_gprim(prim: Any) -> bool:
    return bool(prim.IsA(UsdGeom.Gprim)) or prim.GetTypeName() in UNREAD


def _lit(source: Source, baked: Baked) -> dict[str, Any]:
    """Prims to deactivate, by path: gprims, whole instances, instancers, lights."""
    stage, out = source.stage, {}
    for path in [*baked.paths, *baked.instancers]:
        prim = stage.GetPrimAtPath(path)
        if prim:
            out[str(_root_of_instance(prim).GetPath())] = _root_of_instance(prim)
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), PROXIES):
        if lights.is_light(prim) and not prim.IsA(UsdGeom.Gprim):
            out[str(_root_of_instance(prim).GetPath())] = _root_of_instance(prim)
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), PROXIES):
        if prim.IsA(UsdGeom.PointInstancer) and _is_shown(prim, source.time) and _places_any(prim, out):
            out[str(_root_of_instance(prim).GetPath())] = _root_of_instance(prim)
    inside = [path for path in out if any(str(above) in out for above in Sdf.Path(path).GetParentPath().GetAncestorsRange())]
    for path in inside:
        del out[path]
    return {path: out[path] for path in sorted(out) if not out[path].IsA(UsdGeom.Camera)}


def _places_any(instancer: Any, lit: dict[str, Any]) -> bool:
    """Of copies of copies and of lamps the bake names the prototypes alone."""
    prototypes = UsdGeom.PointInstancer(instancer).GetPrototypesRel().GetForwardedTargets()
    return any(Sdf.Path(path).HasPrefix(prototype) for path in lit for prototype in prototypes)


def _note_lost(lit: dict[str, Any], baked: Baked, losses: Losses) -> None:
    """What goes with an instance or with a prim above it though it was not lit."""
    known = set(baked.paths)
    for prim in lit.values():
        if prim.IsA(UsdGeom.PointInstancer):
            continue
        for below in Usd.PrimRange(prim, PROXIES):
            if below != prim and (_is_gprim(below) or below.IsA(UsdGeom.Camera)) and str(below.GetPath()) not in known:
                losses.add(below, f"not lit, and not in the variant {BAKED} since {prim.GetPath()} is inactive there")


# ---- the layer ---------------------------------------------------------------------------------------------------------


def _copy_metadata(source: Source, layer: Any) -> None:
    """Of the root layer: what sublayers say of themselves does not count for a stage."""
    root, pseudo = source.stage.GetRootLayer().pseudoRoot, layer.pseudoRoot
    for key in ("startTimeCode", "endTimeCode", "timeCodesPerSecond", "framesPerSecond", "kilogramsPerUnit", "colorManagementSystem", "colorConfiguration"):
        if root.HasInfo(key):
            pseudo.SetInfo(key, root.GetInfo(key))
    pseudo.SetInfo("metersPerUnit", source.meters)
    pseudo.SetInfo("upAxis", source.up)


def _variant(layer: Any, path: Any) -> Any:
    """The path of the choice `baked` at a root prim, which is given the set."""
    prim = Sdf.CreatePrimInLayer(layer, path)
    if SET not in prim.variantSets:
        choices = Sdf.VariantSetSpec(prim, SET)
        prim.variantSetNameList.prependedItems = [SET]
        prim.variantSelections[SET] = BAKED
        Sdf.VariantSpec(choices, BAKED)
        Sdf.VariantSpec(choices, SOURCE)
    return path.AppendVariantSelection(SET, BAKED)


def _spec(layer: Any, path: Any) -> Any:
    """Of a prim in the choice `baked`."""
    root = path.GetPrefixes()[0]
    variant = _variant(layer, root)
    return layer.GetPrimAtPath(variant) if path == root else Sdf.CreatePrimInLayer(layer, variant.AppendPath(path.MakeRelativePath(root)))


def _set(spec: Any, name: str, kind: Any, value: Any) -> None:
    Sdf.AttributeSpec(spec, name, kind, Sdf.VariabilityUniform if name == "purpose" else Sdf.VariabilityVarying).default = value


def _deactivate(spec: Any) -> None:
    spec.active = False


def _hide(spec: Any) -> None:
    _set(spec, "visibility", Sdf.ValueTypeNames.Token, UsdGeom.Tokens.invisible)


def _make_guide(spec: Any) -> None:
    _set(spec, "purpose", Sdf.ValueTypeNames.Token, UsdGeom.Tokens.guide)


def _is_shown(prim: Any, time: Any) -> bool:
    if not prim or not prim.IsActive():
        return False
    imageable = UsdGeom.Imageable(prim)
    if not imageable:
        return True
    is_guide = prim.IsA(UsdGeom.Gprim) and imageable.ComputePurpose() == UsdGeom.Tokens.guide
    return not is_guide and imageable.ComputeVisibility(time) != UsdGeom.Tokens.invisible


def _composed(layer: Any, source: Source) -> Any:
    """As it will be where it will lie."""
    here = Sdf.Layer.CreateAnonymous()
    here.TransferContent(layer)
    here.subLayerPaths = [source.stage.GetRootLayer().identifier]
    return Usd.Stage.Open(here)


def _put_aside(layer: Any, lit: list[Any], source: Source, losses: Losses) -> None:
    """A choice of a variant is weaker than what the stage itself says of a prim; of what says that it is active, the visibility is
    tried, and then the purpose. At a root, whose own choice it is, those come first: what is inactive is hard to find and to switch."""
    ways = {True: (_hide, _make_guide, _deactivate), False: (_deactivate, _hide, _make_guide)}
    left = lit
    for attempt in range(3):
        for path in left:
            ways[path.IsRootPrimPath()][attempt](_spec(layer, path))
        composed = _composed(layer, source)
        left = [path for path in left if _is_shown(composed.GetPrimAtPath(path), source.time)]
    for path in left:
        losses.add(path, f"stands beside the bake in the variant {BAKED}: the stage says itself that it is active and seen")


def _is_moving(prim: Any) -> bool:
    while prim and not prim.IsPseudoRoot():
        if prim.IsA(UsdGeom.Xformable) and UsdGeom.Xformable(prim).TransformMightBeTimeVarying():
            return True
        prim = prim.GetParent()
    return False


def _placement(source: Source, parent: Any) -> tuple[list[tuple[str, Any, Any]], bool]:
    """Operations that lead from metres and y up to below the parent; True: the stack above is reset."""
    meters = 1 / source.meters
    ops: list[tuple[str, Any, Any]] = []
    if source.up == "Z":
        ops.append(("xformOp:rotateX", Sdf.ValueTypeNames.Float, 90.0))
    if meters != 1:
        ops.append(("xformOp:scale", Sdf.ValueTypeNames.Float3, Gf.Vec3f(meters)))
    world = np.eye(4)
    if parent and parent.IsA(UsdGeom.Imageable):
        world = np.array(UsdGeom.Imageable(parent).ComputeLocalToWorldTransform(source.time))
    if np.allclose(world, np.eye(4), atol=1e-12):
        return ops, _is_moving(parent) if parent else False
    if _is_moving(parent) or abs(np.linalg.det(world)) < 1e-12:
        return ops, True
    matrix = np.linalg.inv(source.root_matrix()) @ np.linalg.inv(world)
    return [("xformOp:transform", Sdf.ValueTypeNames.Matrix4d, Gf.Matrix4d(*matrix.ravel().tolist()))], False


def _add_payload(layer: Any, source: Source, path: Any, parent: Any, payload: str) -> None:
    prim = Sdf.CreatePrimInLayer(layer, path)
    prim.specifier, prim.typeName = Sdf.SpecifierDef, "Xform"
    prim.payloadList.prependedItems = [Sdf.Payload(payload)]
    ops, resets = _placement(source, parent)
    for name, kind, value in ops:
        Sdf.AttributeSpec(prim, name, kind).default = value
    if ops or resets:
        order = Sdf.AttributeSpec(prim, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform)
        order.default = (["!resetXformStack!"] if resets else []) + [name for name, _, _ in ops]


def _parent(stage: Any, lit: dict[str, Any]) -> Any:
    """The default prim, if something can stand below it; else None: the baked stage stands at the root."""
    prim = stage.GetDefaultPrim()
    if not prim or str(prim.GetPath()) in lit or prim.IsInstance() or not prim.IsDefined() or prim.IsA(UsdGeom.Gprim):
        return None
    # A part of a component, not a model of its own, may stand anywhere below it.
    return None if prim.IsA(UsdShade.Material) or prim.GetChild(CHILD) else prim


def write_layer(baked: Baked, o: argparse.Namespace) -> list[str]:
    """Writes o.layer, which will lie at o.place; lines of what is lost by it."""
    source = open_source(o.stage, o.variant, o.time_code)
    losses = Losses()
    layer = Sdf.Layer.CreateNew(o.layer)
    layer.subLayerPaths = [_relative(o.stage, o.place)]
    _copy_metadata(source, layer)
    lit = _lit(source, baked)
    _note_lost(lit, baked, losses)
    _put_aside(layer, [Sdf.Path(path) for path in lit], source, losses)
    parent, payload = _parent(source.stage, lit), _relative(o.payload, o.place)
    above = parent.GetPath() if parent else Sdf.Path(f"/{CHILD}")
    variant = _variant(layer, above)
    if parent:
        _add_payload(layer, source, variant.AppendChild(CHILD), parent, payload)
    else:
        _add_payload(layer, source, variant, None, payload)
        layer.GetPrimAtPath(above).specifier = Sdf.SpecifierDef
        layer.GetPrimAtPath(above).typeName = "Xform"
    default = source.stage.GetDefaultPrim()
    layer.defaultPrim = default.GetName() if default else above.name
    roots = sorted({str(Sdf.Path(path).GetPrefixes()[0]) for path in lit} | {str(above)})
    if len(roots) > 1:
        losses.add(source.stage.GetRootLayer().GetDisplayName(), f"has lit prims at {len(roots)} roots; each has the variant set: {', '.join(roots)[:200]}")
    if o.variant:
        losses.add(source.stage.GetRootLayer().GetDisplayName(), f"was baked with --variant {o.variant}, which the variant {SOURCE} does not choose")
    layer.Save()
    return losses.lines()
