# SPDX-License-Identifier: MIT
"""What did the program bake? The GLB it hands back: nodes with the paths of their prims, triangles, colours and radiance."""

from __future__ import annotations

import dataclasses
import json
import struct
from typing import Any

import numpy as np

from .losses import Refused

Array = np.ndarray[Any, Any]

TYPES = {5126: "<f4", 5125: "<u4", 5123: "<u2", 5122: "<i2", 5121: "u1", 5120: "i1"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


@dataclasses.dataclass
class Piece:
    """One primitive at one node, in world space, metres, y up."""

    path: str  # of the prim
    positions: Array
    triangles: Array
    colors: Array  # linear, 0..1
    radiance: Array | None  # None: it was not baked
    opacity: float = 1.0
    double_sided: bool = False
    is_cut: bool = False  # by a picture's alpha


@dataclasses.dataclass
class Baked:
    pieces: list[Piece]
    paths: list[str]  # of every node of a prim, lit or not
    instancers: list[str]
    stamp: dict[str, Any]

    @staticmethod
    def read(path: str) -> Baked:
        with open(path, "rb") as f:
            data = f.read()
        if data[:4] != b"glTF" or len(data) < 28:
            raise Refused("what was baked is no GLB")
        (length,) = struct.unpack_from("<I", data, 12)
        return _Reader(json.loads(data[20 : 20 + length]), data[28 + length :]).read()


def _matrix(node: dict[str, Any]) -> Array:
    """Rows are images of the axes."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4)
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    out = np.eye(4)
    out[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ]
    out[:3, :3] *= np.array(node.get("scale", (1, 1, 1)), float)[:, None]
    out[3, :3] = node.get("translation", (0, 0, 0))
    return out


class _Reader:
    def __init__(self, root: dict[str, Any], blob: bytes) -> None:
        self.root, self.blob = root, blob
        self.pieces: list[Piece] = []
        self.paths: list[str] = []
        self.instancers: dict[str, None] = {}

    def read(self) -> Baked:
        scenes = self.root.get("scenes", [])
        roots = scenes[self.root.get("scene", 0)].get("nodes", []) if scenes else []
        stack = [(index, np.eye(4), "") for index in reversed(roots)]
        while stack:
            index, above, path = stack.pop()
            node = self.root["nodes"][index]
            path, world = self._path(node, path), _matrix(node) @ above
            if "mesh" in node:
                self._mesh(node["mesh"], world, path)
            stack += [(child, world, path) for child in reversed(node.get("children", []))]
        stamp = self.root.get("asset", {}).get("extras", {}).get("hemibake", {})
        return Baked(self.pieces, list(dict.fromkeys(self.paths)), list(self.instancers), stamp)

    def _path(self, node: dict[str, Any], above: str) -> str:
        usd = node.get("extras", {}).get("usd", {}) if isinstance(node.get("extras"), dict) else {}
        if not usd.get("path"):
            return f"{above}/{node.get('name') or 'node'}" if "mesh" in node else above
        if "mesh" in node or node.get("extensions") or node["extras"].get("hemibake_lamp"):
            self.paths.append(usd["path"])
        if usd.get("instancer"):
            self.instancers[usd["instancer"]] = None
        return str(usd["path"])

    def accessor(self, index: int) -> Array:
        a = self.root["accessors"][index]
        view, kind, width = self.root["bufferViews"][a["bufferView"]], np.dtype(TYPES[a["componentType"]]), WIDTHS[a["type"]]
        begin = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        stride = view.get("byteStride", 0) or kind.itemsize * width
        out = np.ndarray((a["count"], width), kind, self.blob, begin, (stride, kind.itemsize))
        return out.astype(np.float32) / np.float32(np.iinfo(kind).max) if a.get("normalized") else out

    def _alpha(self, attributes: dict[str, int]) -> float:
        """Mean over the vertices."""
        colors = self.accessor(attributes["COLOR_0"]) if "COLOR_0" in attributes else np.ones((1, 3))
        return float(colors[:, 3].mean()) if colors.shape[1] > 3 else 1.0

    def _mesh(self, index: int, world: Array, path: str) -> None:
        for primitive in self.root["meshes"][index]["primitives"]:
            if primitive.get("mode", 4) != 4 or "indices" not in primitive:
                continue
            at = primitive["attributes"]
            material = self.root["materials"][primitive["material"]] if "material" in primitive else {}
            positions = self.accessor(at["POSITION"]).astype(float) @ world[:3, :3] + world[3, :3]
            triangles = self.accessor(primitive["indices"]).reshape(-1, 3).astype(np.int32)
            if np.linalg.det(world[:3, :3]) < 0:
                triangles = triangles[:, ::-1]
            blends = material.get("alphaMode") == "BLEND"
            factor = np.float32(material.get("pbrMetallicRoughness", {}).get("baseColorFactor", (1, 1, 1, 1)))
            lit = "_RADIOSITY" in at
            colors = self.accessor(at["COLOR_0"])[:, :3].astype(np.float32) if "COLOR_0" in at else np.tile(factor[:3], (len(positions), 1))
            self.pieces.append(Piece(
                path, positions.astype(np.float32), np.ascontiguousarray(triangles), np.clip(colors, 0, 1),
                self.accessor(at["_RADIOSITY"]).astype(np.float32) if lit else None,
                self._alpha(at) * float(factor[3]) if blends else 1.0, bool(material.get("doubleSided", False)), material.get("alphaMode") == "MASK",
            ))  # fmt: skip
