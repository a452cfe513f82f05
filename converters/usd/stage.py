# SPDX-License-Identifier: MIT
"""Which stage is baked, at which time, with which variants, in which units, and what does it depend on?"""

from __future__ import annotations

import dataclasses
import math
import os
import re
import tempfile
from typing import Any

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom, UsdUtils

from .confine import confine
from .confine import files as confined_files
from .losses import Losses, Refused, one_line

VARIANT = re.compile(r"(/[^{}]*)\{([^={}]+)=([^={}]*)\}")


@dataclasses.dataclass
class Source:
    """An open stage and how it is looked at."""

    stage: Any
    path: str
    time: Any  # a Usd.TimeCode
    meters: float
    up: str  # "Y" or "Z"
    losses: Losses
    variants: str = ""

    def root_matrix(self) -> np.ndarray[Any, Any]:
        """From the stage's units and up axis to metres and y up, rows as images of the axes."""
        out = np.diag([self.meters, self.meters, self.meters, 1.0])
        if self.up == "Z":
            out[:3, :3] = self.meters * np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
        return out


def first_sentence(error: Any, path: str) -> str:
    """What pxr says, in one line and without where in its own source."""
    parts = [one_line(getattr(e, "commentary", "") or e) for e in getattr(error, "args", [])]
    text = next((part for part in parts if part), "it cannot be opened")
    text = re.sub(r"^\s*Error in '[^']*' at line \d+ in file [^:]*: '?", "", text)
    text = text.replace(f"{path}:", "line ", 1) if text.startswith(f"{path}:") else text
    return re.sub(r"\s*\(instantiating stage.*?\)\s*$", "", text)


# ---- variants ----------------------------------------------------------------------------------------------------------


def parse_variants(text: str) -> list[tuple[str, str, str]]:
    """"/A{look=red},/B{size=big}" as (prim, set, choice)."""
    out = []
    for part in filter(None, (p.strip() for p in re.split(r"(?<=\})\s*[,;]\s*", text))):
        found = VARIANT.fullmatch(part)
        if not found:
            raise Refused(f"--variant: '{part}' is not /Prim{{set=choice}}")
        out.append((found[1], found[2].strip(), found[3].strip()))
    return out


def select_variants(stage: Any, text: str) -> None:
    """In the session layer: the files stay as they are."""
    stage.SetEditTarget(stage.GetSessionLayer())
    for path, name, choice in parse_variants(text):
        prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
        if not prim:
            raise Refused(f"--variant: there is no prim {path}")
        sets = prim.GetVariantSets()
        if name not in sets.GetNames():
            raise Refused(f"--variant: {path} has no variant set '{name}'; it has {', '.join(sets.GetNames()) or 'none'}")
        choices = sets.GetVariantSet(name).GetVariantNames()
        if choice not in choices:
            raise Refused(f"--variant: {path}{{{name}}} has no choice '{choice}'; it has {', '.join(choices) or 'none'}")
        sets.SetSelection(name, choice)
    stage.SetEditTarget(stage.GetRootLayer())


# ---- time --------------------------------------------------------------------------------------------------------------


def earliest_sample(stage: Any) -> float | None:
    samples = [times[0] for times in (layer.ListAllTimeSamples() for layer in stage.GetUsedLayers()) if times]
    return min(samples) if samples else None


def time_of(stage: Any, asked: float | None) -> Any:
    """What was asked for, else where the stage begins, else its first sample. Never Default, at which attributes that have only
    samples have no value."""
    if asked is not None:
        return Usd.TimeCode(asked)
    if stage.HasAuthoredTimeCodeRange() or stage.GetRootLayer().HasStartTimeCode():
        return Usd.TimeCode(stage.GetStartTimeCode())
    earliest = earliest_sample(stage)
    return Usd.TimeCode(earliest) if earliest is not None else Usd.TimeCode.EarliestTime()


# ---- units -------------------------------------------------------------------------------------------------------------


def up_axis(stage: Any, losses: Losses) -> str:
    layer = stage.GetRootLayer()
    authored = layer.pseudoRoot.GetInfo("upAxis") if layer.pseudoRoot.HasInfo("upAxis") else None
    if authored is not None and authored not in ("Y", "Z"):
        losses.add(layer.GetDisplayName(), f"its up axis '{authored}' is none that USD has; y is taken")
        return "Y"
    return str(UsdGeom.GetStageUpAxis(stage))


