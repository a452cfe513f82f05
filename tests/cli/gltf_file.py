# SPDX-License-Identifier: MIT
"""How are small glTF scenes made, and how is an uncompressed one read back? Nothing but the standard library.

Scenes are y up, metres. A mesh is (positions, triangles) or (positions, triangles, normals); front faces are counter-clockwise.
"""

import json
import math
import os
import struct
import zlib

FLOAT, UINT32 = 5126, 5125
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
FORMATS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
LARGEST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}


class Scene:
    """One node and one mesh for each add_mesh; materials are shared by name."""

    def __init__(self):
        self.bin = bytearray()
        self.json = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "materials": [], "accessors": [], "bufferViews": [],
        }

    def add_material(self, name, rho, emission=(0, 0, 0)):
        material = {
            "name": name,
            "pbrMetallicRoughness": {"baseColorFactor": [*rho, 1.0], "metallicFactor": 0.0},
            "emissiveFactor": [min(e, 1.0) for e in emission],
        }
        strength = max(emission)
        if strength > 1.0:
            material["emissiveFactor"] = [e / strength for e in emission]
            material["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
            self.json["extensionsUsed"] = ["KHR_materials_emissive_strength"]
        self.json["materials"].append(material)
        return len(self.json["materials"]) - 1

    def _add_accessor(self, values, kind, component):
        flat = [x for value in values for x in (value if isinstance(value, (list, tuple)) else [value])]
        data = struct.pack(f"<{len(flat)}{FORMATS[component]}", *flat)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bin), "byteLength": len(data)})
        self.bin += data
        accessor = {"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component, "type": kind,
                    "count": len(values)}
        if kind == "VEC3":
            accessor["min"] = [min(v[k] for v in values) for k in range(3)]
            accessor["max"] = [max(v[k] for v in values) for k in range(3)]
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def add_mesh(self, name, mesh, material, mode=None):
        positions, triangles, *normals = mesh
        primitive = {"attributes": {"POSITION": self._add_accessor(positions, "VEC3", FLOAT)},
                     "indices": self._add_accessor([i for t in triangles for i in t], "SCALAR", UINT32),
                     "material": material}
        if normals:
            primitive["attributes"]["NORMAL"] = self._add_accessor(normals[0], "VEC3", FLOAT)
        if mode is not None:
            primitive["mode"] = mode
        self.json["meshes"].append({"name": name, "primitives": [primitive]})
        self.json["nodes"].append({"name": name, "mesh": len(self.json["meshes"]) - 1})
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def add_image(self, data):
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bin), "byteLength": len(data)})
        self.bin += data + b"\0" * (-len(data) % 4)
        view = len(self.json["bufferViews"]) - 1
        self.json.setdefault("images", []).append({"bufferView": view, "mimeType": "image/png"})
        self.json.setdefault("textures", []).append({"source": len(self.json["images"]) - 1})
        return self

    def glb(self):
        tree = {key: value for key, value in self.json.items() if value != []}  # glTF has no empty lists
        if self.bin:
            tree["buffers"] = [{"byteLength": len(self.bin)}]
        return glb(tree, bytes(self.bin))


def glb(tree, binary):
    """Bytes of a GLB; without a BIN chunk if there is no binary."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    if binary:
        chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


# ---- shapes ------------------------------------------------------------------------------------------------------------

def box(low, high, inward=False):
    """Eight vertices, twelve triangles; inward: a room."""
    positions = [[high[k] if corner >> k & 1 else low[k] for k in range(3)] for corner in range(8)]
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return positions, [t[::-1] for t in triangles] if inward else triangles


def lamp(half, y):
    """A square at height y that looks down."""
    positions = [[-half, y, -half], [half, y, -half], [half, y, half], [-half, y, half]]
    return positions, [(0, 1, 2), (0, 2, 3)]


def sphere(segments, center, radius, rings=None):
    """segments * 2 * (rings - 1) triangles with smooth normals; segments // 2 + 1 rings unless told. Has vertices
    doubled along a meridian as exporters have them for texture coordinates."""
    rings = rings or segments // 2 + 1
    normals, triangles = [], []
    for r in range(rings + 1):
        polar = math.pi * r / rings
        for s in range(segments + 1):
            around = 2 * math.pi * (s % segments) / segments
            normals.append((math.sin(polar) * math.cos(around), math.cos(polar), -math.sin(polar) * math.sin(around)))
    for r in range(rings):
        for s in range(segments):
            a, b = r * (segments + 1) + s, (r + 1) * (segments + 1) + s
            triangles += [(a, b, b + 1)] if r < rings - 1 else []
            triangles += [(a, b + 1, a + 1)] if r > 0 else []
    return [tuple(c + radius * x for c, x in zip(center, n)) for n in normals], triangles, normals


def room(emission=(10, 10, 10)):
    """A 2 m room with a lamp under its ceiling and a half-metre box on its floor: what most tests bake."""
    scene = Scene()
    white, red = scene.add_material("white", (0.7, 0.7, 0.7)), scene.add_material("red", (0.6, 0.1, 0.1))
    light = scene.add_material("lamp", (0, 0, 0), emission)
    scene.add_mesh("room", box((-1, 0, -1), (1, 2, 1), inward=True), white)
    scene.add_mesh("box", box((-0.25, 0, -0.25), (0.25, 0.5, 0.25)), red)
    scene.add_mesh("lamp", lamp(0.3, 1.9), light)
    return scene


# ---- reading -----------------------------------------------------------------------------------------------------------

class Asset:
    """A .glb, or a .gltf with its .bin beside it."""

    def __init__(self, path):
        with open(path, "rb") as f:
            data = f.read()
        if data[:4] == b"glTF":
            size, length = struct.unpack("<II", data[8:16])
            assert size == len(data), f"{path}: {len(data)} bytes, its header says {size}"
            self.json = json.loads(data[20:20 + length])
            self.bin = data[28 + length:]
        else:
            self.json = json.loads(data)
            with open(os.path.join(os.path.dirname(path), self.json["buffers"][0]["uri"]), "rb") as f:
                self.bin = f.read()
        assert len(self.bin) >= self.json["buffers"][0]["byteLength"], f"{path}: the buffer is cut short"

    def values(self, index):
        """Rows of an accessor; normalized integers as floats."""
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width, code = WIDTHS[accessor["type"]], FORMATS[accessor["componentType"]]
        size = struct.calcsize(f"<{width}{code}")
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", size)
        scale = LARGEST[accessor["componentType"]] if accessor.get("normalized") else 1
        rows = [struct.unpack_from(f"<{width}{code}", self.bin, start + i * stride) for i in range(accessor["count"])]
        return [tuple(x / scale for x in row) for row in rows] if scale != 1 else rows

    def primitives(self, node_name):
        for node in self.json["nodes"]:
            if node.get("name") == node_name:
                return self.json["meshes"][node["mesh"]]["primitives"]
        raise KeyError(node_name)


def png(width, height, pixel, size=None, channels=3, bits=8):
    """Bytes of a picture of 8 or 16 bits; pixel(row, column) has 3 channels or 4. size: what the header says instead."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + b"".join(c.to_bytes(bits // 8, "big") for x in range(width) for c in pixel(y, x)) for y in range(height))
    header = struct.pack(">IIBBBBB", *(size or (width, height)), bits, {3: 2, 4: 6}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
