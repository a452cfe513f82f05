# SPDX-License-Identifier: MIT
"""How does a triangle mesh with a radiance at each vertex become a .glb, and come back? What `hemibake compare` and
probe_error.py judge: float positions, indices and _RADIOSITY, one primitive, no compression. Also writes the plain scenes of
scaling.py: positions, indices and materials."""

import json
import struct

import numpy

FLOAT, UINT32 = 5126, 5125


class Buffer:
    """Accessors in the order they are added, each in a view of its own."""

    def __init__(self):
        self.bytes, self.views, self.accessors = bytearray(), [], []

    def add(self, array, kind):
        array = numpy.ascontiguousarray(array, dtype="<u4" if kind == "SCALAR" else "<f4")
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": array.nbytes})
        accessor = {"bufferView": len(self.views) - 1, "componentType": UINT32 if kind == "SCALAR" else FLOAT,
                    "count": len(array), "type": kind}
        if kind == "VEC3":
            accessor.update(min=array.min(axis=0).tolist(), max=array.max(axis=0).tolist())
        self.bytes += array.tobytes()
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def write_glb(path, document, buffer):
    document = dict(document, asset={"version": "2.0"}, buffers=[{"byteLength": len(buffer.bytes)}], bufferViews=buffer.views,
                    accessors=buffer.accessors)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(buffer.bytes) + bytes(-len(buffer.bytes) % 4)
    with open(path, "wb") as f:
        f.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data)))
        f.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


def write_radiance(path, positions, triangles, radiance):
    buffer = Buffer()
    attributes = {"POSITION": buffer.add(positions, "VEC3"), "_RADIOSITY": buffer.add(radiance, "VEC3")}
    primitive = {"attributes": attributes, "indices": buffer.add(numpy.ravel(triangles), "SCALAR")}
    write_glb(path, {"scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}]},
              buffer)


def write_scene(path, parts, materials):
    """parts: (positions, triangles, material index), one node each; materials as glTF has them."""
    buffer, meshes = Buffer(), []
    for positions, triangles, material in parts:
        attributes = {"POSITION": buffer.add(positions, "VEC3")}
        meshes.append({"primitives": [{"attributes": attributes, "indices": buffer.add(numpy.ravel(triangles), "SCALAR"),
                                       "material": material}]})
    write_glb(path, {"scene": 0, "scenes": [{"nodes": list(range(len(meshes)))}], "materials": materials, "meshes": meshes,
                     "nodes": [{"mesh": k} for k in range(len(meshes))],
                     "extensionsUsed": ["KHR_materials_emissive_strength"]}, buffer)


def read_array(document, data, index):
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind = {FLOAT: "<f4", UINT32: "<u4", 5123: "<u2", 5121: "u1"}[accessor["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
    size = numpy.dtype(kind).itemsize * width
    stride = view.get("byteStride", size)
    begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return numpy.ndarray((accessor["count"], width), kind, data, begin, (stride, numpy.dtype(kind).itemsize)).copy()


def matrix_of(node):
    """Of a node with a matrix, or with a translation, rotation and scale."""
    if "matrix" in node:
        return numpy.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    result = numpy.eye(4)
    result[:3, :3] = turn * numpy.array(node.get("scale", (1, 1, 1)))
    result[:3, 3] = node.get("translation", (0, 0, 0))
    return result


def read_radiance(path):
    """Corners in the world [triangle, corner, axis] and radiance [triangle, corner, band] of a bake without Draco."""
    with open(path, "rb") as f:
        content = f.read()
    length = struct.unpack_from("<I", content, 12)[0]
    document, data = json.loads(content[20:20 + length]), content[28 + length:]
    corners, radiance = [], []

    def visit(index, parent):
        node = document["nodes"][index]
        matrix = parent @ matrix_of(node)
        for child in node.get("children", ()):
            visit(child, matrix)
        for primitive in document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else ():
            triangles = read_array(document, data, primitive["indices"]).reshape(-1, 3)
            positions = read_array(document, data, primitive["attributes"]["POSITION"]).astype(float)
            corners.append((positions @ matrix[:3, :3].T + matrix[:3, 3])[triangles])
            radiance.append(read_array(document, data, primitive["attributes"]["_RADIOSITY"]).astype(float)[triangles])

    for root in document["scenes"][document.get("scene", 0)]["nodes"]:
        visit(root, numpy.eye(4))
    return numpy.concatenate(corners), numpy.concatenate(radiance)
