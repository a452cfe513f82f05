# SPDX-License-Identifier: MIT
"""How does a scene of arrays become a file? As a .glb with what glTF has words for: meshes, materials, lights without size."""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

_FLOAT, _UINT32 = 5126, 5125
_LIGHTS, _STRENGTH = "KHR_lights_punctual", "KHR_materials_emissive_strength"


def _turn(direction: Sequence[float]) -> Array:
    """A rotation that takes -z, along which lights of glTF shine, to the direction."""
    z = -np.asarray(direction, float) / np.linalg.norm(direction)
    x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


class Asset:
    """Collects what a scene is told."""

    def __init__(self) -> None:
        self._binary = bytearray()
        self._json: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "hemibake"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "materials": [], "accessors": [], "bufferViews": [],
        }
        self._lights: list[dict[str, Any]] = []
        self.lost: set[str] = set()  # what glTF has no words for

    def _use(self, extension: str) -> None:
        used: list[str] = self._json.setdefault("extensionsUsed", [])
        if extension not in used:
            used.append(extension)

    def _accessor(self, rows: Array, component: int, kind: str, **more: Any) -> int:
        data = rows.tobytes()
        self._json["bufferViews"].append({"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)})
        self._binary += data
        view = len(self._json["bufferViews"]) - 1
        self._json["accessors"].append({"bufferView": view, "componentType": component, "type": kind, "count": len(rows), **more})
        return len(self._json["accessors"]) - 1

    def _node(self, **node: Any) -> None:
        self._json["scenes"][0]["nodes"].append(len(self._json["nodes"]))
        self._json["nodes"].append({key: value for key, value in node.items() if value not in ("", None)})

    def add_material(self, name: str, reflectance: Sequence[float], emission: Sequence[float], double_sided: bool) -> None:
        strength = max(max(emission), 1.0)
        material: dict[str, Any] = {
            "name": name,
            "pbrMetallicRoughness": {"baseColorFactor": [*map(float, reflectance), 1.0], "metallicFactor": 0.0},
            "emissiveFactor": [e / strength for e in emission],
            "doubleSided": bool(double_sided),
        }
        if strength > 1.0:
            material["extensions"] = {_STRENGTH: {"emissiveStrength": strength}}
            self._use(_STRENGTH)
        self._json["materials"].append(material)

    def add_mesh(self, name: str, points: Array, corners: Array, normals: Array | None, matrix: Array | None, material: int) -> None:
        rows = points.reshape(-1, 3)
        low, high = (rows.min(axis=0).tolist(), rows.max(axis=0).tolist()) if len(rows) else ([0.0] * 3, [0.0] * 3)
        attributes = {"POSITION": self._accessor(rows, _FLOAT, "VEC3", min=low, max=high)}
        if normals is not None:
            attributes["NORMAL"] = self._accessor(normals.reshape(-1, 3), _FLOAT, "VEC3")
        indices = self._accessor(corners.reshape(-1), _UINT32, "SCALAR")
        self._json["meshes"].append({"primitives": [{"attributes": attributes, "indices": indices, "material": int(material)}]})
        self._node(name=name, mesh=len(self._json["meshes"]) - 1, matrix=None if matrix is None else matrix.T.ravel().tolist())

    def add_light(self, kind: str, name: str, intensity: Sequence[float], position: Sequence[float], direction: Sequence[float],
                  cones: tuple[float, float], reach: float) -> None:
        strength = max(max(intensity), 1e-30)
        light: dict[str, Any] = {"type": kind, "name": name, "intensity": strength, "color": [i / strength for i in intensity]}
        if kind == "spot":
            light["spot"] = {"innerConeAngle": cones[0], "outerConeAngle": cones[1] or np.pi / 4}
        if reach > 0.0:
            light["range"] = reach
        matrix = np.eye(4)
        matrix[:3, :3] = _turn(direction)
        matrix[:3, 3] = position
        self._lights.append(light)
        self._use(_LIGHTS)
        self._node(name=name, matrix=matrix.T.ravel().tolist(), extensions={_LIGHTS: {"light": len(self._lights) - 1}})

    def write(self, path: str | os.PathLike[str]) -> None:
        tree = {key: value for key, value in self._json.items() if value != []}
        if self._lights:
            tree["extensions"] = {_LIGHTS: {"lights": self._lights}}
        tree["buffers"] = [{"byteLength": len(self._binary)}]
        text = json.dumps(tree).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self._binary) + bytes(-len(self._binary) % 4)
        with open(path, "wb") as f:
            f.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)))
            f.write(struct.pack("<I4s", len(text), b"JSON") + text)
            f.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)
