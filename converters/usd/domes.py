# SPDX-License-Identifier: MIT
"""What sky do the dome lights of a stage make together? One panorama of the program's: y up, direction (x, y, z) at column
1/2 + atan2(z, x) / 2 pi, row 0 at the zenith."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from pxr import UsdGeom

from . import pictures
from .lights import Light
from .losses import Losses
from .textures import RAW_SPACES, read_bytes

Array = np.ndarray[Any, Any]

# Pixels of the sky; a picture that is larger is averaged down to this.
WIDTH, HEIGHT = 1024, 512


@dataclasses.dataclass
class Dome:
    light: Light
    world: Array  # rows are images of the axes, in the bake's frame
    pole: str


def _picture(light: Light, time: Any, losses: Losses) -> tuple[Array | None, str]:
    prim = light.prim
    asset, layout = prim.GetAttribute("inputs:texture:file"), prim.GetAttribute("inputs:texture:format")
    named = asset.Get(time) if asset else None
    if not named or not named.path:
        return None, "latlong"
    data = read_bytes(str(named.resolvedPath)) if named.resolvedPath else None
    space = str(asset.GetColorSpace()) if asset.HasColorSpace() else ""
    try:
        if not data:
            raise pictures.Unreadable("it is not there")
        picture = pictures.read(data, str(named.resolvedPath), space in RAW_SPACES or space.startswith("lin") or None)
        if not np.isfinite(picture).all():
            raise pictures.Unreadable("it has pixels that are not finite")
    except pictures.Unreadable as why:
        losses.add(prim, f"texture {named.path}: {why}; the dome has its colour alone")
        return None, "latlong"
    return np.maximum(picture, 0), str(layout.Get(time) if layout else "automatic")


# ---- directions --------------------------------------------------------------------------------------------------------


def sky_directions(width: int, height: int) -> Array:
    azimuth = 2 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    altitude = np.pi * (0.5 - (np.arange(height) + 0.5) / height)
    a, h = np.meshgrid(azimuth, altitude)
    return np.stack([np.cos(h) * np.cos(a), np.sin(h), np.cos(h) * np.sin(a)], axis=-1)


def pole_frame(pole: str, up: str) -> Array:
    """Rows: where longitude 0, longitude 90 degrees and the pole are, in the dome's own frame. Longitude 0 is the picture's centre, and
    it grows to the left, so the left edge is 180 degrees."""
    axis = {"scene": up}.get(pole, pole)
    if axis == "Z":
        return np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], float)
    return np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float)


def _places(local: Array, layout: str, frame: Array) -> tuple[Array, Array]:
    """Where the picture is looked up, 0..1 from left and top."""
    zero, quarter, pole = (local @ axis for axis in frame)
    if layout == "mirroredBall":
        m = 2 * np.sqrt(np.maximum((1 + zero) / 2, 1e-12)) * 2
        return 0.5 - quarter / m, 0.5 - pole / m
    if layout == "angular":
        radius = np.arccos(np.clip(zero, -1, 1)) / np.pi / np.maximum(np.hypot(quarter, pole), 1e-12) / 2
        return 0.5 - quarter * radius, 0.5 - pole * radius
    longitude, latitude = np.arctan2(quarter, zero), np.arcsin(np.clip(pole, -1, 1))
    return 0.5 - longitude / (2 * np.pi), 0.5 - latitude / np.pi


def _shrunk(picture: Array) -> Array:
    """Whole blocks of pixels as their mean, so that a small sun keeps its power."""
    step = max(picture.shape[1] // WIDTH, picture.shape[0] // HEIGHT, 1)
    rows, columns = picture.shape[0] // step * step, picture.shape[1] // step * step
    return picture[:rows, :columns].reshape(rows // step, step, columns // step, step, 3).mean(axis=(1, 3))


def _look_up(picture: Array, x: Array, y: Array) -> Array:
    column = np.floor(x * picture.shape[1]).astype(int) % picture.shape[1]
    row = np.clip(np.floor(y * picture.shape[0]).astype(int), 0, picture.shape[0] - 1)
    return picture[row, column]


# ---- the sky -----------------------------------------------------------------------------------------------------------


def _of(dome: Dome, picture: Array, layout: str, up: str) -> Array:
    """A panorama through the dome's rotation; each pixel is the mean of four looks, so that edges fall where they are."""
    if layout not in ("automatic", "latlong", "mirroredBall", "angular"):
        dome_layout = "latlong"
    else:
        dome_layout = "latlong" if layout == "automatic" else layout
    rows = dome.world[:3, :3] / np.maximum(np.linalg.norm(dome.world[:3, :3], axis=1, keepdims=True), 1e-300)
    fine = sky_directions(2 * WIDTH, 2 * HEIGHT) @ rows.T
    seen = _look_up(_shrunk(picture), *_places(fine, dome_layout, pole_frame(dome.pole, up)))
    return seen.reshape(HEIGHT, 2, WIDTH, 2, 3).mean(axis=(1, 3))


def sky(domes: list[Dome], up: str, time: Any, losses: Losses) -> Array | None:
    """None: no dome. One pixel where no dome has a picture."""
    total: Array | None = None
    for dome in domes:
        picture, layout = _picture(dome.light, time, losses)
        if layout == "cubeMapVerticalCross":
            losses.add(dome.light.prim, "texture:format cubeMapVerticalCross is not read; the dome has its colour alone")
            picture = None
        radiance = np.array(dome.light.radiance)
        own = radiance[None, None] if picture is None else radiance * _of(dome, picture, layout, up)
        total = own if total is None else total + own
    return total


def pole_of(prim: Any, time: Any) -> str:
    """DomeLight stands on y whatever the stage's up axis is; DomeLight_1 says."""
    axis = prim.GetAttribute("poleAxis")
    return str(axis.Get(time) or "scene") if prim.GetTypeName() == "DomeLight_1" and axis else "Y"


def up_of(stage: Any) -> str:
    return str(UsdGeom.GetStageUpAxis(stage))
