# SPDX-License-Identifier: MIT
"""Writes pillar-room.glb: the room that accuracy is measured in, whose sphere has facets as its path-traced truth, with normals that
make the sphere look round.

    python3 samples/pillar_room.py [FILE.glb]      default: samples/pillar-room.glb
"""

import json
import os
import struct
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
MEASURED = os.path.join(os.path.dirname(HERE), "tests", "accuracy", "truth", "pillar-room.glb")
HEADER = 28  # of the file, of its JSON and of what follows that


def smooth(data):
    """The same bytes but for the normals of the sphere."""
    data = bytearray(data)
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[HEADER - 8 : HEADER - 8 + size])
    sphere = next(mesh for mesh in document["meshes"] if mesh["name"] == "sphere")["primitives"][0]["attributes"]

    def begin_of(accessor):
        view = document["bufferViews"][accessor["bufferView"]]
        return HEADER + size + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)

    positions, normals = (document["accessors"][sphere[name]] for name in ("POSITION", "NORMAL"))
    points = [struct.unpack_from("<3f", data, begin_of(positions) + 12 * i) for i in range(positions["count"])]
    center = [(min(axis) + max(axis)) / 2 for axis in zip(*points)]
    for i, point in enumerate(points):
        out = [a - b for a, b in zip(point, center)]
        length = sum(a * a for a in out) ** 0.5
        struct.pack_into("<3f", data, begin_of(normals) + 12 * i, *(a / length for a in out))
    return bytes(data)


if __name__ == "__main__":
    with open(MEASURED, "rb") as measured:
        room = smooth(measured.read())
    with open(sys.argv[1] if len(sys.argv) > 1 else os.path.join(HERE, "pillar-room.glb"), "wb") as f:
        f.write(room)
