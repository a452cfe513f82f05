# SPDX-License-Identifier: MIT
"""Which picture is made where glTF has one and USD says more? An opacity of its own becomes the alpha of the colour's, and a scale and a
bias that no factor is become pixels. Pillow reads them; without it nothing is made."""

from __future__ import annotations

import io
import struct
import zlib
from typing import Any

import numpy as np

from .pictures import Unreadable, srgb_to_linear

Array = np.ndarray[Any, Any]

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
            if picture.mode.startswith("I;16"):
                grey = np.asarray(picture, float)[..., None] / 65535
                return np.concatenate([grey, grey, grey, np.ones_like(grey)], axis=-1)
            return np.asarray(picture.convert("RGBA"), float) / 255
    except Exception as fault:
        raise Unreadable(str(fault)) from fault


def _encoded(pixels: Array) -> bytes:
    """A PNG of 8 bits and four channels."""
    rows = np.rint(255 * np.clip(pixels, 0, 1)).astype(np.uint8)
    height, width = rows.shape[:2]
    lines = np.concatenate([np.zeros((height, 1), np.uint8), rows.reshape(height, -1)], axis=1)

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">2I5B", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines.tobytes(), 6)) + chunk(b"IEND", b"")


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
