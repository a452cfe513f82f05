# SPDX-License-Identifier: MIT
"""What are the bytes of an OpenEXR file of these parts? Written from the description of the file's layout, not by OpenEXR: raw, RLE's kin ZIPS
and ZIP, scanlines or tiles of one level, one part or many."""

import struct
import zlib

HALF, FLOAT, UINT = ("e", 1), ("f", 2), ("I", 0)  # struct's letter, and the file's number
COMPRESSIONS = {"none": (0, 1), "zips": (2, 1), "zip": (3, 16), "dwaa": (8, 32)}  # the file's number, lines a chunk


class Part:
    """channels: {name: (kind, value(x, y))} or {name: (kind, value, sampling)}. Windows: left, top, right, bottom, all inside."""

    def __init__(self, channels, data, display=None, compression="zip", tile=0, name=None, kind=None, attributes=()):
        self.channels = sorted((one[0], *one[1]) if len(one[1]) == 3 else (one[0], *one[1], 1) for one in channels.items())
        self.data, self.display, self.compression, self.tile = data, display or data, compression, tile
        self.name, self.attributes = name, attributes
        self.kind = kind or ("tiledimage" if tile else "scanlineimage")

    def header(self, is_named):
        def attribute(name, kind, value):
            return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value

        channels = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", kind[1], 0, step, step) for name, kind, _, step in self.channels)
        known = [("channels", "chlist", channels + b"\0"), ("compression", "compression", bytes([COMPRESSIONS[self.compression][0]])),
                 ("dataWindow", "box2i", struct.pack("<4i", *self.data)), ("displayWindow", "box2i", struct.pack("<4i", *self.display)),
                 ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                 ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))]
        if self.tile:
            known.append(("tiles", "tiledesc", struct.pack("<IIB", self.tile, self.tile, 0)))
        if is_named:
            known += [("name", "string", (self.name or "").encode()), ("type", "string", self.kind.encode()),
                      ("chunkCount", "int", struct.pack("<i", len(self.places()))), ("version", "int", struct.pack("<i", 1))]
        return b"".join(attribute(*one) for one in [*known, *self.attributes]) + b"\0"

    def places(self):
        """What a chunk begins with, and its window."""
        left, top, right, bottom = self.data
        if not self.tile:
            lines = COMPRESSIONS[self.compression][1]
            return [(struct.pack("<i", y), (left, y, right, min(y + lines - 1, bottom))) for y in range(top, bottom + 1, lines)]
        size = self.tile
        return [(struct.pack("<4i", (x - left) // size, (y - top) // size, 0, 0), (x, y, min(x + size - 1, right), min(y + size - 1, bottom)))
                for y in range(top, bottom + 1, size) for x in range(left, right + 1, size)]

    def chunk(self, window):
        left, top, right, bottom = window
        raw = b""
        for y in range(top, bottom + 1):
            for _, kind, value, step in self.channels:
                if y % step == 0:
                    row = [value(x, y) for x in range(left, right + 1) if x % step == 0]
                    raw += struct.pack(f"<{len(row)}{kind[0]}", *row)
        packed = pack(raw) if self.compression.startswith("zip") else raw[:-1] if self.compression == "dwaa" else raw
        return packed if len(packed) < len(raw) else raw


def pack(raw):
    """Bytes at even places, then those at odd; each the difference to the one before, and 128."""
    apart = raw[::2] + raw[1::2]
    return zlib.compress(apart[:1] + bytes((apart[i] - apart[i - 1] + 128) & 255 for i in range(1, len(apart))))


def picture(*parts):
    """Bytes of a file. A deep part has a header, and chunks that are no deep ones."""
    is_multi, is_deep = len(parts) > 1, any(part.kind.startswith("deep") for part in parts)
    flags = 2 | (0x1000 if is_multi else 0x200 if parts[0].tile and not is_deep else 0) | (0x800 if is_deep else 0)
    head = b"\x76\x2f\x31\x01" + struct.pack("<I", flags)
    head += b"".join(part.header(is_multi or is_deep) for part in parts) + (b"\0" if is_multi else b"")
    at = len(head) + 8 * sum(len(part.places()) for part in parts)
    offsets, body = b"", b""
    for i, part in enumerate(parts):
        for begin, window in part.places():
            offsets += struct.pack("<Q", at + len(body))
            data = part.chunk(window)
            body += (struct.pack("<i", i) if is_multi else b"") + begin + struct.pack("<I", len(data)) + data
    return head + offsets + body


def of_colors(width, height, rgb, kind=HALF, **settings):
    """A picture of R, G and B; rgb(row, column)."""
    channels = {name: (kind, lambda x, y, k=k: rgb(y, x)[k]) for k, name in enumerate("RGB")}
    return picture(Part(channels, (0, 0, width - 1, height - 1), **settings))
