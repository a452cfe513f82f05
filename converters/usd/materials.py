# SPDX-License-Identifier: MIT
"""Which glTF material does a gprim have? What is bound to it and to its subsets, else its displayColor, else grey."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from pxr import UsdGeom, UsdShade

from .compose import with_alpha
from .glb import Glb, Json, numbers
from .losses import Losses
from .pictures import Unreadable
from .primvars import flatten
from .shading import Feed, Network, linear_rec709
from .surfaces import Color, Surface, read_surface
from .textures import Images, Texture

Array = np.ndarray[Any, Any]

GREY: Color = (0.5, 0.5, 0.5)  # of what has neither a material nor a colour

# What is cut out by a texture without a threshold of its own.
CUT = 0.5

# Of a surface, what is one number or colour for all of a prim where a primvar feeds it.
FOLDED = ("emission", "metallic", "roughness", "opacity")

# The mode of what a threshold cuts out whole: there is no surface.
GONE = "GONE"


@dataclasses.dataclass(frozen=True)
class Material:
    """A surface in glTF's terms; coordinates[n] is the primvar of TEXCOORD_n, None where nothing is connected; color_fallback is the
    colour of what lacks color_primvar."""

    name: str
    base: Color = GREY
    emission: Color = (0.0, 0.0, 0.0)
    metallic: float = 0.0
    roughness: float = 1.0
    alpha: float = 1.0
    mode: str = "OPAQUE"
    cutoff: float = 0.5
    base_texture: Texture | None = None
    emission_texture: Texture | None = None
    metal_texture: Texture | None = None
    color_primvar: str | None = None
    color_fallback: Color = GREY
    coordinates: tuple[str | None, ...] = ()


def _rgb(feed: Feed) -> Color:
    value = feed.value
    return (float(value[0]), float(value[1]), float(value[2])) if hasattr(value, "__len__") else (float(value),) * 3


def _product_of(feed: Feed) -> Color:
    """Value times fallback, of what a primvar feeds."""
    r, g, b = (v * f for v, f in zip(_rgb(feed), _rgb(Feed(feed.fallback))))
    return r, g, b


def uncolored(material: Material) -> Material:
    """Of a prim without the primvar that its colour is."""
    return dataclasses.replace(material, base=material.color_fallback, color_primvar=None)


class Materials:
    """The materials of one stage; each is in the GLB once for each way it is used."""

    def __init__(self, glb: Glb, time: Any, losses: Losses) -> None:
        self.glb, self.time, self.losses = glb, time, losses
        self.images = Images(glb, losses)
        self.network = Network(time, losses, self.images)
        self._surfaces: dict[str, Surface | None] = {}
        self._read: dict[Any, Material] = {}
        self._indices: dict[Any, int] = {}

    # ---- reading -------------------------------------------------------------------------------------------------------

    def of(self, bound: Any, shown: Any) -> Material | None:
        """Of a UsdShade.Material at a prim; None: it is none that can be read here."""
        path = str(bound.GetPath())
        if path not in self._surfaces:
            self._surfaces[path] = read_surface(self.network, bound, self.losses)
        surface = self._surfaces[path]
        if not surface:
            return None
        own = {name: self._of_prim(shown, getattr(surface, name), name) for name in FOLDED if getattr(surface, name).primvar}
        key = (path, *((name, feed.value) for name, feed in own.items()))
        if key not in self._read:
            self._read[key] = self._material(bound, dataclasses.replace(surface, **own))
        return self._read[key]

    def _of_prim(self, prim: Any, feed: Feed, name: str) -> Feed:
        """What a primvar is for all of a prim, since glTF has vertex values of colours alone."""
        like = feed.value
        width = 3 if hasattr(like, "__len__") else 1
        values = self._values_of(prim, feed.primvar or "", width)
        if values is None:
            values = np.asarray(feed.fallback, np.float32)[None, :width]
        if (values != values[0]).any():
            self.losses.add(prim, f"{name} by primvars:{feed.primvar} differs over the prim and is read as its mean")
        mean = [float(v) for v in values.mean(axis=0)]
        return Feed(tuple(m * v for m, v in zip(mean, like)) if width == 3 else mean[0] * like)

    def _material(self, bound: Any, surface: Surface) -> Material:
        prim = bound.GetPrim()
        emission, metal, rough = surface.emission, surface.metallic, surface.roughness
        if metal.texture and metal.channel not in ("", "b") and self.images.readable(metal.texture.file):
            self._check_metal(prim, metal)
        mode, alpha, cutoff, base_texture = self._opacity(prim, surface)
        textures = [t for t in (base_texture, emission.texture, metal.texture) if t]
        coordinates = tuple(dict.fromkeys(t.coordinates for t in textures))
        return Material(
            prim.GetName(), _rgb(surface.base), _rgb(emission), float(metal.value),
            self._roughness(metal, rough), alpha, mode, cutoff,
            base_texture, emission.texture, metal.texture, surface.base.primvar, _product_of(surface.base), coordinates,
        )  # fmt: skip

    def _roughness(self, metal: Feed, rough: Feed) -> float:
        """glTF multiplies it by the green of the picture that metalness is in: 1 where roughness is there too. A picture of
        roughness alone is not read; it matters to metals only."""
        if rough.texture or metal.texture:
            return 1.0
        return min(max(float(rough.value), 0.0), 1.0)

    def _check_metal(self, prim: Any, metal: Feed) -> None:
        data = self.images.data(metal.texture.file) if metal.texture else None
        is_grey = bool(data) and data[:4] == b"\x89PNG" and data[25] in (0, 4)
        if not is_grey:
            self.losses.add(prim, f"metalness is channel {metal.channel} of a picture; glTF reads its blue one")

    def _opacity(self, prim: Any, surface: Surface) -> tuple[str, float, float, Texture | None]:
        """A mode of glTF, alpha, the cutoff, and the texture of the colour, whose alpha the opacity is."""
        feed, base = surface.opacity, surface.base.texture
        if not feed.texture:
            alpha = min(max(float(feed.value), 0.0), 1.0)
            if surface.threshold > 0:
                return ("OPAQUE" if alpha >= surface.threshold else GONE), 1.0, CUT, base
            return ("OPAQUE", 1.0, CUT, base) if alpha >= 0.9999 else ("BLEND", alpha, CUT, base)
        if not base or base.file != feed.texture.file or feed.channel != "a":
            base = self._cut_out(prim, base, feed)
        if not base:
            return "OPAQUE", 1.0, CUT, surface.base.texture
        if surface.threshold <= 0:
            self.losses.add(prim, f"opacity is a picture without a threshold; it cuts out below {CUT:g}")
        return "MASK", 1.0, surface.threshold if surface.threshold > 0 else CUT, base

    def _cut_out(self, prim: Any, base: Texture | None, feed: Feed) -> Texture | None:
        """A texture with the opacity's picture as its alpha. None: there can be none, and a line says why."""
        mask = feed.texture
        assert mask
        try:
            if base and (base.coordinates, base.wrap, base.transform) != (mask.coordinates, mask.wrap, mask.transform):
                raise Unreadable("it is looked up at other places than the colour's")
            color = self.images.data(base.file) if base else None
            name = f"{base.file if base else ''} cut by {mask.file} {feed.channel} raw {mask.raw} * {feed.value}"
            made = self.images.made(name, lambda: with_alpha(color, self.images.data(mask.file) or b"", feed.channel, mask.raw, float(feed.value)))
        except Unreadable as why:
            self.losses.add(prim, f"opacity is a picture of its own and is read as opaque: {why}")
            return None
        return dataclasses.replace(base or mask, file=made)

    # ---- what is bound -------------------------------------------------------------------------------------------------

    def bound(self, prim: Any, shown: Any = None) -> Material | None:
        """shown: the mesh of a subset, whose colours stand in for a material that cannot be read, as renderers have it."""
        found, binding = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(UsdShade.Tokens.full)
        if binding and not found:
            named = ", ".join(str(path) for path in binding.GetTargets()) or "nothing"
            self.losses.add(prim, f"it is bound to {named}, which is no material here; it counts as unbound")
        return self.of(found, shown or prim) or self.unbound(shown or prim) if found else None

    @staticmethod
    def _binds(prim: Any) -> bool:
        return bool(UsdShade.MaterialBindingAPI(prim).GetDirectBindingRel().GetTargets())

    def unbound(self, prim: Any) -> Material:
        """By displayColor: one colour goes into the material, several into COLOR_0."""
        array = self._values_of(prim, "displayColor", 3)
        mode, alpha = self._display_opacity(prim)
        if array is None:
            return Material("grey", mode=mode, alpha=alpha)
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
        if (array == array[0]).all() or primvar.GetInterpolation() == "constant":
            return Material("displayColor", linear_rec709(primvar.GetAttr(), array[0]), mode=mode, alpha=alpha)
        return Material("displayColor", (1.0, 1.0, 1.0), mode=mode, alpha=alpha, color_primvar="displayColor")

    def _values_of(self, prim: Any, name: str, width: int) -> Array | None:
        """(n, width) of a primvar at the prim or above, its indices applied; None: none that can be read."""
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
        if not primvar or not primvar.HasValue() or not len(np.atleast_1d(primvar.Get(self.time))):
            return None
        values = flatten(primvar, self.time)
        if values is None or values.size % width or not np.isfinite(values).all():
            self.losses.add(prim, f"primvars:{name} is not read, it has indices out of range or numbers that are not finite")
            return None
        return values.reshape(-1, width)[:1] if primvar.GetInterpolation() == "constant" else values.reshape(-1, width)

    def in_one_color(self, prim: Any, material: Material) -> Material:
        """Of a shape without points: the mean of the primvar that its colour is."""
        values = self._values_of(prim, material.color_primvar, 3) if material.color_primvar else None
        if values is None:
            return uncolored(material) if material.color_primvar else material
        if (values != values[0]).any():
            self.losses.add(prim, f"a shape without points has one colour, the mean of primvars:{material.color_primvar}")
        r, g, b = (float(v) for v in values.mean(axis=0) * material.base)
        return dataclasses.replace(material, base=(r, g, b), color_primvar=None)

    def _display_opacity(self, prim: Any) -> tuple[str, float]:
        """A mode of glTF and alpha; of one opacity for all of the prim."""
        values = self._values_of(prim, "displayOpacity", 1)
        if values is None or values.min() >= 0.9999:
            return "OPAQUE", 1.0
        if values.min() != values.max():
            self.losses.add(prim, "primvars:displayOpacity differs over the prim and is read as opaque")
            return "OPAQUE", 1.0
        return "BLEND", min(max(float(values[0, 0]), 0.0), 1.0)

    def parts(self, prim: Any, face_count: int) -> list[tuple[Array | None, Material]]:
        """Faces and their material; faces that no subset of the family materialBind names have the mesh's own."""
        own = self.bound(prim) or self.unbound(prim)
        subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
        parts: dict[Material, list[Array]] = {}
        left = np.ones(face_count, bool)
        for subset in subsets:
            if subset.GetElementTypeAttr().Get() != "face":
                self.losses.add(subset, "a material of what are no faces is not read")
                continue
            material = self.bound(subset.GetPrim(), prim)
            faces = np.asarray(subset.GetIndicesAttr().Get(self.time) or [], np.int64)
            if len(faces) and (faces.min() < 0 or faces.max() >= face_count):
                self.losses.add(subset, f"it names faces beyond the {face_count} of its mesh, which are left out")
                faces = faces[(faces >= 0) & (faces < face_count)]
            faces = faces[left[faces]]
            if material is None or not len(faces):
                continue
            left[faces] = False
            parts.setdefault(material, []).append(faces)
        for stray in UsdGeom.Subset.GetAllGeomSubsets(UsdGeom.Imageable(prim)):
            if not stray.GetFamilyNameAttr().Get() and self._binds(stray.GetPrim()):
                self.losses.add(stray, "it binds a material, but is of no family materialBind, so USD gives it to none of its faces")
        if not parts:
            return [(None, own)]
        if left.any():
            parts.setdefault(own, []).append(np.nonzero(left)[0])
        return [(np.unique(np.concatenate(faces)), material) for material, faces in parts.items()]

    # ---- into the GLB --------------------------------------------------------------------------------------------------

    def index(self, material: Material, double_sided: bool, emission: Color | None = None, reflects: bool = True) -> int:
        """emission: of a mesh that is a light, instead of the material's."""
        key = (material, double_sided, emission, reflects)
        if key not in self._indices:
            self._indices[key] = self.glb.append("materials", self._member(material, double_sided, emission, reflects))
        return self._indices[key]

    def _member(self, material: Material, double_sided: bool, emission: Color | None, reflects: bool) -> Json:
        sets: dict[str | None, int] = {name: n for n, name in enumerate(material.coordinates)}
        base = tuple(min(max(v, 0.0), 1.0) for v in material.base) if reflects else (0.0, 0.0, 0.0)
        pbr: Json = {"baseColorFactor": numbers([*base, material.alpha]), "metallicFactor": numbers([min(max(material.metallic, 0.0), 1.0)])[0]}
        if material.metallic > 0:
            pbr["roughnessFactor"] = numbers([material.roughness])[0]
        if material.base_texture and reflects:
            pbr["baseColorTexture"] = self.images.info(material.base_texture, sets)
        if material.metal_texture:
            pbr["metallicRoughnessTexture"] = self.images.info(material.metal_texture, sets)
        out: Json = {"name": material.name, "pbrMetallicRoughness": pbr, "doubleSided": double_sided}
        if material.mode != "OPAQUE":
            out["alphaMode"] = material.mode
        if material.mode == "MASK":
            out["alphaCutoff"] = numbers([material.cutoff])[0]
        self._add_emission(out, emission if emission is not None else material.emission, material.emission_texture if emission is None else None, sets)
        return out

    def _add_emission(self, out: Json, color: Color, texture: Texture | None, sets: dict[str | None, int]) -> None:
        most = max(color)
        if not most > 0:
            return
        out["emissiveFactor"] = numbers([max(c, 0.0) / max(most, 1.0) for c in color])
        if texture:
            out["emissiveTexture"] = self.images.info(texture, sets)
        if most > 1:
            out["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": numbers([most])[0]}}
            self.glb.use("KHR_materials_emissive_strength")
