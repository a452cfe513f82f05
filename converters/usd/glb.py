# SPDX-License-Identifier: MIT
"""How is the scene that the program reads put together? A GLB in memory: accessors, meshes, nodes; each array is stored once."""

from __future__ import annotations

import json
import math
import struct
from typing import Any

import numpy as np

Json = dict[str, Any]

FLOAT, UINT = 5126, 5125
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


def number(value: float) -> float | int:
    """A number as short as nine digits make it: a scene of ten thousand nodes is mostly numbers."""
    if value.is_integer() and -1e9 < value < 1e9:
        return int(value)
    return float(f"{value:.9g}")


def numbers(values: Any) -> list[float | int]:
    """Of colours and strengths, which USD holds as float32: what is 0.7 in its text is 0.7 here, as in a glTF of the same scene."""
    rounded = [(v, float(str(np.float32(v)))) for v in np.asarray(values, float).ravel().tolist()]
    return [number(short if np.isfinite(short) else v) for v, short in rounded]


class Glb:
    """A document under construction. Nodes are added with their parent; -1 is the scene."""

    def __init__(self) -> None:
        self.root: Json = {"asset": {"version": "2.0", "generator": "hemibake usd"}, "scene": 0, "scenes": [{"nodes": []}]}
        self.nodes: list[Json] = []
        self._chunks: list[bytes | memoryview] = []
        self._length = 0
        self._extensions: set[str] = set()

    def use(self, extension: str) -> None:
        self._extensions.add(extension)

    def append(self, kind: str, value: Json) -> int:
        """Adds to one of the document's arrays; its index."""
        items = self.root.setdefault(kind, [])
        items.append(value)
        return len(items) - 1

    def view(self, data: bytes | np.ndarray[Any, Any]) -> int:
        raw = memoryview(np.ascontiguousarray(data)).cast("B") if isinstance(data, np.ndarray) else memoryview(data)
        index = self.append("bufferViews", {"buffer": 0, "byteOffset": self._length, "byteLength": raw.nbytes})
        padding = -raw.nbytes % 4
        self._chunks += [raw, b"\0" * padding]
        self._length += raw.nbytes + padding
        return index

    def accessor(self, values: np.ndarray[Any, Any], bounds: bool = False) -> int:
        """Of floats (n, 1 to 4), or of indices (n)."""
        is_index = values.dtype == np.uint32
        width = 1 if values.ndim == 1 else values.shape[1]
        out: Json = {"bufferView": self.view(values), "componentType": UINT if is_index else FLOAT, "count": len(values), "type": TYPES[width]}
        if bounds:
            out["min"], out["max"] = values.min(axis=0).tolist(), values.max(axis=0).tolist()
        return self.append("accessors", out)

    def node(self, parent: int, **members: Any) -> int:
        """Its index; a matrix of 16 numbers, column-major, that is the identity is left out, one that only moves becomes a translation."""
        matrix = members.pop("matrix", None)
        if matrix is not None:
            members.update(placement(matrix))
        index = len(self.nodes)
        self.nodes.append(members)
        if parent < 0:
            self.root["scenes"][0]["nodes"].append(index)
        else:
            self.nodes[parent].setdefault("children", []).append(index)
        return index

    def bytes(self) -> bytes:
        root = self.root
        if self.nodes:
            root["nodes"] = self.nodes
        else:
            root["scenes"][0].pop("nodes", None)
        if self._extensions:
            root["extensionsUsed"] = sorted(self._extensions)
        if self._length:
            root["buffers"] = [{"byteLength": self._length}]
        text = json.dumps(root, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + (8 + self._length if self._length else 0)
        if total >= 2**32:
            raise ValueError("the scene is larger than 4 GiB, which a GLB cannot hold")
        head = [struct.pack("<4sII", b"glTF", 2, total), struct.pack("<I4s", len(text), b"JSON"), text]
        tail = [struct.pack("<I4s", self._length, b"BIN\0"), *self._chunks] if self._length else []
        return b"".join([*head, *tail])


_UNTURNED = np.eye(4).ravel().tolist()[:12]

# Of the nine numbers that turn and scale, how many may be long before a quaternion says them in less text; and from where on of their
# axes' cosines no quaternion says them.
LONG, SQUARE = 4, 1e-9


def placement(matrix: np.ndarray[Any, Any]) -> Json:
    """Members of a node for a matrix (4, 4) in USD's manner: rows are the images of the axes, which read row by row is glTF's order."""
    values = matrix.ravel().tolist()
    if values[:12] == _UNTURNED:
        return {"translation": [number(v) for v in values[12:15]]} if any(values[12:15]) else {}
    turned = None
    if sum(not v.is_integer() for v in values[:11]) > LONG:
        turned = _turned(values[0:3], values[4:7], values[8:11])
    if turned is None:
        return {"matrix": [number(v) for v in values]}
    return {"translation": [number(v) for v in values[12:15]], **turned}


def _turned(a: list[float], b: list[float], c: list[float]) -> Json | None:
    """Rotation and scale that make these axes; None: they shear, or one is nothing."""
    lengths = [math.hypot(*axis) for axis in (a, b, c)]
    if not min(lengths) > 0:
        return None
    (a0, a1, a2), (b0, b1, b2), (c0, c1, c2) = ([v / length for v in axis] for axis, length in zip((a, b, c), lengths))
    if max(abs(a0 * b0 + a1 * b1 + a2 * b2), abs(a0 * c0 + a1 * c1 + a2 * c2), abs(b0 * c0 + b1 * c1 + b2 * c2)) > SQUARE:
        return None
    if a0 * (b1 * c2 - b2 * c1) + a1 * (b2 * c0 - b0 * c2) + a2 * (b0 * c1 - b1 * c0) < 0:
        lengths[0], a0, a1, a2 = -lengths[0], -a0, -a1, -a2
    four = (1 + a0 - b1 - c2, 1 - a0 + b1 - c2, 1 - a0 - b1 + c2, 1 + a0 + b1 + c2)
    rows = (
        (four[0], a1 + b0, c0 + a2, b2 - c1), (a1 + b0, four[1], b2 + c1, c0 - a2),
        (c0 + a2, b2 + c1, four[2], a1 - b0), (b2 - c1, c0 - a2, a1 - b0, four[3]),
    )  # fmt: skip
    quaternion = rows[four.index(max(four))]
    norm = math.hypot(*quaternion)
    out: Json = {"rotation": [number(v / norm) for v in quaternion]}
    if any(abs(length - 1) > 1e-12 for length in lengths):
        out["scale"] = [number(length) for length in lengths]
    return out