def meters_per_unit(stage: Any, losses: Losses) -> float:
    """Of the root layer: composition converts nothing, so a layer that differs is what somebody else has to know."""
    meters = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not (math.isfinite(meters) and meters > 0):
        losses.add(stage.GetRootLayer().GetDisplayName(), f"metersPerUnit {meters:g} is no length; 0.01 is taken")
        meters = 0.01
    own = {stage.GetRootLayer().identifier, stage.GetSessionLayer().identifier}
    for layer in stage.GetUsedLayers():
        root = layer.pseudoRoot
        if layer.identifier in own or not root.HasInfo("metersPerUnit"):
            continue
        other = root.GetInfo("metersPerUnit")
        if not math.isclose(other, meters, rel_tol=1e-6):
            losses.add(layer.GetDisplayName(), f"metersPerUnit {other:g} is not the stage's {meters:g}; USD converts nothing, so neither does the bake")
    return meters


# ---- opening -----------------------------------------------------------------------------------------------------------


FORMATS = ((b"#usda", "usda"), (b"PXR-USDC", "usdc"), (b"PK\3\4", "usdz"))


def open_stage(path: str) -> Any:
    """By its extension; where that says nothing, by its first bytes, under another name."""
    return Usd.Stage.Open(_name_for_pxr(path))


_links: dict[str, str] = {}  # of this process, by the path they lead to


def _name_for_pxr(path: str) -> str:
    """The path, or a link of an extension that pxr knows; remove_links, when all of the stage has been read."""
    if os.path.splitext(path)[1].lower() in (".usd", ".usda", ".usdc", ".usdz"):
        return path
    if path not in _links:
        with open(path, "rb") as f:
            head = f.read(8)
        kind = next((name for magic, name in FORMATS if head.startswith(magic)), None)
        if kind is None:
            raise Refused("it is no USD")
        _links[path] = _linked(path, kind)
    return _links[path]


def _linked(path: str, kind: str) -> str:
    """References are found from where the file is, so the link lies beside it; a package has all in it."""
    folder = tempfile.gettempdir() if kind == "usdz" else os.path.dirname(os.path.abspath(path))
    link = os.path.join(folder, f".{os.path.basename(path)}-{os.getpid()}.{kind}")
    try:
        os.symlink(os.path.abspath(path), link)
    except OSError as fault:
        raise Refused(f"pxr knows a stage by its name alone; call it .{kind}") from fault
    return link


def remove_links() -> None:
    while _links:
        os.unlink(_links.popitem()[1])


def _note_composition(stage: Any, losses: Losses) -> None:
    for error in stage.GetCompositionErrors():
        site = getattr(error, "rootSite", None)
        path = getattr(site, "path", "/") if site else "/"
        losses.add_uncomposed(path, str(error))


def open_source(path: str, variants: str = "", time: float | None = None, root: str | None = None) -> Source:
    losses = Losses()
    if not os.path.exists(path):
        raise Refused("no such file")
    try:
        if root:
            confine(path, root, _name_for_pxr(path))
        stage = open_stage(path)
        if variants:
            select_variants(stage, variants)
        # Layers of payloads that a variant brings are there by now.
        code = time_of(stage, time)
        meters, up = meters_per_unit(stage, losses), up_axis(stage, losses)
    except Tf.ErrorException as error:
        raise Refused(first_sentence(error, path)) from error
    except RuntimeError as error:
        raise Refused(one_line(error)) from error
    _note_composition(stage, losses)
    return Source(stage, path, code, meters, up, losses, variants)


def dependencies(path: str) -> list[str]:
    """Every layer and texture that the stage names, as files that are there."""
    confined = confined_files()
    if confined is not None:
        return confined
    try:
        opened = _name_for_pxr(path)
        layers, assets, _missing = UsdUtils.ComputeAllDependencies(Sdf.AssetPath(opened))
    except (Tf.ErrorException, RuntimeError):
        return []
    named = [layer.realPath for layer in layers] + [str(asset) for asset in assets]
    files = {os.path.abspath(re.sub(r"\[.*\]$", "", name)) for name in named if name}
    return sorted(os.path.abspath(path) if file == os.path.abspath(opened) else file for file in files)
