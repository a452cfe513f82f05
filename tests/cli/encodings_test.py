# SPDX-License-Identifier: MIT
"""Is a scene the same however glTF writes it down? One floor, textured and coloured, under a lamp and a blocker: by every
component type, stride, sparse, strips, fans, files beside it; its light must be that of floats in one .glb."""

import base64
import json
import struct
import urllib.parse

from command import CommandCase, main
from gltf_file import FLOAT, LARGEST, Asset, Scene, glb, lamp, png

BYTE, UBYTE, SHORT, USHORT, UINT = 5120, 5121, 5122, 5123, 5125
FORMATS = {BYTE: "b", UBYTE: "B", SHORT: "h", USHORT: "H", UINT: "I", FLOAT: "f"}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}

SIDE = 4  # squares of the floor
# Numbers that bytes, shorts and floats all hold: multiples of 1/127 are none, so positions are integers under a scale.
POSITIONS = [(x, 0, z) for z in range(SIDE + 1) for x in range(SIDE + 1)]
COORDINATES = [(x / SIDE, z / SIDE) for x, _, z in POSITIONS]
COLORS = [((51, 255, 102)[x % 3], 204, 255, 255) for x, _, z in POSITIONS]  # of 255
TRIANGLES = [t for z in range(SIDE) for x in range(SIDE) for a in [z * (SIDE + 1) + x]
             for t in ((a, a + SIDE + 1, a + SIDE + 2), (a, a + SIDE + 2, a + 1))]
NAME = "böden 箱 💡"


class Written(Scene):
    """The floor at its node, with a lamp above and something between; how its accessors are written is asked for."""

    def __init__(self):
        super().__init__()
        white, light = self.add_material("white", (0.8, 0.8, 0.8)), self.add_material("lamp", (0, 0, 0), (9, 9, 9))
        self.add_mesh("lamp", lamp(0.4, 1.5), light)
        self.add_mesh("card", ([[-0.5, 0.7, -0.1], [-0.5, 0.7, 0.4], [0.2, 0.7, 0.4], [0.2, 0.7, -0.1]],
                               [(0, 1, 2), (0, 2, 3)]), white)
        self.add_image(png(16, 16, lambda row, column: (255, 200, 40 if (row ^ column) & 4 else 220)))
        floor = self.add_material("floor", (0.9, 0.8, 0.7))
        self.json["materials"][floor]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        self.texture = self.json["materials"][floor]["pbrMetallicRoughness"]["baseColorTexture"]
        self.attributes = {"POSITION": self.accessor(POSITIONS, FLOAT), "TEXCOORD_0": self.accessor(COORDINATES, FLOAT),
                           "COLOR_0": self.accessor([[c / 255 for c in color[:3]] for color in COLORS], FLOAT)}
        self.primitive = {"attributes": self.attributes, "material": floor,
                          "indices": self.accessor([(i,) for t in TRIANGLES for i in t], UINT)}
        self.json["meshes"].append({"name": NAME, "primitives": [self.primitive]})
        self.node = {"name": NAME, "mesh": 2, "translation": [-1, 0, -1], "scale": [2 / SIDE] * 3}
        self.json["nodes"].append(self.node)
        self.json["scenes"][0]["nodes"].append(2)

    def view(self, data, **more):
        self.bin += b"\0" * (-len(self.bin) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bin), "byteLength": len(data), **more})
        self.bin += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, rows, kind, normalized=False, stride=None, offset=0):
        """Elements at a stride, after some bytes that mean nothing; vertices begin at multiples of four."""
        rows = [tuple(r) for r in rows]
        size = struct.calcsize(f"<{len(rows[0])}{FORMATS[kind]}")
        scale = LARGEST[kind] if normalized else 1
        if stride is None and size % 4 and len(rows[0]) > 1:
            stride = (size + 3) // 4 * 4
        step = stride or size
        data = bytearray(b"\x7f" * (offset + step * (len(rows) - 1) + size))
        for i, row in enumerate(rows):
            values = [v * scale if kind == FLOAT else round(v * scale) for v in row]
            struct.pack_into(f"<{len(row)}{FORMATS[kind]}", data, offset + i * step, *values)
        made = {"bufferView": self.view(bytes(data), **({"byteStride": stride} if stride else {})), "byteOffset": offset,
                "componentType": kind, "count": len(rows), "type": KINDS[len(rows[0])], "normalized": normalized}
        if rows and len(rows[0]) == 3 and not normalized:
            made["min"], made["max"] = [min(r[k] for r in rows) for k in range(3)], [max(r[k] for r in rows) for k in range(3)]
        self.json["accessors"].append(made)
        return len(self.json["accessors"]) - 1

    def quantized(self):
        for key in ("extensionsUsed", "extensionsRequired"):
            self.json[key] = [*self.json.get(key, []), "KHR_mesh_quantization"]


