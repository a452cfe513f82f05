# SPDX-License-Identifier: MIT
"""What radiance does the picture of a dome hold? Radiance's .hdr and .pfm are read here; the rest by OpenImageIO, imageio or Pillow,
whichever this Python has."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]


class Unreadable(Exception):
    """Why, in a few words."""


def srgb_to_linear(v: Array) -> Array:  # IEC 61966-2-1
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


# ---- Radiance ----------------------------------------------------------------------------------------------------------


def _hdr_size(data: bytes) -> tuple[int, int, int]:
    """Width, height, and where pixels begin."""
    header = data.find(b"\n\n")
    end = data.find(b"\n", header + 2) if header >= 0 else -1
    words = data[header + 2 : end].split() if end > 0 else []
    if len(words) != 4 or words[0] != b"-Y" or words[2] != b"+X" or b"FORMAT=32-bit_rle_rgbe" not in data[:header]:
        raise Unreadable("it is no Radiance picture with -Y and +X")
    return int(words[3]), int(words[1]), end + 1


def _run_lengths(data: bytes, at: int, count: int, out: Array) -> int:
    """One channel of one row; where the next begins."""
    filled = 0
    while filled < count:
        if at + 1 >= len(data):
            raise Unreadable("it is cut short")
        code = data[at]
        length = code - 128 if code > 128 else code
        if length == 0 or filled + length > count:
            raise Unreadable("its run lengths do not fit a row")
        out[filled : filled + length] = data[at + 1] if code > 128 else np.frombuffer(data, np.uint8, length, at + 1)
        at += 2 if code > 128 else 1 + length
        filled += length
    return at


def _radiance(data: bytes) -> Array:
    width, height, at = _hdr_size(data)
    if not 0 < width * height <= 2**27:
        raise Unreadable("it has too many pixels")
    rgbe = np.zeros((height, width, 4), np.uint8)
    for row in range(height):
        if data[at : at + 4] != bytes((2, 2, width >> 8, width & 255)):
            flat = np.frombuffer(data, np.uint8, -1, at)
            if flat.size < 4 * width * (height - row):
                raise Unreadable("it is cut short")
            rgbe[row:] = flat[: 4 * width * (height - row)].reshape(height - row, width, 4)
            break
        at += 4
        for channel in range(4):
            at = _run_lengths(data, at, width, rgbe[row, :, channel])
    scale = np.where(rgbe[..., 3] > 0, np.ldexp(1.0, rgbe[..., 3].astype(int) - 136), 0.0)
    return rgbe[..., :3] * scale[..., None]


# ---- what others read --------------------------------------------------------------------------------------------------


def _with_oiio(path: str) -> Array:
    import OpenImageIO as oiio

    buffer = oiio.ImageBuf(path)
    if buffer.has_error:
        raise Unreadable(buffer.geterror())
    return np.asarray(buffer.get_pixels(oiio.FLOAT))


def _with_openexr(path: str) -> Array:
    import OpenEXR

    channels = OpenEXR.File(path).channels()
    if "RGB" in channels or "RGBA" in channels:
        return np.asarray(channels.get("RGB", channels.get("RGBA")).pixels, float)
    return np.stack([np.asarray(channels[c].pixels, float) for c in "RGB"], axis=-1)


def _with_pillow(data: bytes) -> Array:
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), float) / 255


def _by_library(data: bytes, path: str) -> tuple[Array, bool]:
    """Pixels, and whether they are 8-bit colours."""
    is_exr, reasons = data[:4] == b"\x76\x2f\x31\x01", []
    for read in (_with_oiio, _with_openexr) if is_exr else (_with_oiio, _with_pillow):
        try:
            return (read(path) if read is not _with_pillow else _with_pillow(data)), not is_exr
        except ImportError as missing:
            reasons.append(str(missing.name))
        except Unreadable:
            raise
        except Exception as fault:
            raise Unreadable(str(fault)) from fault
    raise Unreadable(f"it needs {' or '.join(reasons)} in this Python")


def read(data: bytes, path: str, raw: bool | None) -> Array:
    """(height, width, 3), linear, row 0 on top; raw None: 8 bits are sRGB."""
    if data[:2] == b"#?":
        return _radiance(data)
    pixels, is_colors = _by_library(data, path)
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    rgb = np.repeat(pixels[..., :1], 3, axis=-1) if pixels.shape[-1] < 3 else pixels[..., :3]
    return srgb_to_linear(rgb) if is_colors and not raw else rgb.astype(float)


def write_pfm(path: str, rgb: Array) -> None:
    """Floats as they are; rows from the bottom up, as the format has it."""
    with open(path, "wb") as f:
        f.write(b"PF\n%d %d\n-1.0\n" % (rgb.shape[1], rgb.shape[0]))
        f.write(np.ascontiguousarray(rgb[::-1], "<f4").tobytes())
