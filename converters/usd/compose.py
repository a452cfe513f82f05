# SPDX-License-Identifier: MIT
"""Which picture is made where glTF has none or one, and USD says more? Formats of USD become PNG, an opacity of its own the alpha of the
colour's, and a scale and a bias that no factor is pixels. Pillow reads them; without it nothing is made."""

from __future__ import annotations

import io
import struct
import zlib
from typing import Any

import numpy as np

from .pictures import Unreadable, read, srgb_to_linear

Array = np.ndarray[Any, Any]

# As the program's --max-pixels, unless that says otherwise.
MOST_PIXELS = 2**25

LACKING = "it takes pillow in this Python"


def _linear_to_srgb(v: Array) -> Array:  # IEC 61966-2-1
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.maximum(v, 1e-9) ** (1 / 2.4) - 0.055)


def _decoded(data: bytes) -> Array:
    """(height, width, 4), 0 to 1 as it is stored."""
    try:
        from PIL import Image
    except ImportError as missing:
        raise Unreadable(LACKING) from missing
    try:
        with Image.open(io.BytesIO(data)) as picture:
            if picture.width * picture.height > MOST_PIXELS:
                raise Unreadable(f"it has {picture.width} x {picture.height} pixels")
            if picture.mode.startswith("I;16"):
                grey = np.asarray(picture, float)[..., None] / 65535
                return np.concatenate([grey, grey, grey, np.ones_like(grey)], axis=-1)
            return np.asarray(picture.convert("RGBA"), float) / 255
    except Unreadable:
        raise
    except Exception as fault:
        raise Unreadable(str(fault)) from fault


def _encoded(pixels: Array, bits: int = 8) -> bytes:
    """A PNG of three channels or four."""
    height, width, channels = pixels.shape
    rows = np.rint((2**bits - 1) * np.clip(pixels, 0, 1)).astype(">u2" if bits == 16 else np.uint8).view(np.uint8)
    lines = np.concatenate([np.zeros((height, 1), np.uint8), rows.reshape(height, -1)], axis=1)

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">2I5B", width, height, bits, {3: 2, 4: 6}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines.tobytes(), 6)) + chunk(b"IEND", b"")


def as_png(data: bytes, path: str) -> tuple[bytes, bool]:
    """A picture of a format that glTF has not, and whether it had values above 1, which it lost. What is linear has 16 bits, which
    sourceColorSpace auto takes as linear too."""
    if data[:4] == b"\x76\x2f\x31\x01" or data[:2] == b"#?":
        pixels = read(data, path, True)
        return _encoded(np.nan_to_num(pixels, posinf=1.0), 16), bool((pixels > 1).any())
    return _encoded(_decoded(data)), False


def _sized(pixels: Array, height: int, width: int) -> Array:
    """The nearest pixel of each."""
    row, column = (np.arange(n) * have // n for n, have in zip((height, width), pixels.shape))
    return pixels[row][:, column]


def adjusted(data: bytes, raw: bool, scale: tuple[float, ...], bias: tuple[float, ...]) -> bytes:
    """scale * picture + bias, 0 to 1, in the space that it was in."""
    pixels = _decoded(data)
    color = pixels[..., :3] if raw else srgb_to_linear(pixels[..., :3])
    color = np.clip(color * np.array(scale[:3]) + np.array(bias[:3]), 0, 1)
    return _encoded(np.concatenate([color if raw else _linear_to_srgb(color), pixels[..., 3:]], axis=-1))


def with_alpha(color: bytes | None, mask: bytes, channel: str, raw: bool, factor: float) -> bytes:
    """The colours of one picture, or white, and a channel of another; as large as the larger."""
    alpha = _decoded(mask)[..., "rgba".index(channel or "r")]
    alpha = factor * (alpha if raw or channel == "a" else srgb_to_linear(alpha))
    below = _decoded(color)[..., :3] if color else np.ones((1, 1, 3))
    height, width = (max(n) for n in zip(alpha.shape, below.shape))
    return _encoded(np.concatenate([_sized(below, height, width), _sized(alpha[..., None], height, width)], axis=-1))
