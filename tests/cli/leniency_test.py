# SPDX-License-Identifier: MIT
"""Is what three.js, Babylon.js and Blender read though glTF does not allow it read here too, with a note? converters/gltf/README.md lists
what was compared."""

import json
import struct

import command
import gltf_file


class Leniency(command.CommandCase):
    def draft(self, data, *arguments):
        self.write("scene.glb", data)
        self.said = self.bake("scene.glb", "out.glb", "--quality", "draft", "--no-draco", "--scene-linear", *arguments).stderr
        return gltf_file.Asset(self.path("out.glb"))

    def light(self, asset, node):
        primitive, = asset.primitives(node)
        return asset.values(primitive["attributes"]["_RADIOSITY"])

    def setUp(self):
        super().setUp()
        self.plain = self.light(self.draft(gltf_file.room().glb()), "room")

    def check_alike(self, scene, note):
        self.assertEqual(self.plain, self.light(self.draft(scene.glb()), "room"))
        self.assertIn(note, self.said)

    def test_dracos_own_counts_hold(self):
        """Blender's exporters counted points before Draco split them at seams."""
        self.write("scene.glb", gltf_file.room().glb())
        self.bake("scene.glb", "packed.glb", "--quality", "draft", "--keep-pbr")
        data = self.read("packed.glb")
        length, = struct.unpack("<I", data[12:16])
        tree = json.loads(data[20:20 + length])
        whole = self.light(self.draft(data), "room")
        for less in (1, 5):
            for mesh in tree["meshes"]:
                for index in mesh["primitives"][0]["attributes"].values():
                    tree["accessors"][index]["count"] = max(1, tree["accessors"][index]["count"] - less)
            packed = self.draft(gltf_file.glb(tree, data[28 + length:]))
            self.assertEqual(whole, self.light(packed, "room"))
            self.assertIn("mesh 0, primitive 0 and 2 more: its Draco bytes hold other counts than its accessors say", self.said)

    def test_corners_that_make_no_triangle(self):
        scene = gltf_file.room()
        indices = scene.values = [i for t in gltf_file.box((0, 0, 0), (1, 1, 1), inward=True)[1] for i in t]
        scene.json["meshes"][0]["primitives"][0]["indices"] = scene._add_accessor(indices + [0, 1], "SCALAR", gltf_file.UINT32)
        self.check_alike(scene, "mesh 0, primitive 0: its last corners make no whole triangle, and are left out")

    def test_normals_that_say_nothing(self):
        """Where all of a mesh do it is baked as without; where some do those of its facets are taken there."""
        def baked(change, *arguments):
            scene = gltf_file.room()
            positions, triangles, normals = gltf_file.sphere(12, (0.6, 0.5, 0.6), 0.3)
            normals = change and [change(i, n) for i, n in enumerate(normals)]
            scene.add_mesh("ball", (positions, triangles, *([normals] if normals else [])), 0)
            for accessor in scene.json["accessors"]:
                if any(x - x != 0 for x in accessor.get("max", [])):
                    del accessor["min"], accessor["max"]
            return self.draft(scene.glb(), *arguments)

        nan, zero = float("nan"), (0, 0, 0)
        plain = self.light(baked(None), "ball")
        for name, change in (("zero", lambda i, n: zero), ("nan", lambda i, n: (nan,) * 3)):
            self.assertEqual(plain, self.light(baked(change), "ball"), name)
            self.assertIn("mesh 3, primitive 0: its normals are all 0 or not finite, and those of its facets are taken", self.said)
        smooth = self.light(baked(lambda i, n: n), "ball")
        some = {name: baked(lambda i, n, bad=bad: n if i % 3 else bad(n), "--keep-pbr")
                for name, bad in (("zero", lambda n: zero), ("nan", lambda n: (n[0], nan, n[2])))}
        self.assertIn("mesh 3, primitive 0: where its normals are 0 or not finite those of its facets are taken", self.said)
        light = self.light(some["zero"], "ball")
        self.assertEqual(light, self.light(some["nan"], "ball"))
        self.assertGreater(min(map(min, light)), 0.5 * min(map(min, smooth)))
        for primitive in some["zero"].primitives("ball"):
            for point, normal in zip(*(some["zero"].values(primitive["attributes"][name]) for name in ("POSITION", "NORMAL"))):
                out = sum(n * (p - c) for n, p, c in zip(normal, point, (0.6, 0.5, 0.6)))
                self.assertGreater(out, 0.2, "none points elsewhere than away from the ball's middle")

    def test_vertices_that_are_nowhere(self):
        scene = gltf_file.room()
        positions, triangles = gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True)
        primitive = scene.json["meshes"][0]["primitives"][0]
        primitive["attributes"]["POSITION"] = scene._add_accessor([*positions, [float("nan"), 0, 0]], "VEC3", gltf_file.FLOAT)
        scene.json["accessors"][primitive["attributes"]["POSITION"]].update(min=[-1, 0, -1], max=[1, 2, 1])
        primitive["indices"] = scene._add_accessor([i for t in [*triangles, (0, 1, 8)] for i in t], "SCALAR", gltf_file.UINT32)
        self.check_alike(scene, "triangles at vertices that are not finite are left out")

    def test_attributes_longer_than_positions_strides_of_any_width_and_empty_meshes(self):
        scene = gltf_file.room()
        positions, triangles = gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True)
        primitive = scene.json["meshes"][0]["primitives"][0]
        view = len(scene.json["bufferViews"])
        rows = b"".join(struct.pack("<3fxx", *p) for p in positions)
        scene.json["bufferViews"].append({"buffer": 0, "byteOffset": len(scene.bin), "byteLength": len(rows), "byteStride": 14})
        scene.bin += rows + b"\0" * (-len(rows) % 4)
        scene.json["accessors"][primitive["attributes"]["POSITION"]]["bufferView"] = view
        primitive["attributes"]["COLOR_0"] = scene._add_accessor([[1, 1, 1]] * 12, "VEC3", gltf_file.FLOAT)
        scene.json["meshes"] += [{"name": "nothing", "primitives": []}, {"name": "empty", "primitives": [
            {"attributes": {"POSITION": len(scene.json["accessors"])}}]}]
        scene.json["accessors"].append({"componentType": 5126, "type": "VEC3", "count": 0, "min": [0, 0, 0], "max": [0, 0, 0]})
        scene.json["nodes"] += [{"name": "nothing", "mesh": 3}, {"name": "empty", "mesh": 4}]
        scene.json["scenes"][0]["nodes"] += [3, 4]
        self.draft(scene.glb())
        self.assertIn("its byteStride is not a multiple of 4 up to 252", self.said)
        self.assertIn('node 4 "empty", primitive 0: not baked, empty', self.said)

    def test_matrices_factors_and_lights(self):
        scene = gltf_file.room()
        scene.json["nodes"][0]["matrix"] = [1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
        scene.json["materials"][0]["emissiveFactor"] = [0, -1, 0]
        scene.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": -5}]}}
        scene.json["extensionsUsed"].append("KHR_lights_punctual")
        scene.json["nodes"][1]["extensions"] = {"KHR_lights_punctual": {"light": 0}}
        self.check_alike(scene, "node 0: its matrix is not affine")
        self.assertIn("material 0: its emissiveFactor is negative, and counts as 0", self.said)
        self.assertIn("light 0: it takes light away", self.said)


class Profiles(command.CommandCase):
    def profile(self, vertical, horizontal, candela, multiplier=1, kind=1, head="IESNA:LM-63-2002\r\n[TEST] a lamp\r\n"):
        numbers = [1, 1000, multiplier, len(vertical), len(horizontal), kind, 2, 0, 0, 0, 1, 1, 10]
        rows = [numbers, vertical, horizontal, *candela]
        return (head + "TILT=NONE\r\n" + "\r\n".join(" ".join(map(str, row)) for row in rows)).encode()

    def floor(self, data, turn=None, **instance):
        """A black floor 2 m under a measured lamp; radiance is what falls on it times its reflectance over pi."""
        scene = gltf_file.Scene()
        scene.add_mesh("floor", ([[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]], [(0, 1, 2), (0, 2, 3)]),
                       scene.add_material("grey", (0.5, 0.5, 0.5)))
        self.write("lamp.ies", data)
        scene.json["extensions"] = {"EXT_lights_ies": {"lights": [{"uri": "lamp.ies"}]}}
        scene.json["extensionsUsed"] = ["EXT_lights_ies"]
        scene.json["nodes"].append({"name": "lamp", "translation": [0, 2, 0], "rotation": turn or [-0.5 ** 0.5, 0, 0, 0.5 ** 0.5],
                                    "extensions": {"EXT_lights_ies": {"light": 0, **instance}}})
        scene.json["scenes"][0]["nodes"].append(1)
        self.write("scene.glb", scene.glb())
        return self.run_hemibake("bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--no-draco", "--scene-linear",
                                 "--element-size", "0.125", "--merge-error", "0")

    def at(self, x, z):
        asset = gltf_file.Asset(self.path("out.glb"))
        primitive, = asset.primitives("floor")
        points, light = (asset.values(primitive["attributes"][name]) for name in ("POSITION", "_RADIOSITY"))
        return min(zip(points, light), key=lambda row: (row[0][0] - x) ** 2 + (row[0][2] - z) ** 2)[1]

    def right(self, candela, x, z):
        """0.5 / pi I cos / r^2."""
        square = x * x + z * z + 4
        return 0.5 / 3.141592653589793 * candela * 2 / square ** 1.5

    def test_candela_are_those_of_the_angles_and_between_them(self):
        self.assertEqual(self.floor(self.profile([0, 45, 90], [0], [[300, 200, 0]], 2), multiplier=1.5, color=[1, 0.5, 0]).returncode, 0)
        for x, candela in ((0, 900), (2, 600), (-2, 600), (0.5, 3 * (300 - 100 * 14.0362 / 45))):  # atan(0.25) is 14.0362 degrees
            red, green, blue = self.at(x, 0)
            self.assertAlmostEqual(red, self.right(candela, x, 0), delta=0.03 * red)  # a vertex is the mean around it
            self.assertAlmostEqual(green, red / 2, delta=1e-4 * red)
            self.assertEqual(blue, 0)
        asset = gltf_file.Asset(self.path("out.glb"))
        light, = asset.json["extensions"]["EXT_lights_ies"]["lights"]
        self.assertEqual(light["mimeType"], "application/x-ies-lm-63")  # packed, with what it was beside left behind

    def test_horizontal_angles_go_round_from_x(self):
        """One quarter of the round is bright: from +x towards +y of the node, which is -z of the world here."""
        data = self.profile([0, 90], [0, 89, 90, 270, 271, 360], [[100, 100], [100, 100], [0, 0], [0, 0], [0, 0], [0, 0]])
        self.assertEqual(self.floor(data).returncode, 0)
        bright, dark = self.at(1, -1)[0], [self.at(*p)[0] for p in ((1, 1), (-1, 1), (-1, -1))]
        self.assertAlmostEqual(bright, self.right(100, 1, 1), delta=0.05 * bright)
        self.assertLess(max(dark), 0.01 * bright)

    def test_what_cannot_be_used_is_named(self):
        good = self.profile([0, 90], [0], [[1, 1]])
        for data, why in ((b"hello", "no line TILT="), (good[:-4], "fewer candela"), (good.replace(b"0 90", b"90 0"), "vertical angles"),
                          (good.replace(b" 2 1 1 2", b" 99999 99999 1 2"), "cut short"), (good.replace(b"1 1000", b"1 x"), "thirteen"),
                          (good.replace(b"TILT=NONE", b"TILT=INCLUDE"), "TILT"), (self.profile([0, 90], [0], [[0, 0]]), "dark in every")):
            ran = self.floor(data)
            self.assertIn("profile 0: its light is left out, ", ran.stderr)
            self.assertIn(why, ran.stderr)
            self.assertNotIn("turn the", ran.stderr)


if __name__ == "__main__":
    command.main()
