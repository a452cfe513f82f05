# SPDX-License-Identifier: MIT
"""How do meshes with normals, textures, lights and cameras become a .glb? Metres, y up; the same bytes each time."""

import json
import math
import struct
import zlib

FLOAT, UINT32 = 5126, 5125
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3"}


def png(width, height, texel):
    """Bytes of an eight-bit picture; texel(x, y) gives three numbers in [0,1], encoded as sRGB."""
    def code(v):
        v = min(max(v, 0.0), 1.0)
        return round(255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(code(v) for x in range(width) for v in texel(x, y)) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


class Glb:
    def __init__(self, generator):
        self.bin = bytearray()
        self.json = {"asset": {"version": "2.0", "generator": generator}, "scene": 0, "scenes": [{"nodes": []}], "nodes": []}

    def _append(self, key, value):
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def _use(self, name):
        used = self.json.setdefault("extensionsUsed", [])
        if name not in used:
            used.append(name)

    def _view(self, data):
        self.bin += b"\0" * (-len(self.bin) % 4)
        view = self._append("bufferViews", {"buffer": 0, "byteOffset": len(self.bin), "byteLength": len(data)})
        self.bin += data
        return view

    def _accessor(self, rows, kind):
        flat = [round(v, 6) + 0.0 if kind == FLOAT else v for row in rows for v in row]
        width = len(rows[0])
        made = {"bufferView": self._view(struct.pack(f"<{len(flat)}{'f' if kind == FLOAT else 'I'}", *flat)), "componentType": kind,
                "count": len(rows), "type": KINDS[width]}
        if width == 3:
            single = [struct.unpack("<3f", struct.pack("<3f", *(round(v, 6) + 0.0 for v in row))) for row in rows]
            made["min"], made["max"] = ([f(row[k] for row in single) for k in range(3)] for f in (min, max))
        return self._append("accessors", made)

    def texture(self, data):
        image = self._append("images", {"bufferView": self._view(data), "mimeType": "image/png"})
        return self._append("textures", {"source": image})

    def material(self, name, color, texture=None, emission=None, **more):
        """color: linear; emission: radiance, a band each."""
        made = {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*color, 1.0], "metallicFactor": 0.0}, **more}
        if texture is not None:
            made["pbrMetallicRoughness"]["baseColorTexture"] = {"index": texture}
        if emission:
            strength = max(1.0, *emission)
            made["emissiveFactor"] = [round(e / strength, 6) for e in emission]
            if strength > 1.0:
                self._use("KHR_materials_emissive_strength")
                made["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        return self._append("materials", made)

    def mesh(self, name, shape, material, translation=(0, 0, 0), turn=0.0, **more):
        """shape: (positions, normals or None, texture coordinates or None, triangles); turn: degrees about y; more: members of its node."""
        self.meshes(name, [(shape, material)], translation, turn, **more)

    def meshes(self, name, parts, translation=(0, 0, 0), turn=0.0, **more):
        """One mesh of several (shape, material): what meets in it also meets once its positions are packed."""
        half = math.radians(turn) / 2
        mesh = self._append("meshes", {"name": name, "primitives": [self._primitive(*part) for part in parts]})
        self._node({"name": name, "mesh": mesh, "translation": list(translation),
                    "rotation": [0.0, round(math.sin(half), 6), 0.0, round(math.cos(half), 6)], **more})

    def _primitive(self, shape, material):
        positions, normals, places, triangles = shape
        attributes = {"POSITION": self._accessor(positions, FLOAT)}
        if normals:
            attributes["NORMAL"] = self._accessor(normals, FLOAT)
        if places:
            attributes["TEXCOORD_0"] = self._accessor(places, FLOAT)
        return {"attributes": attributes, "indices": self._accessor([(i,) for t in triangles for i in t], UINT32), "material": material}

    def camera(self, name, eye, target, degrees):
        back = [e - t for e, t in zip(eye, target)]
        back = [v / math.sqrt(sum(b * b for b in back)) for v in back]
        flat = math.hypot(back[0], back[2])
        right = [back[2] / flat, 0.0, -back[0] / flat]
        up = [back[1] * right[2], back[2] * right[0] - back[0] * right[2], -back[1] * right[0]]
        lens = {"yfov": round(math.radians(degrees), 6), "aspectRatio": 1.6, "znear": 0.05}
        self._node({"name": name, "camera": self._append("cameras", {"name": name, "type": "perspective", "perspective": lens}),
                    "matrix": [round(v, 6) + 0.0 for v in (*right, 0.0, *up, 0.0, *back, 0.0, *eye, 1.0)]})

    def _node(self, node):
        self.json["scenes"][0]["nodes"].append(self._append("nodes", node))

    def write(self, path):
        self.json["buffers"] = [{"byteLength": len(self.bin)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.bin) + b"\0" * (-len(self.bin) % 4)
        with open(path, "wb") as f:
            f.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)))
            f.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)
