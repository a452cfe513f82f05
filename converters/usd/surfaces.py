# SPDX-License-Identifier: MIT
"""How does a surface shader reflect, emit and cut out as a Lambert surface? UsdPreviewSurface, and of MaterialX standard_surface,
open_pbr_surface, gltf_pbr and UsdPreviewSurface."""

from __future__ import annotations

import dataclasses
from typing import Any

from .losses import Losses
from .shading import Feed, Network

Color = tuple[float, float, float]
BLACK: Color = (0.0, 0.0, 0.0)


@dataclasses.dataclass
class Surface:
    """What of a shader counts for diffuse light."""

    base: Feed
    emission: Feed
    metallic: Feed
    roughness: Feed
    opacity: Feed
    threshold: float = 0.0
    presence: bool = False


def _times(feed: Feed, factor: float) -> Feed:
    return dataclasses.replace(feed, value=tuple(factor * float(v) for v in feed.value))


def _product(network: Network, shader: Any, color: str, weight: str, fallback: Color, weight_fallback: float) -> Feed:
    scale = network.feed(shader, weight, weight_fallback)
    if scale.texture or scale.primvar:
        network.losses.add(shader.GetPrim(), f"inputs:{weight} is a picture, which is read as 1")
    return _times(network.feed(shader, color, fallback), 1.0 if scale.texture or scale.primvar else float(scale.value))


def preview_surface(network: Network, shader: Any) -> Surface:
    metallic = network.feed(shader, "metallic", 0.0)
    base = network.feed(shader, "diffuseColor", (0.18, 0.18, 0.18))
    if int(network.value(shader, "useSpecularWorkflow", 0)):
        metallic = Feed(0.0)
    return Surface(
        base, network.feed(shader, "emissiveColor", BLACK), metallic, network.feed(shader, "roughness", 0.5),
        network.feed(shader, "opacity", 1.0), float(network.value(shader, "opacityThreshold", 0.0)), str(network.value(shader, "opacityMode", "transparent")) == "presence",
    )  # fmt: skip


def standard_surface(network: Network, shader: Any) -> Surface:
    opacity = network.feed(shader, "opacity", (1.0, 1.0, 1.0))
    if hasattr(opacity.value, "__len__"):
        opacity = dataclasses.replace(opacity, value=sum(opacity.value) / 3)
    transmission = network.feed(shader, "transmission", 0.0)
    if not transmission.texture and float(transmission.value) > 0:
        network.losses.add(shader.GetPrim(), "transmission is read as opaque")
    return Surface(
        _product(network, shader, "base_color", "base", (0.8, 0.8, 0.8), 1.0), _product(network, shader, "emission_color", "emission", (1.0, 1.0, 1.0), 0.0),
        network.feed(shader, "metalness", 0.0), network.feed(shader, "specular_roughness", 0.2), opacity,
    )  # fmt: skip


def open_pbr(network: Network, shader: Any) -> Surface:
    """emission_luminance is in nits."""
    return Surface(
        _product(network, shader, "base_color", "base_weight", (0.8, 0.8, 0.8), 1.0),
        _product(network, shader, "emission_color", "emission_luminance", (1.0, 1.0, 1.0), 0.0),
        network.feed(shader, "base_metalness", 0.0), network.feed(shader, "specular_roughness", 0.3),
        network.feed(shader, "geometry_opacity", 1.0),
    )  # fmt: skip


def gltf_pbr(network: Network, shader: Any) -> Surface:
    """As the material of glTF that it is made after; of its own fallbacks, base_color is white and metallic 1."""
    mode = int(network.value(shader, "alpha_mode", 0))
    strength = network.feed(shader, "emissive_strength", 1.0)
    if network.feed(shader, "transmission", 0.0).value:
        network.losses.add(shader.GetPrim(), "transmission is read as opaque")
    return Surface(
        network.feed(shader, "base_color", (1.0, 1.0, 1.0)), _times(network.feed(shader, "emissive", BLACK), float(strength.value)),
        network.feed(shader, "metallic", 1.0), network.feed(shader, "roughness", 1.0),
        network.feed(shader, "alpha", 1.0) if mode else Feed(1.0), float(network.value(shader, "alpha_cutoff", 0.5)) if mode == 1 else 0.0,
    )  # fmt: skip


READERS = {
    "UsdPreviewSurface": preview_surface,
    "ND_UsdPreviewSurface_surfaceshader": preview_surface,
    "ND_standard_surface_surfaceshader": standard_surface,
    "ND_open_pbr_surface_surfaceshader": open_pbr,
    "ND_gltf_pbr_surfaceshader": gltf_pbr,
}


def _candidates(material: Any) -> list[Any]:
    out = []
    for context in ("", "mtlx"):
        shader = material.ComputeSurfaceSource(context)[0] if context else material.ComputeSurfaceSource()[0]
        if shader and shader.GetPrim() and shader.GetPrim() not in [known.GetPrim() for known in out]:
            out.append(shader)
    return out


def read_surface(network: Network, material: Any, losses: Losses) -> Surface | None:
    """None: there is no shader that is known here, and a line says so."""
    shaders = _candidates(material)
    for shader in shaders:
        reader = READERS.get(str(shader.GetIdAttr().Get() or ""))
        if reader:
            return reader(network, shader)
    named = ", ".join(str(s.GetIdAttr().Get() or "a shader without an id") for s in shaders)
    losses.add(material.GetPrim(), f"its surface is {named}, which is not read; displayColor stands in" if named else "it has no surface shader that can be read here; displayColor stands in")
    return None
