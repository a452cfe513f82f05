# SPDX-License-Identifier: MIT
"""Which assets does the pipeline bake? Writes twenty niches, each a box that is open in front with a lamp in its ceiling:
niche-01.gltf with its buffer niche-01.bin, and one texture that all of them use.

    python3 assets.py FOLDER
"""

import json
import os
import struct
import sys
import zlib

COUNT = 20

# A wall: four corners, counter-clockwise seen from inside a box from (0,0,0) to (1,1,1) whose front, z = 1, is open.
WALLS = {
    "floor": ((0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)),
    "ceiling": ((0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)),
    "left": ((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)),
    "right": ((1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)),
    "back": ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)),
}
LAMP = ((0.3, 0.99, 0.3), (0.7, 0.99, 0.3), (0.7, 0.99, 0.7), (0.3, 0.99, 0.7))
TEXCOORDS = ((0, 0), (1, 0), (1, 1), (0, 1))
INDICES = (0, 1, 2, 0, 2, 3)


def png(width, height, pixels):
    """An 8-bit rgb PNG of the bytes in pixels."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + pixels[3 * width * y : 3 * width * (y + 1)] for y in range(height))
    header = struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def plaster(size=16):
    return png(size, size, bytes(200 + (7 * x + 11 * y) % 40 for y in range(size) for x in range(size) for _ in range(3)))


def niche(number):
    """The JSON and the buffer of one niche; number says how wide and how tinted it is."""
    share = number / COUNT
    size = (1 + share, 2, 1.2)
    meshes, accessors, data = [], [], bytearray()

    def add(values, kind, component, code):
        # One view an accessor; all begin at multiples of four.
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": struct.calcsize(f"<{len(values)}{code}")})
        data.extend(struct.pack(f"<{len(values)}{code}", *values))
        data.extend(b"\0" * (-len(data) % 4))
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[kind]
        accessor = {"bufferView": len(views) - 1, "componentType": component, "type": kind, "count": len(values) // width}
        if kind == "VEC3":
            accessor["min"] = [min(values[k::3]) for k in range(3)]
            accessor["max"] = [max(values[k::3]) for k in range(3)]
        accessors.append(accessor)
        return len(accessors) - 1

    views = []
    indices = add(INDICES, "SCALAR", 5123, "H")
    texcoords = add([c for uv in TEXCOORDS for c in uv], "VEC2", 5126, "f")
    for name, corners in [*WALLS.items(), ("lamp", LAMP)]:
        positions = [p * s for corner in corners for p, s in zip(corner, size)]
        attributes = {"POSITION": add(positions, "VEC3", 5126, "f"), "TEXCOORD_0": texcoords}
        material = {"lamp": 2, "left": 1}.get(name, 0)
        meshes.append({"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": material}]})
    plain = {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.7, 0.7, 0.7, 1], "metallicFactor": 0}
    tinted = {"baseColorFactor": [0.7 - 0.5 * share, 0.3, 0.2 + 0.5 * share, 1], "metallicFactor": 0}
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": i, "name": mesh["name"]} for i, mesh in enumerate(meshes)],
        "meshes": meshes,
        "materials": [
            {"name": "plaster", "pbrMetallicRoughness": plain},
            {"name": "tinted", "pbrMetallicRoughness": tinted},
            {"name": "lamp", "emissiveFactor": [1, 0.9, 0.7], "pbrMetallicRoughness": {"metallicFactor": 0}},
        ],
        "textures": [{"source": 0}],
        "images": [{"uri": "plaster.png"}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"uri": f"niche-{number:02}.bin", "byteLength": len(data)}],
    }, bytes(data)


def write(folder, name, data):
    with open(os.path.join(folder, name), "wb") as f:
        f.write(data)


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    write(folder, "plaster.png", plaster())
    for number in range(1, COUNT + 1):
        asset, data = niche(number)
        write(folder, f"niche-{number:02}.bin", data)
        write(folder, f"niche-{number:02}.gltf", json.dumps(asset).encode())


main()
