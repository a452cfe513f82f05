# SPDX-License-Identifier: MIT
"""What does the baked asset keep, share and record? --keep-pbr, --keep-instances, copies, custom attributes, its own stamp."""

import json
import struct

import command
import gltf_file


def place(scene, mesh, at, name):
    """One more node that shows a mesh of the scene."""
    scene.json["nodes"].append({"name": name, "mesh": mesh, "translation": at})
    scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)


def room_of_boxes():
    """The room with a second box, the same mesh, in a darker corner."""
    scene = gltf_file.room()
    place(scene, 1, [0.625, 0, 0.625], "second")
    return scene


def add_attribute(scene, mesh, name, values, kind, component):
    primitive = scene.json["meshes"][mesh]["primitives"][0]
    primitive["attributes"][name] = scene._add_accessor(values, kind, component)


class Kept(command.CommandCase):
    def draft(self, scene, *arguments):
        self.write("scene.glb", scene.glb())
        ran = self.bake("scene.glb", "out.glb", "--quality", "draft", "--no-draco", "--report", "out.json", *arguments)
        self.report = json.loads(self.read("out.json"))
        self.said = ran.stderr
        return gltf_file.Asset(self.path("out.glb"))

    def colors(self, asset, node, name="COLOR_0"):
        primitive, = asset.primitives(node)
        return asset.values(primitive["attributes"][name])

    # ---- numbers ---------------------------------------------------------------------------------------------------

    def test_numbers_stay_as_they_are_written(self):
        """Whether they would be printed so or not: zeros at the end, more digits than a double has, exponents, wholes with a point."""
        numbers = ["1.50", "0.1", "-0.25", "1e3", "1.0", "-0.0", "12345.678901234567", "0.30000001192092896", "0.00001234", "0.0001234",
                   "9007199254740993", "2.5e-7", "123456789012.345", "0.12345678901234", "0.123456789012345", "0.1234567890123456", "8", "-7",
                   "1234567.80000000000000000001", "100000000000000000000.5", "4.35", "99999999999999.9"]
        binary = gltf_file.room().glb()
        size, = struct.unpack_from("<I", binary, 12)
        tree = json.loads(binary[20:20 + size])
        tree["nodes"][0]["extras"] = {"numbers": "here"}
        text = json.dumps(tree).replace('"here"', "[" + ",".join(numbers) + "]").encode()
        text += b" " * (-len(text) % 4)
        rest = binary[20 + size:]
        self.write("scene.glb", struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON") + text + rest)
        self.bake("scene.glb", "out.glb", "--quality", "draft")
        self.assertIn(('"numbers":[' + ",".join(numbers) + "]").encode(), self.read("out.glb"))

    # ---- instances ---------------------------------------------------------------------------------------------------

    def test_every_instance_has_its_own_light_and_the_cost_is_told(self):
        asset = self.draft(room_of_boxes())
        self.assertNotEqual(self.colors(asset, "box"), self.colors(asset, "second"))
        self.assertEqual(self.report["scene"]["mesh_copies"], 1)
        self.assertEqual(asset.json["asset"]["extras"]["hemibake"]["mesh_copies"], 1)
        self.assertRegex(self.said, "1 mesh is copied .*--keep-instances")

    def test_kept_instances_share_the_mean(self):
        own = self.draft(room_of_boxes(), "--scene-linear", "--merge-error", "0")
        first, second = self.colors(own, "box", "_RADIOSITY"), self.colors(own, "second", "_RADIOSITY")
        shared = self.draft(room_of_boxes(), "--scene-linear", "--keep-instances")
        nodes = {node["name"]: node for node in shared.json["nodes"]}
        self.assertEqual(nodes["box"]["mesh"], nodes["second"]["mesh"])
        self.assertEqual(self.report["scene"]["mesh_copies"], 0)
        self.assertNotIn("copied", self.said)
        found = self.colors(shared, "box", "_RADIOSITY")
        self.assertEqual(len(found), len(first))
        for mean, a, b in zip(found, first, second):
            for x, y, z in zip(mean, a, b):
                self.assertAlmostEqual(x, (y + z) / 2, delta=1e-6 * (1 + x))  # a float's rounding

    def test_a_larger_instance_takes_part_in_the_mean(self):
        """It is cut into other elements, so its light is looked up where its vertices are."""
        scene = room_of_boxes()
        scene.json["nodes"][-1]["scale"] = [0.5, 0.5, 0.5]
        own = self.draft(scene, "--scene-linear", "--merge-error", "0")
        alone = self.colors(own, "box", "_RADIOSITY")
        other = self.colors(own, "second", "_RADIOSITY")
        found = self.colors(self.draft(scene, "--scene-linear", "--keep-instances"), "box", "_RADIOSITY")
        self.assertEqual(len(found), len(alone))
        low = min(x for row in alone + other for x in row) / 1.000001  # a float's rounding
        high = max(x for row in alone + other for x in row) * 1.000001
        self.assertNotEqual(found, alone)
        for row, was in zip(found, alone):
            for x, y in zip(row, was):
                self.assertLessEqual(low, x)
                self.assertLessEqual(x, high)
                self.assertLessEqual((y + low) / 2 / 1.000001, x)
                self.assertLessEqual(x, (y + high) / 2 * 1.000001)

    def test_gpu_instances_are_lit_one_by_one(self):
        scene = gltf_file.room()
        moves = scene._add_accessor([[0, 0, 0], [0.625, 0, 0.625]], "VEC3", gltf_file.FLOAT)
        scene.json["nodes"][1]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": moves}}}
        scene.json["extensionsUsed"] = [*scene.json.get("extensionsUsed", []), "EXT_mesh_gpu_instancing"]
        asset = self.draft(scene)
        copies = [asset.json["nodes"][child] for child in asset.json["nodes"][1]["children"]]
        self.assertEqual(len(copies), 2)
        lights = [asset.values(asset.json["meshes"][node["mesh"]]["primitives"][0]["attributes"]["COLOR_0"]) for node in copies]
        nodes = room_of_boxes()
        nodes.json["scenes"][0]["nodes"] = [0, 1, 3, 2]  # the order of the copies, so that every sum is the same
        plain = self.draft(nodes)
        self.assertEqual(lights, [self.colors(plain, "box"), self.colors(plain, "second")])
        self.assertNotIn("EXT_mesh_gpu_instancing", asset.json["extensionsUsed"])

    # ---- materials ---------------------------------------------------------------------------------------------------

    def test_kept_materials_are_as_they_were_and_light_is_an_attribute(self):
        scene = gltf_file.room()
        normals = [[(1 if x > 0 else -1) * 3 ** -0.5 for x in p] for p in gltf_file.box((-1, -1, -1), (1, 1, 1))[0]]
        add_attribute(scene, 1, "NORMAL", normals, "VEC3", gltf_file.FLOAT)
        kept, linear = self.draft(scene, "--keep-pbr"), self.draft(scene, "--scene-linear")
        self.assertEqual(kept.json["materials"], scene.json["materials"])
        self.assertEqual(kept.json["extensionsUsed"], scene.json["extensionsUsed"])
        self.assertEqual(self.colors(kept, "box", "_RADIOSITY"), self.colors(linear, "box", "_RADIOSITY"))
        primitive, = kept.primitives("box")
        self.assertEqual(set(primitive["attributes"]), {"POSITION", "NORMAL", "_RADIOSITY"})
        for normal in self.colors(kept, "box", "NORMAL"):
            self.assertAlmostEqual(sum(x * x for x in normal), 1, delta=1e-6)  # three floats
        self.assertNotIn("NORMAL", kept.primitives("room")[0]["attributes"])  # it had none

    # ---- attributes --------------------------------------------------------------------------------------------------

    def test_custom_attributes_are_interpolated_and_ids_are_not(self):
        scene = gltf_file.room()
        positions = gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True)[0]
        add_attribute(scene, 0, "_HEIGHT", [p[1] for p in positions], "SCALAR", gltf_file.FLOAT)
        add_attribute(scene, 0, "_FEATURE_ID_0", list(range(8)), "SCALAR", 5121)
        asset = self.draft(scene)
        primitive, = asset.primitives("room")
        points = asset.values(primitive["attributes"]["POSITION"])
        heights = asset.values(primitive["attributes"]["_HEIGHT"])
        ids = asset.values(primitive["attributes"]["_FEATURE_ID_0"])
        self.assertGreater(len({h for h, in heights}), 2)
        for (x, y, z), (height,), (number,) in zip(points, heights, ids):
            self.assertAlmostEqual(height, y, delta=1e-5)  # a float's barycentric sum over a room of 2 m
            self.assertIn(number, range(8))

    def test_primitives_of_a_mesh_meet_after_draco(self):
        """Two halves of a floor, of different extents: what they share they still share, bit for bit."""
        scene = gltf_file.room()
        material = 0
        left = ([[-0.9, 0.5, -0.9], [-0.9, 0.5, 0.83], [0.1, 0.5, 0.83], [0.1, 0.5, -0.9]], [(0, 1, 2), (0, 2, 3)])
        right = ([[0.1, 0.5, -0.9], [0.1, 0.5, 0.83], [0.77, 0.5, 0.83], [0.77, 0.5, -0.9]], [(0, 1, 2), (0, 2, 3)])
        scene.add_mesh("halves", left, material)
        scene.add_mesh("spare", right, material)
        spare = scene.json["meshes"].pop()
        scene.json["nodes"].pop()
        scene.json["scenes"][0]["nodes"].pop()
        scene.json["meshes"][-1]["primitives"] += spare["primitives"]
        self.write("scene.glb", scene.glb())
        self.bake("scene.glb", "draco.glb", "--quality", "draft", "--draco-bits", "position=7")
        asset = gltf_file.Asset(self.path("draco.glb"))
        bounds = [asset.json["accessors"][p["attributes"]["POSITION"]] for p in asset.primitives("halves")]
        # The seam is the largest x of one and the least of the other; nothing else of the grid is near 0.1 at 7 bits.
        self.assertEqual(bounds[0]["max"][0], bounds[1]["min"][0])
        self.assertNotEqual(bounds[0]["max"][0], struct.unpack("f", struct.pack("f", 0.1))[0])

    # ---- the stamp ---------------------------------------------------------------------------------------------------

    def stamp(self, asset):
        return asset.json["asset"]["extras"]["hemibake"]

    def test_the_asset_records_version_options_and_digest(self):
        asset = self.draft(gltf_file.room(), "--seed", 7, "--threads", 1)
        stamp = self.stamp(asset)
        self.assertEqual(stamp["version"], self.report["hemibake"]["version"])
        self.assertEqual(stamp["options"], {"quality": "draft", "seed": "7", "no-draco": True})
        self.assertRegex(stamp["report_sha256"], r"\A[0-9a-f]{64}\Z")
        self.assertEqual(stamp["report_sha256"], self.report["hemibake"]["report_sha256"])
        self.assertEqual(asset.json["asset"]["generator"], f"hemibake {stamp['version']}")

    def test_the_digest_tells_bakes_apart(self):
        first = self.stamp(self.draft(gltf_file.room(), "--threads", 1))["report_sha256"]
        again = self.stamp(self.draft(gltf_file.room(), "--threads", 2))["report_sha256"]
        other = self.stamp(self.draft(gltf_file.room(), "--element-size", 0.3))["report_sha256"]
        self.assertEqual(first, again)
        self.assertNotEqual(first, other)

    def test_the_report_says_what_draco_did(self):
        self.write("scene.glb", gltf_file.room().glb())
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--report", "out.json", "--draco-bits", "position=11,color=9",
                  "--draco-level", 3)
        draco = json.loads(self.read("out.json"))["draco"]
        self.assertEqual(draco["bits"], {"position": 11, "normal": 10, "color": 9, "texcoord": 12})
        self.assertEqual(draco["level"], 3)
        # Half a step an axis of a 2 m room, and of colours that span at most 1; a float's rounding on top.
        self.assertTrue(0 < draco["max_position_error"] <= 3 ** 0.5 * 0.5 * 2 / (2 ** 11 - 1) + 1e-6)
        self.assertTrue(0 < draco["max_color_error"] <= 0.5 / (2 ** 9 - 1) + 1e-6)


if __name__ == "__main__":
    command.main()
