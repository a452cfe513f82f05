# SPDX-License-Identifier: MIT
"""Where does fuzzing begin? Small valid files of each kind into a folder, one file name TARGET-NAME each: seeds.py FOLDER"""

import json
import os
import random
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
import command  # noqa: E402
import gltf_file  # noqa: E402

IES = """IESNA:LM-63-2002
TILT=NONE
1 1000 1 3 2 1 2 0 0 0
1 1 100
0 45 90
0 180
100 80 0
90 70 0
"""


CONFIG = """ocio_profile_version: 2
search_path: ""
roles: {scene_linear: lin, default: lin}
displays:
  screen:
    - !<View> {name: plain, colorspace: out}
colorspaces:
  - !<ColorSpace> {name: lin, isdata: false}
  - !<ColorSpace>
    name: out
    from_scene_reference: !<ExponentWithLinearTransform> {gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, 0.055, 0], direction: inverse}
"""


def small_room():
    """As calls.c reads it: a method, then a material that reflects and one that shines, and two squares that face each other."""
    grey, lamp, black = [0, 128, 128, 128], [2, 0, 255, 0, 255, 0, 255], [0, 0, 0, 0]

    def square(material, y, order):
        places = [x & 255 for corner in ((-16, y, -16), (-16, y, 16), (16, y, 16), (16, y, -16)) for x in corner]
        return [0, 1, 1, material] + places + list(order)
    return bytes([1, 1] + grey + lamp + black + black + square(0, 0, (0, 1, 2, 0, 2, 3)) + square(1, 16, (0, 2, 1, 0, 3, 2)))


def textured():
    scene = gltf_file.room()
    scene.json["images"] = [{"mimeType": "image/png", "bufferView": len(scene.json["bufferViews"])}]
    picture = gltf_file.png(4, 4, lambda x, y: (40 * x, 40 * y, 200))
    scene.json["bufferViews"].append({"buffer": 0, "byteOffset": len(scene.bin), "byteLength": len(picture)})
    scene.bin += picture
    scene.json["textures"] = [{"source": 0}]
    scene.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    scene.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]
    scene.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}, "intensity": 3}]}}
    scene.json["extensionsUsed"] = ["KHR_lights_punctual"]
    scene.json["nodes"].append({"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 2, 0, 1]})
    scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)
    return scene


def draco_chunks(glb):
    """Of a GLB with Draco: the bytes of each of its meshes."""
    length = struct.unpack_from("<I", glb, 12)[0]
    tree, binary = json.loads(glb[20:20 + length]), glb[28 + length:]
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            extension = primitive.get("extensions", {}).get("KHR_draco_mesh_compression")
            if extension:
                view = tree["bufferViews"][extension["bufferView"]]
                begin = view.get("byteOffset", 0)
                yield binary[begin:begin + view["byteLength"]]


def seeds():
    yield "gltf-room", gltf_file.room().glb()
    yield "gltf-textured", textured().glb()
    for name in ("pillar-room.glb",):
        with open(os.path.join(command.SAMPLES, name), "rb") as f:
            yield f"gltf-{name}", f.read()
    yield "image-rgb", gltf_file.png(3, 5, lambda x, y: (x, y, 9))
    yield "image-rgba16", gltf_file.png(4, 2, lambda x, y: (x, y, 9, 300), channels=4, bits=16)
    yield "hdr-flat", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + bytes(range(16))
    yield "hdr-runs", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\x00\x08" + b"\x88\x11" * 4
    yield "hdr-pfm", b"PF\n2 1\n-1.0\n" + struct.pack("<6f", *range(6))
    with open(os.path.join(command.SAMPLES, "l-room.vs3"), "rb") as f:
        yield "vs3-l-room", f.read()
    yield "hprb-two", command.probes([((0, 0, 0.9), (0, 1, 0), (1, 1, 1)), ((1, 0, 0), (0, 0, 1), (0.5, 0, 2))])
    yield "ies-spot", IES.encode()
    with open(os.path.join(command.ROOT, "color", "hemibake.ocio"), "rb") as f:
        yield "config-own", f.read()
    yield "config-small", CONFIG.encode()
    yield "meshopt-empty", bytes([0, 1, 1, 128]) + b"\xa0" + bytes(40) + b"\xe1" + bytes(30)
    dice = random.Random(1989)
    for kind, count in (("scene", 3), ("bake", 3), ("factor", 8), ("kept", 1), ("rows", 1), ("ckpt", 4)):
        for i in range(count):
            yield f"{kind}-{i}", bytes(dice.randrange(256) for _ in range(40 << (2 * i if kind in ("scene", "bake") else 0)))
    yield "bake-room", small_room()


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    found = list(seeds())
    truth = os.path.join(os.path.dirname(os.path.abspath(__file__)), "regressions")
    for name in os.listdir(truth) if os.path.isdir(truth) else ():
        with open(os.path.join(truth, name), "rb") as f:
            found.append((name, f.read()))
    for path in sys.argv[2:]:  # baked files, for their Draco
        with open(path, "rb") as f:
            data = f.read()
        found.append((f"gltf-{os.path.basename(path)}", data))
        found += [(f"draco-{i}-{os.path.basename(path)}", chunk) for i, chunk in enumerate(draco_chunks(data))]
    for name, data in found:
        with open(os.path.join(folder, name), "wb") as f:
            f.write(data)


if __name__ == "__main__":
    main()
