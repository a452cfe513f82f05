# SPDX-License-Identifier: MIT
"""How does a document look with a lamp in it? A square as large as the scene hangs above it and shines down."""

import base64
import json
import os
import struct

IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]


def times(a, b):
    return [sum(a[4 * k + r] * b[4 * c + k] for k in range(4)) for c in range(4) for r in range(4)]


def local(node):
    if "matrix" in node:
        return node["matrix"]
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    s, t = node.get("scale", (1, 1, 1)), node.get("translation", (0, 0, 0))
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return [*(v for c in range(3) for v in (*(rows[r][c] * s[c] for r in range(3)), 0)), *t, 1]


def corners(document, mesh, world):
    for primitive in document.list("meshes")[mesh]["primitives"]:
        accessor = document.list("accessors")[primitive["attributes"]["POSITION"]]
        low, high = accessor.get("min", [-1] * 3), accessor.get("max", [1] * 3)
        for i in range(8):
            p = [(high if i >> k & 1 else low)[k] for k in range(3)] + [1]
            yield [sum(world[4 * c + r] * p[c] for c in range(4)) for r in range(3)]


def bounds(document, roots):
    low, high, stack = [1e30] * 3, [-1e30] * 3, [(n, IDENTITY) for n in roots]
    for _ in range(len(document.list("nodes"))):  # a tree, however wrong the file is
        if not stack:
            break
        index, world = stack.pop()
        node = document.list("nodes")[index]
        world = times(world, local(node))
        for p in corners(document, node["mesh"], world) if "mesh" in node else ():
            low, high = [min(*x) for x in zip(low, p)], [max(*x) for x in zip(high, p)]
        stack += [(child, world) for child in node.get("children", ())]
    return (low, high) if low[0] <= high[0] else ([0] * 3, [1] * 3)


def add_lamp(document):
    tree = document.json
    tree.setdefault("scenes", [{"nodes": []}])
    scene = tree["scenes"][tree.get("scene", 0)]
    low, high = bounds(document, scene.setdefault("nodes", []))
    size = max(1e-3, *(b - a for a, b in zip(low, high)))
    x, y, z = (low[0] + high[0]) / 2, high[1] + size / 2, (low[2] + high[2]) / 2
    half = size / 2
    square = [x - half, y, z - half, x + half, y, z - half, x + half, y, z + half, x - half, y, z + half]
    data = struct.pack("<12f6H", *square, 0, 1, 2, 0, 2, 3)
    exact = struct.unpack("<12f", data[:48])

    def add(name, value):
        tree.setdefault(name, []).append(value)
        return len(tree[name]) - 1

    buffer = add("buffers", {"byteLength": 60, "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()})
    first = add("bufferViews", {"buffer": buffer, "byteLength": 48, "target": 34962})
    second = add("bufferViews", {"buffer": buffer, "byteOffset": 48, "byteLength": 12, "target": 34963})
    position = add("accessors", {"bufferView": first, "componentType": 5126, "count": 4, "type": "VEC3",
                                 "min": [min(exact[k::3]) for k in range(3)], "max": [max(exact[k::3]) for k in range(3)]})
    index = add("accessors", {"bufferView": second, "componentType": 5123, "count": 6, "type": "SCALAR"})
    material = add("materials", {"name": "corpus lamp", "emissiveFactor": [1, 1, 1],
                                 "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}})
    mesh = add("meshes", {"primitives": [{"attributes": {"POSITION": position}, "indices": index, "material": material}]})
    scene["nodes"].append(add("nodes", {"name": "corpus lamp", "mesh": mesh}))
    used = tree.setdefault("extensionsUsed", [])
    if "KHR_materials_emissive_strength" not in used:
        used.append("KHR_materials_emissive_strength")


def write(document, path):
    """As what it was, .glb or .gltf, with the files it names linked beside it."""
    text = json.dumps(document.json).encode()
    if document.is_glb:
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        if document.bin:
            body = document.bin + b"\0" * (-len(document.bin) % 4)
            chunks += struct.pack("<I4s", len(body), b"BIN\0") + body
        text = struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
    for name in os.listdir(document.folder):
        link = os.path.join(os.path.dirname(path), name)
        if not os.path.lexists(link):
            os.symlink(os.path.abspath(os.path.join(document.folder, name)), link)
    with open(path, "wb") as f:
        f.write(text)
