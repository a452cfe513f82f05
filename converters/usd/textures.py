# SPDX-License-Identifier: MIT
"""How does a UsdUVTexture, or an image of MaterialX, become a glTF texture? Files go into the GLB as they are."""

from __future__ import annotations

import dataclasses
import math
import struct
from collections.abc import Callable
from typing import Any

from pxr import Ar

from .compose import as_png
from .confine import allows
from .glb import Glb, Json, number
from .losses import Losses
from .pictures import Unreadable

WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071, "black": 33071, "useMetadata": 33071, "periodic": 10497}
BLACK = ("black", "useMetadata")  # pictures have no metadata of this; glTF reads the edge, our program what these say
RAW_SPACES = ("raw", "data", "unknown", "identity")


@dataclasses.dataclass(frozen=True)
class Texture:
    """What a material says of one of its textures; what it multiplies is the material's."""

    file: str  # as the resolver knows it
    coordinates: str | None  # the primvar; None: nothing is connected, one texel for all
    raw: bool = False
    wrap: tuple[int, int] = (10497, 10497)
    border: str = ""  # "s", "t" or "st": where it is black beyond 0..1
    transform: tuple[float, ...] = ()  # rotation in degrees, scale s t, translation s t; (): none


def read_bytes(resolved: str) -> bytes | None:
    """A file, also inside a .usdz; None too where --root does not allow it."""
    if not allows(resolved):
        return None
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(resolved))
    return bytes(asset.GetBuffer()) if asset else None


# ---- what is in a picture ----------------------------------------------------------------------------------------------


def media_type(data: bytes) -> str | None:
    if data[:8] == b"\x89PNG\r\n\x1a\n":
        return "image/png"
    if data[:3] == b"\xff\xd8\xff":
        return "image/jpeg"
    return "image/webp" if data[:4] == b"RIFF" and data[8:12] == b"WEBP" else None


def _jpeg_components(data: bytes) -> int:
    at = 2
    while at + 10 < len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], struct.unpack(">H", data[at + 2 : at + 4])[0]
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            return data[at + 9]
        at += 2 + length
    return 3


def is_color(data: bytes) -> bool:
    """What sourceColorSpace auto means: 8 bits a channel, and three or four of them, is sRGB; the rest is raw."""
    if media_type(data) == "image/png" and len(data) > 26:
        return data[24] <= 8 and data[25] in (2, 3, 6)
    return _jpeg_components(data) >= 3 if media_type(data) == "image/jpeg" else True


# ---- into the GLB ------------------------------------------------------------------------------------------------------


class Images:
    """Each file once, each sampler once."""

    def __init__(self, glb: Glb, losses: Losses) -> None:
        self.glb, self.losses = glb, losses
        self._images: dict[tuple[str, bool], int | None] = {}
        self._bytes: dict[str, bytes | None] = {}
        self.reasons: dict[str, str] = {}  # why a file that is no PNG, JPEG or WebP is not made one
        self._samplers: dict[tuple[tuple[int, int], str], int] = {}
        self._textures: dict[tuple[int, int], int] = {}

    def data(self, file: str) -> bytes | None:
        if file not in self._bytes:
            data = read_bytes(file) if file else None
            self._bytes[file] = self._converted(file, data) if data and not media_type(data) else data
        return self._bytes[file]

    def _converted(self, file: str, data: bytes) -> bytes:
        """As it is, where nobody here can read it."""
        try:
            made, is_cut = as_png(data, file)
        except Unreadable as why:
            self.reasons[file] = str(why)
            return data
        if is_cut:
            self.losses.add(file, "as a texture its values end at 1")
        return made

    def made(self, name: str, make: Callable[[], bytes]) -> str:
        """A picture that is made here, once, by a name that no file has."""
        if name not in self._bytes:
            self._bytes[name] = make()
        return name

    def image(self, file: str, raw: bool) -> int | None:
        key = (file, raw)
        if key not in self._images:
            data = self.data(file)
            kind = media_type(data) if data else None
            self._images[key] = None
            if data and kind:
                member: Json = {"bufferView": self.glb.view(data), "mimeType": kind}
                if raw:
                    member["extras"] = {"hemibake_color_space": "raw"}
                self._images[key] = self.glb.append("images", member)
        return self._images[key]

    def readable(self, file: str) -> bool:
        data = self.data(file)
        return bool(data and media_type(data))

    def _sampler(self, wrap: tuple[int, int], border: str) -> int:
        if (wrap, border) not in self._samplers:
            member: Json = {"wrapS": wrap[0], "wrapT": wrap[1]}
            if border:
                member["extras"] = {"hemibake_border": border}
            self._samplers[wrap, border] = self.glb.append("samplers", member)
        return self._samplers[wrap, border]

    def info(self, texture: Texture, set_of: dict[str | None, int]) -> Json | None:
        """A textureInfo of a material. None: the picture cannot be read."""
        image = self.image(texture.file, texture.raw)
        if image is None:
            return None
        key = (image, self._sampler(texture.wrap, texture.border))
        if key not in self._textures:
            self._textures[key] = self.glb.append("textures", {"source": key[0], "sampler": key[1]})
        out: Json = {"index": self._textures[key], "texCoord": set_of[texture.coordinates]}
        if texture.transform:
            out["extensions"] = {"KHR_texture_transform": _transform(texture.transform)}
            self.glb.use("KHR_texture_transform")
        return out


def _transform(values: tuple[float, ...]) -> Json:
    """st' = R S st + T with t up, as glTF says it with v down."""
    angle, sx, sy, tx, ty = values
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    out: Json = {"offset": [number(tx - s * sy), number(1 - ty - c * sy)], "scale": [number(sx), number(sy)]}
    if angle:
        out["rotation"] = number(math.radians(angle))
    return out
