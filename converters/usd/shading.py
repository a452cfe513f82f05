# SPDX-License-Identifier: MIT
"""What feeds an input of a shader? A number, a texture or a primvar, through whatever lies between."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from pxr import Gf, Usd, UsdShade

from .arithmetic import computed
from .compose import adjusted
from .losses import Losses
from .pictures import Unreadable
from .textures import BLACK, RAW_SPACES, WRAPS, Texture, is_color

LINEAR = "lin_rec709_scene"
EMISSION = ("emissiveColor", "emission_color", "emissive")


@dataclasses.dataclass
class Feed:
    """value * texture or primvar, if there is one; channel of the texture for inputs of one number; fallback of a primvar that a prim
    lacks."""

    value: Any
    texture: Texture | None = None
    primvar: str | None = None
    channel: str = ""
    fallback: tuple[float, ...] = (0.0, 0.0, 0.0)


def linear_rec709(attribute: Any, color: Any) -> tuple[float, float, float]:
    """A colour out of the space that the attribute, or something above it, names."""
    rgb = (float(color[0]), float(color[1]), float(color[2]))
    name = attribute.GetColorSpace() if attribute.HasColorSpace() else ""
    if not name:
        # Releases before 24.11 have no such schema.
        name = Usd.ColorSpaceAPI.ComputeColorSpaceName(attribute, None) if hasattr(Usd, "ColorSpaceAPI") else ""
    name = str(name or "")
    if not name or name == LINEAR or name in RAW_SPACES or not Gf.ColorSpace.IsValid(name):
        return rgb
    converted = Gf.ColorSpace(LINEAR).Convert(Gf.ColorSpace(name), Gf.Vec3f(*rgb)).GetRGB()
    return (max(converted[0], 0.0), max(converted[1], 0.0), max(converted[2], 0.0))


def _as_numbers(attribute: Any, value: Any, like: Any) -> Any:
    """A number, or a colour where `like` is one; None: it is neither, or not finite."""
    try:
        if hasattr(value, "__len__"):
            color = linear_rec709(attribute, value)
            if not all(map(math.isfinite, color)):
                return None
            return color if hasattr(like, "__len__") else sum(color) / 3
        number = float(value)
    except (ValueError, TypeError, IndexError):
        return None
    if not math.isfinite(number):
        return None
    return (number,) * 3 if hasattr(like, "__len__") else number


class Network:
    """Reads the inputs of one material's shaders at one time."""

    def __init__(self, time: Any, losses: Losses, images: Any) -> None:
        self.time, self.losses, self.images = time, losses, images
        self._open: list[Any] = []  # nodes that are being computed

    def source(self, shader: Any, name: str) -> tuple[Any, str, Any]:
        """The shader that feeds an input, and by which output, through node graphs and interfaces; else the attribute that holds
        its value, or None."""
        put = shader.GetInput(name)
        if not put:
            return None, "", None
        for attribute in UsdShade.Utils.GetValueProducingAttributes(put):
            prim = attribute.GetPrim()
            if prim.IsA(UsdShade.Shader) and attribute.GetName().startswith("outputs:"):
                return UsdShade.Shader(prim), attribute.GetName()[len("outputs:") :], None
            return None, "", attribute
        return None, "", None

    def value(self, shader: Any, name: str, fallback: Any) -> Any:
        """A value that nothing computes."""
        _, _, attribute = self.source(shader, name)
        value = attribute.Get(self.time) if attribute else None
        return fallback if value is None else value

    def feed(self, shader: Any, name: str, fallback: Any) -> Feed:
        producer, output, attribute = self.source(shader, name)
        if producer:
            return self._produced(producer, output, shader, name, fallback)
        value = attribute.Get(self.time) if attribute else None
        if value is None:
            return Feed(fallback)
        read = _as_numbers(attribute, value, fallback)
        if read is None:
            self.losses.add(shader.GetPrim(), f"inputs:{name} is no number that is finite; its fallback is taken")
        return Feed(fallback if read is None else read)

    def _produced(self, producer: Any, output: str, shader: Any, name: str, fallback: Any) -> Feed:
        kind = str(producer.GetIdAttr().Get() or "")
        if kind == "UsdUVTexture":
            return self._uv_texture(producer, output, name, fallback)
        if kind.startswith(("UsdPrimvarReader", "ND_UsdPrimvarReader", "ND_geompropvalue")):
            is_geomprop = "geomprop" in kind
            otherwise = self.feed(producer, "default" if is_geomprop else "fallback", (0.0, 0.0, 0.0)).value
            name = str(self.value(producer, "geomprop" if is_geomprop else "varname", "") or "")
            return Feed((1.0, 1.0, 1.0) if hasattr(fallback, "__len__") else 1.0, primvar=name, fallback=otherwise)
        if kind.startswith(("ND_image", "ND_tiledimage", "ND_UsdUVTexture")):
            return self._image(producer, output, name, fallback)
        made = self._computed(producer, kind, fallback)
        if made:
            if made.texture and name not in EMISSION and any(v > 1 for v in (made.value if hasattr(made.value, "__len__") else (made.value,))):
                self.losses.add(shader.GetPrim(), f"inputs:{name} is a picture times more than 1, which is read as 1")
            return made
        upstream = self._upstream(producer, 0)
        if upstream:
            self.losses.add(shader.GetPrim(), f"inputs:{name} is read as the picture behind {kind}, without what that does to it")
            return self._image(upstream, output, name, fallback) if str(upstream.GetIdAttr().Get()).startswith("ND_") else self._uv_texture(upstream, output, name, fallback)
        self.losses.add(shader.GetPrim(), f"inputs:{name} is computed by {kind or 'a shader without an id'}, which is not read; its fallback is taken")
        return Feed(fallback)

    def _computed(self, producer: Any, kind: str, like: Any) -> Feed | None:
        """None too of what feeds itself."""
        path = producer.GetPath()
        if path in self._open:
            return None
        self._open.append(path)
        try:
            return computed(self, producer, kind, like)
        finally:
            self._open.pop()

    def _upstream(self, shader: Any, depth: int) -> Any:
        """A picture behind arithmetic."""
        for put in shader.GetInputs() if depth < 8 else ():
            producer, _, _ = self.source(shader, put.GetBaseName())
            if producer:
                kind = str(producer.GetIdAttr().Get() or "")
                found = producer if kind.startswith(("ND_image", "ND_tiledimage", "UsdUVTexture")) else self._upstream(producer, depth + 1)
                if found:
                    return found
        return None

    # ---- pictures ------------------------------------------------------------------------------------------------------

    def _file(self, shader: Any) -> tuple[str, Any]:
        _, _, attribute = self.source(shader, "file")
        asset = attribute.Get(self.time) if attribute else None
        if asset is None:
            return "", attribute
        return str(asset.resolvedPath if hasattr(asset, "resolvedPath") else asset), attribute

    def _coordinates(self, shader: Any, name: str, depth: int = 0) -> tuple[str | None, tuple[float, ...]]:
        """The primvar that a picture is looked up with, and a transform on the way."""
        producer, _, _ = self.source(shader, name)
        if not producer or depth > 8:
            return None, ()
        kind = str(producer.GetIdAttr().Get() or "")
        if kind.endswith("UsdTransform2d"):
            below, inner = self._coordinates(producer, "in", depth + 1)
            scale, move = self.value(producer, "scale", (1, 1)), self.value(producer, "translation", (0, 0))
            turn = float(self.value(producer, "rotation", 0.0))
            if inner:
                self.losses.add(producer.GetPrim(), "only one transform of texture coordinates is read")
            out = (turn, float(scale[0]), float(scale[1]), float(move[0]), float(move[1]))
            if all(map(math.isfinite, out)):
                return below, out
            self.losses.add(producer.GetPrim(), "a transform of texture coordinates that is not finite is left out")
            return below, inner
        if "texcoord" in kind:
            return "st", ()
        return str(self.value(producer, "geomprop" if "geomprop" in kind else "varname", "") or "") or None, ()

    def _four(self, shader: Any, name: str, fallback: tuple[float, ...]) -> tuple[float, ...]:
        """Numbers of a picture, finite."""
        out = tuple(float(v) for v in self.value(shader, name, fallback))
        return out if len(out) == 4 and all(map(math.isfinite, out)) else fallback

    def _unread(self, shader: Any, file: str, fallback: Any) -> Feed | None:
        if self.images.readable(file):
            return None
        asset = shader.GetInput("file").Get(self.time) if shader.GetInput("file") else None
        name = getattr(asset, "path", "") or "no file"
        why = "UDIM tiles are not read" if "<UDIM>" in name else f"it is no PNG, JPEG or WebP ({self.images.reasons.get(file, 'broken')})" if file else "it is not there"
        self.losses.add(shader.GetPrim(), f"texture {name}: {why}; its fallback is taken")
        return Feed(fallback)

    def _uv_texture(self, shader: Any, output: str, name: str, fallback: Any) -> Feed:
        file, attribute = self._file(shader)
        value = self._four(shader, "fallback", (0.0, 0.0, 0.0, 1.0))
        channel = output if output in ("r", "g", "b", "a") else ""
        scalar = float(value["rgba".index(channel)]) if channel else 0.0
        missing = self._unread(shader, file, scalar if channel else tuple(float(v) for v in value[:3]))
        if missing:
            return missing
        scale, bias = self._four(shader, "scale", (1, 1, 1, 1)), self._four(shader, "bias", (0, 0, 0, 0))
        coordinates, transform = self._coordinates(shader, "st")
        words = [str(self.value(shader, key, "useMetadata")) for key in ("wrapS", "wrapT")]
        wrap = tuple(WRAPS.get(word, WRAPS["repeat"]) for word in words)
        border = "".join(axis for axis, word in zip("st", words) if word in BLACK)
        space = str(self.value(shader, "sourceColorSpace", "auto"))
        raw = self._is_raw(space, attribute, file)
        if name != "normal":
            file, scale = self._adjusted(shader, file, raw, scale, bias, channel, name)
        texture = Texture(file, coordinates, raw, (wrap[0], wrap[1]), border, transform)
        return Feed(float(scale["rgba".index(channel)]) if channel else tuple(float(v) for v in scale[:3]), texture, channel=channel)

    def _adjusted(self, shader: Any, file: str, raw: bool, scale: tuple[float, ...], bias: tuple[float, ...], channel: str, name: str) -> tuple[str, tuple[float, ...]]:
        """The picture, and what is left to scale by: factors of glTF are from 0 to 1, of what emits from 0 on, and add nothing."""
        bias_counts, most = any(abs(b) > 1e-6 for b in bias[:3]), 1e30 if name in EMISSION else 1.0
        if not bias_counts and all(0 <= s <= most for s in scale[:3]):
            return file, scale
        try:
            if channel or name in EMISSION:
                raise Unreadable("it is of a single channel or of what emits")
            made = self.images.made(f"{file} raw {raw} * {scale} + {bias}", lambda: adjusted(self.images.data(file) or b"", raw, scale, bias))
            return made, (1.0, 1.0, 1.0, 1.0)
        except Unreadable as why:
            what = "bias of a texture is not read" if bias_counts else "scale of a texture is read from 0 to 1"
            self.losses.add(shader.GetPrim(), f"{what}: {why}")
            return file, scale

    def _is_raw(self, space: str, attribute: Any, file: str) -> bool:
        if space in ("raw", "sRGB"):
            return space == "raw"
        named = str(attribute.GetColorSpace()) if attribute and attribute.HasColorSpace() else ""
        if named:
            return named in RAW_SPACES or named.startswith("lin")
        data = self.images.data(file)
        return bool(data) and not is_color(data)

    def _image(self, shader: Any, output: str, name: str, fallback: Any) -> Feed:
        """ND_image_*, ND_tiledimage_*: MaterialX says the space at the file."""
        file, attribute = self._file(shader)
        missing = self._unread(shader, file, self.value(shader, "default", None) or fallback)
        if missing:
            return missing
        coordinates, transform = self._coordinates(shader, "texcoord")
        kind = str(shader.GetIdAttr().Get())
        if kind.startswith("ND_tiledimage"):
            tiles = self.value(shader, "uvtiling", (1, 1))
            transform = (0.0, float(tiles[0]), float(tiles[1]), 0.0, 0.0)
        named = str(attribute.GetColorSpace()) if attribute and attribute.HasColorSpace() else ""
        raw = named in RAW_SPACES or named.startswith("lin") or not named
        wrap = tuple(WRAPS.get(str(self.value(shader, key, "periodic")), WRAPS["repeat"]) for key in ("uaddressmode", "vaddressmode"))
        scalar = not hasattr(fallback, "__len__")
        channel = (output if output in ("r", "g", "b") else "r") if scalar else ""
        return Feed(1.0 if scalar else (1.0, 1.0, 1.0), Texture(file, coordinates or "st", raw, (wrap[0], wrap[1]), "", transform), channel=channel)
