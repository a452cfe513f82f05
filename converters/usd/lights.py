# SPDX-License-Identifier: MIT
"""How much light does a UsdLux light give, from where? L = intensity 2^exposure color blackbody / size in nits, the schema's own
equation; lamps with an area become surfaces that emit, the others lights of KHR_lights_punctual."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from pxr import Gf, UsdLux

from . import shapes
from .losses import Losses
from .shading import linear_rec709
from .shaping import Shape
from .surfaces import Color

AREAS = ("RectLight", "DiskLight", "SphereLight", "CylinderLight")
DOMES = ("DomeLight", "DomeLight_1")

# The program's discs end before a right angle.
WIDEST = math.radians(89.0)


@dataclasses.dataclass
class Light:
    """What does not depend on where the lamp stands. radiance: before normalize."""

    kind: str
    radiance: Color
    normalize: bool
    size: tuple[float, float] = (0.0, 0.0)  # width and height; radius; radius and length
    angle: float = 0.0  # of a distant light, radians
    shape: Shape | None = None
    is_point: bool = False
    prim: Any = None

    def body(self) -> shapes.Triangles:
        a, b = self.size
        if self.kind == "RectLight":
            return shapes.rectangle(a, b)
        if self.kind == "DiskLight":
            return shapes.disk(a)
        return shapes.ball(a) if self.kind == "SphereLight" else shapes.tube(a, b)

    def world_area(self, matrix: Any) -> float:
        """In the units that matrix leads to, its scales included."""
        return shapes.area(self.body(), matrix)


def is_light(prim: Any) -> bool:
    return bool(prim.HasAPI(UsdLux.LightAPI))


def _number(attribute: Any, time: Any, fallback: float) -> float:
    value = attribute.Get(time) if attribute else None
    return fallback if value is None or not math.isfinite(value) else float(value)


def radiance_of(prim: Any, time: Any) -> Color:
    api = UsdLux.LightAPI(prim)
    strength = _number(api.GetIntensityAttr(), time, 1.0) * 2.0 ** min(_number(api.GetExposureAttr(), time, 0.0), 120.0)
    strength *= _number(api.GetDiffuseAttr(), time, 1.0)
    color = api.GetColorAttr().Get(time)
    rgb = linear_rec709(api.GetColorAttr(), color) if color is not None else (1.0, 1.0, 1.0)
    rgb = rgb if all(map(math.isfinite, rgb)) else (1.0, 1.0, 1.0)
    if api.GetEnableColorTemperatureAttr().Get(time):
        warm = UsdLux.BlackbodyTemperatureAsRgb(_number(api.GetColorTemperatureAttr(), time, 6500.0))
        rgb = (rgb[0] * warm[0], rgb[1] * warm[1], rgb[2] * warm[2])
    return tuple(max(strength * c, 0.0) for c in rgb)  # type: ignore[return-value]


def note_losses(prim: Any, time: Any, losses: Losses) -> None:
    """What no radiosity of ours knows of a light, and numbers that are none."""
    for name in prim.GetAuthoredPropertyNames():
        value = prim.GetAttribute(name).Get(time) if name.startswith("inputs:") else None
        if isinstance(value, (float, Gf.Vec3f)) and not math.isfinite(sum(value) if isinstance(value, Gf.Vec3f) else value):
            losses.add(prim, f"{name} is not finite; its fallback is taken")
    for link in ("lightLink", "shadowLink"):
        root = prim.GetAttribute(f"collection:{link}:includeRoot")
        named = any(prim.GetRelationship(f"collection:{link}:{which}").GetTargets() for which in ("includes", "excludes") if prim.HasRelationship(f"collection:{link}:{which}"))
        if named or (root and root.HasAuthoredValue() and root.Get(time) is False):
            losses.add(prim, f"{link}: it is baked as lighting everything")
    enable = prim.GetAttribute("inputs:shadow:enable")
    if enable and enable.Get(time) is False:
        losses.add(prim, "shadow:enable off: it is baked with shadows")
    if prim.HasRelationship("light:filters") and prim.GetRelationship("light:filters").GetTargets():
        losses.add(prim, "light filters are not read")
    if prim.HasRelationship("portals") and prim.GetRelationship("portals").GetTargets():
        losses.add(prim, "portals are not needed and not read")
    ies = prim.GetAttribute("inputs:shaping:ies:file")
    if ies and ies.Get(time) and ies.Get(time).path:
        losses.add(prim, "its IES profile is not read")


def _shape(prim: Any, time: Any, kind: str) -> Shape | None:
    """None: it does not confine."""
    if not prim.HasAPI(UsdLux.ShapingAPI):
        return None
    api = UsdLux.ShapingAPI(prim)
    cone = math.radians(_number(api.GetShapingConeAngleAttr(), time, 90.0))
    focus = _number(api.GetShapingFocusAttr(), time, 0.0)
    open_cone = math.pi if kind in ("SphereLight", "CylinderLight") else math.pi / 2
    if focus <= 0 and cone >= open_cone - 1e-6:
        return None
    return Shape(max(cone, 1e-3), _number(api.GetShapingConeSoftnessAttr(), time, 0.0), focus)


def _area_light(prim: Any, time: Any, kind: str, light: Light) -> None:
    schema = getattr(UsdLux, kind)(prim)
    if kind == "RectLight":
        light.size = (_number(schema.GetWidthAttr(), time, 1.0), _number(schema.GetHeightAttr(), time, 1.0))
    elif kind == "CylinderLight":
        light.size = (_number(schema.GetRadiusAttr(), time, 0.5), _number(schema.GetLengthAttr(), time, 1.0))
        light.is_point = bool(schema.GetTreatAsLineAttr().Get(time)) and light.size[0] <= 0
    else:
        light.size = (_number(schema.GetRadiusAttr(), time, 0.5), 1.0)
        light.is_point = kind == "SphereLight" and bool(schema.GetTreatAsPointAttr().Get(time))
    light.shape = _shape(prim, time, kind)


def read(prim: Any, time: Any, losses: Losses) -> Light | None:
    """None: it is no light that is known, or it gives none."""
    kind = str(prim.GetTypeName())
    note_losses(prim, time, losses)
    light = Light(kind, radiance_of(prim, time), bool(UsdLux.LightAPI(prim).GetNormalizeAttr().Get(time)), prim=prim)
    if kind in AREAS:
        _area_light(prim, time, kind, light)
        if min(light.size) <= 0 and not light.is_point:
            losses.add(prim, "its size is 0, which without treatAsPoint gives no light")
            return None
        texture = prim.GetAttribute("inputs:texture:file")
        if texture and texture.Get(time) and texture.Get(time).path:
            losses.add(prim, "the texture of an area light is not read; it counts as white")
    elif kind == "DistantLight":
        light.angle = math.radians(max(_number(UsdLux.DistantLight(prim).GetAngleAttr(), time, 0.53), 0.0))
    elif kind not in DOMES:
        losses.add(prim, f"its light is left out, {kind or 'a light without a type'} is not read")
        return None
    return light


# ---- numbers -----------------------------------------------------------------------------------------------------------


def illuminance(light: Light) -> Color:
    """Of a distant light on a surface that faces it, lux."""
    half = min(light.angle / 2, math.pi)
    if half <= 0:
        return light.radiance
    sine = math.sin(half) ** 2
    size = 1.0
    if light.normalize:
        size = math.pi * sine if half <= math.pi / 2 else math.pi * (2 - sine)
    visible = math.pi * (sine if half <= math.pi / 2 else 1.0)
    # The program counts what arrives across each direction of the disc; a surface that faces its middle gets the cosine less.
    across = visible / mean_cosine(min(half, WIDEST / 2))
    return tuple(c * across / size for c in light.radiance)  # type: ignore[return-value]


def mean_cosine(half: float) -> float:
    """Over a disc of that half angle, each direction with its own cosine to the middle: 2/3 (1 - cos^3) / sin^2."""
    return 1.0 if half < 1e-3 else 2 / 3 * (1 - math.cos(half) ** 3) / math.sin(half) ** 2


def emitted(light: Light, world: Any, meters: float) -> Color:
    """Radiance of an area light that stands at `world`, which leads to metres."""
    if not light.normalize:
        return light.radiance
    area = light.world_area(world) / meters**2
    return tuple(c / area for c in light.radiance) if area > 0 else (0.0, 0.0, 0.0)  # type: ignore[return-value]


def intensity_area(light: Light, world: Any, meters: float) -> tuple[Color, float]:
    """Of a lamp that counts as a point: radiance, and the area it shows along its axis in m2. Their product is the intensity; that of
    a normalized sphere of no size is a quarter of its power [UsdLux: treatAsPoint], and of a line, treatAsLine, as a tube shows it."""
    of_whole = {"SphereLight": 1 / 4, "CylinderLight": 1 / math.pi}.get(light.kind, 1.0)
    if light.kind in ("SphereLight", "CylinderLight") and light.size[0] <= 0:
        return (light.radiance, meters**2 * of_whole) if light.normalize else ((0.0, 0.0, 0.0), 0.0)
    shown = light.world_area(world) * of_whole
    return emitted(light, world, meters), shown
