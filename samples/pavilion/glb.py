# SPDX-License-Identifier: MIT
"""How do named solids, materials and cameras become a .glb? The same bytes each time: nothing depends on hashes or dates.

The plan's (x, y, h) becomes glTF's (x, h, -y). No normals are written: every face is flat.
"""

import json
import math
import struct

FLOAT, UINT16 = 5126, 5123
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


def gltf_point(p):
    """Rounded to a micrometre, so that another machine's cosine gives the same bytes."""
    return tuple(round(v, 6) + 0.0 for v in (p[0], p[2], -p[1]))


class Glb:
    def __init__(self, materials):
        """materials: name -> (rho, radiance), rgb each; radiance in glTF's unit, 0 for what is no lamp."""
        self.bin = bytearray()
        self.names = list(materials)
        self.json = {
            "asset": {"version": "2.0", "generator": "samples/pavilion/build.py"},
            "extensionsUsed": ["KHR_materials_emissive_strength"],
            "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "cameras": [], "meshes": [],
            "materials": [self._material(name, *materials[name]) for name in self.names],
            "accessors": [], "bufferViews": [],
        }

    @staticmethod
    def _material(name, rho, radiance):
        made = {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*rho, 1.0], "metallicFactor": 0.0,
                                                       "roughnessFactor": 1.0}}
        strength = max(radiance)
        if strength > 0.0:
            made["emissiveFactor"] = [round(v / strength, 6) for v in radiance]
            made["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
        return made

    def _accessor(self, data, component, kind, count, target, **bounds):
        self.bin += b"\0" * (-len(self.bin) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bin), "byteLength": len(data), "target": target})
        self.bin += data
        self.json["accessors"].append({"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component,
                                       "type": kind, "count": count, **bounds})
        return len(self.json["accessors"]) - 1

    def _primitive(self, faces, material):
        points, indices = {}, []
        for corners in faces:
            fan = [points.setdefault(gltf_point(p), len(points)) for p in corners]
            for k in range(1, len(fan) - 1):
                indices += fan[0], fan[k], fan[k + 1]
        single = [struct.unpack("<3f", struct.pack("<3f", *p)) for p in points]
        bounds = {"min": [min(p[k] for p in single) for k in range(3)], "max": [max(p[k] for p in single) for k in range(3)]}
        position = self._accessor(struct.pack(f"<{3 * len(points)}f", *(v for p in points for v in p)), FLOAT, "VEC3",
                                  len(points), ARRAY_BUFFER, **bounds)
        index = self._accessor(struct.pack(f"<{len(indices)}H", *indices), UINT16, "SCALAR", len(indices),
                               ELEMENT_ARRAY_BUFFER)
        return {"attributes": {"POSITION": position}, "indices": index, "material": self.names.index(material)}

    def _add_node(self, node):
        self.json["nodes"].append(node)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def add_part(self, name, faces):
        """faces: [(corners, material)]; one primitive a material."""
        by_material = {}
        for corners, material in faces:
            by_material.setdefault(material, []).append(corners)
        primitives = [self._primitive(group, material) for material, group in by_material.items()]
        self.json["meshes"].append({"name": name, "primitives": primitives})
        self._add_node({"name": name, "mesh": len(self.json["meshes"]) - 1})

    def add_camera(self, name, eye, target, degrees):
        """Looks from eye to target, plan coordinates, upright; degrees: the vertical field of view."""
        eye, target = gltf_point(eye), gltf_point(target)
        back = [e - t for e, t in zip(eye, target)]
        back = [v / math.sqrt(sum(b * b for b in back)) for v in back]
        flat = math.hypot(back[0], back[2])
        right = [back[2] / flat, 0.0, -back[0] / flat]
        up = [back[1] * right[2], back[2] * right[0] - back[0] * right[2], -back[1] * right[0]]
        matrix = [*right, 0.0, *up, 0.0, *back, 0.0, *eye, 1.0]
        self.json["cameras"].append({"name": name, "type": "perspective", "perspective": {
            "yfov": round(math.radians(degrees), 6), "aspectRatio": 1.5, "znear": 0.05}})
        self._add_node({"name": name, "camera": len(self.json["cameras"]) - 1, "matrix": [round(v, 6) + 0.0 for v in matrix]})

    def bytes(self):
        self.json["buffers"] = [{"byteLength": len(self.bin)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.bin) + b"\0" * (-len(self.bin) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
