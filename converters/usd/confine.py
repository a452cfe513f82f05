# SPDX-License-Identifier: MIT
"""Does all that a stage names lie in one folder? Layers are opened one by one, each after its place has been looked at, links followed;
composition then finds them open and opens no other."""

from __future__ import annotations

import os
import re

from pxr import Ar, Sdf

from .losses import Refused

_root: list[str] = []  # of this process: the folder, resolved; none: any folder will do
_seen: list[str] = []  # files that were allowed


def file_of(resolved: str) -> str:
    """A package, of what is inside it."""
    return str(Ar.SplitPackageRelativePathOuter(resolved)[0]) if Ar.IsPackageRelativePath(resolved) else resolved


def allows(resolved: str) -> bool:
    if not _root:
        return True
    real = os.path.realpath(file_of(resolved))
    inside = os.path.commonpath([real, _root[0]]) == _root[0] and os.path.isfile(real)
    if inside:
        _seen.append(real)
    return inside


def files() -> list[str] | None:
    """What was allowed so far; None: nothing is confined, so nobody has looked."""
    return sorted(set(_seen)) if _root else None


def _clips(layer: Sdf.Layer) -> str | None:
    """The first prim with value clips, whose layers no list of the layer's names."""
    found: list[str] = []

    def look(path: Sdf.Path) -> None:
        spec = layer.GetPrimAtPath(path) if path.IsPrimPath() or path.IsPrimVariantSelectionPath() else None
        if spec and spec.HasInfo("clips"):
            found.append(str(path))

    layer.Traverse(Sdf.Path.absoluteRootPath, look)
    return found[0] if found else None


def _named(layer: Sdf.Layer) -> list[str]:
    """Where the layers that a layer names are."""
    clips = _clips(layer)
    if clips:
        raise Refused(f"{layer.GetDisplayName()}: {clips} has value clips, which --root cannot hold; flatten the stage")
    out = []
    for name in layer.GetCompositionAssetDependencies():
        if re.match(r"\s*`", name):
            raise Refused(f"{layer.GetDisplayName()}: {name} is an expression, which --root cannot hold; flatten the stage")
        resolved = str(Ar.GetResolver().Resolve(layer.ComputeAbsolutePath(name)))
        if not resolved:
            continue
        if not allows(resolved):
            raise Refused(f"{layer.GetDisplayName()}: {name}: it lies outside of the folder that --root allows")
        out.append(resolved)
    return out


def confine(path: str, root: str, opened: str) -> None:
    """From here on nothing outside of root is read. opened: the path as pxr is to be told it."""
    _root[:] = [os.path.realpath(root)]
    if not allows(path):
        raise Refused("it lies outside of the folder that --root allows")
    waiting, looked_at = [os.path.abspath(opened)], set()
    while waiting:
        name = waiting.pop()
        if name in looked_at:
            continue
        looked_at.add(name)
        layer = Sdf.Layer.FindOrOpen(name)
        if layer:
            _open.append(layer)
            waiting += _named(layer)


_open: list[Sdf.Layer] = []  # held, so that they are not opened again from what may have become another file