class Encodings(CommandCase):
    def light(self, scene, *more):
        """{place in the world: radiance} of the floor."""
        if isinstance(scene, Written):
            self.write("in.glb", scene.glb())
        self.bake("in.glb" if isinstance(scene, Written) else scene, "out.glb", "--no-draco", "--scene-linear", "--quality",
                  "draft", "--uniform", *more)
        out = Asset(self.path("out.glb"))
        node = next(n for n in out.json["nodes"] if n.get("name") == NAME)
        self.assertEqual(out.json["meshes"][node["mesh"]]["name"], NAME)
        found = {}
        for primitive in out.json["meshes"][node["mesh"]]["primitives"]:
            for p, L in zip(*(out.values(primitive["attributes"][a]) for a in ("POSITION", "_RADIOSITY"))):
                world = [round(s * x + t, 4) for s, x, t in zip(node.get("scale", [1] * 3), p, node.get("translation", [0] * 3))]
                found[tuple(world)] = L
        self.assertGreater(max(L[0] for L in found.values()), 2 * min(L[0] for L in found.values()))
        return found

    def check(self, scene, what, delta):
        with self.subTest(what):
            found = self.light(scene)
            self.assertEqual(set(found), set(self.right))
            for place, L in self.right.items():
                for a, b in zip(L, found[place]):
                    self.assertAlmostEqual(a, b, delta=delta, msg=(what, place))

    def setUp(self):
        super().setUp()
        self.right = self.light(Written())

    # Floats through a scale of the node: the same numbers but for rounding.
    SAME = 1e-5

    def test_positions_by_every_component_type(self):
        for kind in (BYTE, UBYTE, SHORT, USHORT):
            scene = Written()
            scene.quantized()
            scene.attributes["POSITION"] = scene.accessor(POSITIONS, kind)
            self.check(scene, f"integers of type {kind}", self.SAME)
            scene = Written()
            scene.quantized()
            scene.attributes["POSITION"] = scene.accessor([[v / LARGEST[kind] for v in p] for p in POSITIONS], kind, True)
            scene.node["scale"] = [2 / SIDE * LARGEST[kind]] * 3
            self.check(scene, f"normalised integers of type {kind}", self.SAME)

    def test_strides_and_offsets(self):
        for kind, stride, offset in ((FLOAT, 12, 8), (FLOAT, 20, 4), (FLOAT, 252, 8), (SHORT, 8, 4), (BYTE, 4, 8), (BYTE, 28, 12)):
            scene = Written()
            if kind != FLOAT:
                scene.quantized()
            scene.attributes["POSITION"] = scene.accessor(POSITIONS, kind, stride=stride, offset=offset)
            self.check(scene, f"type {kind}, stride {stride}, offset {offset}", self.SAME)

    def test_sparse_positions(self):
        for kind in (UBYTE, USHORT, UINT):
            for based in (True, False):
                scene, moved = Written(), list(range(0, len(POSITIONS), 1 if not based else 3))
                index = scene.view(b"".join(struct.pack(f"<{FORMATS[kind]}", i) for i in moved))
                values = scene.view(b"".join(struct.pack("<3f", *POSITIONS[i]) for i in moved))
                base = [(9, 9, 9) if i in moved else p for i, p in enumerate(POSITIONS)]
                at = scene.accessor(base, FLOAT)
                sparse = scene.json["accessors"][at]
                sparse.update(min=[0, 0, 0], max=[SIDE, 0, SIDE], sparse={
                    "count": len(moved), "indices": {"bufferView": index, "componentType": kind}, "values": {"bufferView": values}})
                if not based:
                    del sparse["bufferView"], sparse["byteOffset"]
                scene.attributes["POSITION"] = at
                self.check(scene, f"sparse indices of type {kind}, {'on' if based else 'without'} a base", self.SAME)

    def test_indices_of_every_kind_and_none(self):
        corners = [i for t in TRIANGLES for i in t]
        for kind in (UBYTE, USHORT, UINT):
            scene = Written()
            scene.primitive["indices"] = scene.accessor([(i,) for i in corners], kind)
            self.check(scene, f"indices of type {kind}", self.SAME)
        scene = Written()
        del scene.primitive["indices"]
        for name, rows in (("POSITION", POSITIONS), ("TEXCOORD_0", COORDINATES), ("COLOR_0", [[v / 255 for v in c] for c in COLORS])):
            scene.attributes[name] = scene.accessor([rows[i] for i in corners], FLOAT)
        self.check(scene, "without indices", self.SAME)

    def test_strips_and_fans(self):
        scene, row = Written(), SIDE + 1
        strip = []
        for z in range(SIDE):  # rows joined by triangles without area
            line = [i for x in range(row) for i in (z * row + x, (z + 1) * row + x)]
            strip += ([strip[-1], line[0]] if strip else []) + line
        scene.primitive.update(mode=5, indices=scene.accessor([(i,) for i in strip], USHORT))
        self.check(scene, "a strip", 5e-3)  # the other diagonal of each square
        scene = Written()
        primitives = []
        for z in range(SIDE):
            for x in range(SIDE):
                a = z * row + x
                primitives.append(dict(scene.primitive, mode=6, indices=scene.accessor(
                    [(i,) for i in (a, a + row, a + row + 1, a + 1)], USHORT)))
        scene.json["meshes"][2]["primitives"] = primitives
        with self.subTest("fans"):
            self.assertEqual(set(self.light(scene)), set(self.right))

    def test_coordinates_and_colors_by_every_component_type(self):
        for kind in (UBYTE, USHORT):
            scene = Written()
            # Quarters are no multiples of 1/255: coordinates of 0, 1, 2 ... that the transform divides.
            scene.attributes["TEXCOORD_0"] = scene.accessor([[v * SIDE / LARGEST[kind] for v in c] for c in COORDINATES], kind, True)
            scene.texture["extensions"] = {"KHR_texture_transform": {"scale": [LARGEST[kind] / SIDE] * 2}}
            scene.json["extensionsUsed"].append("KHR_texture_transform")
            self.check(scene, f"normalised coordinates of type {kind}", self.SAME)
            for width in (3, 4):
                scene = Written()
                scene.attributes["COLOR_0"] = scene.accessor([[v / 255 for v in c[:width]] for c in COLORS], kind, True)
                self.check(scene, f"colours of type {kind}, {width} wide", self.SAME)
        for kind in (BYTE, UBYTE, SHORT, USHORT):
            scene = Written()
            scene.quantized()
            scene.attributes["TEXCOORD_0"] = scene.accessor([[v * SIDE for v in c] for c in COORDINATES], kind)
            scene.texture["extensions"] = {"KHR_texture_transform": {"scale": [1 / SIDE] * 2}}
            scene.json["extensionsUsed"].append("KHR_texture_transform")
            self.check(scene, f"coordinates of type {kind}", self.SAME)
        scene = Written()
        scene.attributes["TEXCOORD_1"] = scene.attributes.pop("TEXCOORD_0")
        scene.attributes["TEXCOORD_0"] = scene.accessor([(0, 0)] * len(POSITIONS), FLOAT)
        scene.texture["texCoord"] = 1
        self.check(scene, "the second set of coordinates", self.SAME)

    def test_files_beside_it_and_inside_it(self):
        whole = Written()
        view = whole.json["bufferViews"][whole.json["images"][0]["bufferView"]]
        picture = bytes(whole.bin[view["byteOffset"]:view["byteOffset"] + view["byteLength"]])
        for what, name, image in (("percent", "daten für%20 #1+1.bin", "bild 箱.png"), ("data", None, None)):
            tree = json.loads(json.dumps(whole.json))
            if name:
                self.write(name, bytes(whole.bin))
                self.write(image, picture)
                uris = [urllib.parse.quote(n, safe="") for n in (name, image)]
            else:
                uris = [f"data:{kind};base64," + base64.b64encode(data).decode()
                        for kind, data in (("application/gltf-buffer", whole.bin), ("image/png", picture))]
            tree["buffers"] = [{"byteLength": len(whole.bin), "uri": uris[0]}]
            tree["images"] = [{"uri": uris[1]}]
            self.write("in.gltf", json.dumps(tree).encode())
            self.check("in.gltf", what, self.SAME)
        self.write("in.glb", glb({**whole.json, "buffers": [{"byteLength": len(whole.bin)}], "images": [{"uri": uris[1]}]},
                                 bytes(whole.bin)))
        self.check("in.glb", "a data URI in a .glb", self.SAME)


if __name__ == "__main__":
    main()
