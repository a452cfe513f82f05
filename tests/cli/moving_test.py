# SPDX-License-Identifier: MIT
"""What of an asset is baked? What moves at its rest pose, nothing that is hidden, one scene of several; and what is said, one line a
kind."""

import json
import math
import struct

import command
import gltf_file

TURN = [0, 0, 0, 1], [0, math.sin(0.5), 0, math.cos(0.5)]


def animate(scene, node, path="rotation", values=TURN, kind="VEC4"):
    """A second in which a node goes from one value to another."""
    times, moves = scene._add_accessor([0, 1], "SCALAR", gltf_file.FLOAT), scene._add_accessor(values, kind, gltf_file.FLOAT)
    scene.json["accessors"][times].update(min=[0], max=[1])
    scene.json["animations"] = [{"samplers": [{"input": times, "output": moves}],
                                 "channels": [{"sampler": 0, "target": {"node": node, "path": path}}]}]


def struct_float(x):
    return struct.unpack("f", struct.pack("f", x))[0]


class Bakes(command.CommandCase):
    def draft(self, scene, *arguments):
        self.write("scene.glb", scene.glb())
        ran = self.bake("scene.glb", "out.glb", "--quality", "draft", "--no-draco", "--scene-linear", "--report", "out.json",
                        *arguments)
        self.report = json.loads(self.read("out.json"))
        self.said = ran.stderr
        return gltf_file.Asset(self.path("out.glb"))

    def light(self, asset, node):
        return [asset.values(p["attributes"]["_RADIOSITY"]) for p in asset.primitives(node)]

    def materials(self, asset):
        """Of every primitive that a node shows."""
        return [asset.json["materials"][p["material"]] for node in asset.json["nodes"] if "mesh" in node
                for p in asset.json["meshes"][node["mesh"]]["primitives"]]

    def check_all_unlit(self, asset):
        for material in self.materials(asset):
            self.assertIn("KHR_materials_unlit", material.get("extensions", {}), material)


class Moving(Bakes):
    def test_an_animated_root_is_baked_as_if_nothing_moved(self):
        still, scene = gltf_file.room(), gltf_file.room()
        for one in (still, scene):
            one.json["nodes"].append({"name": "root", "children": [0, 1, 2]})
            one.json["scenes"][0]["nodes"] = [3]
        animate(scene, 3)
        plain, moving = self.draft(still), self.draft(scene)
        for node in ("room", "box", "lamp"):
            self.assertEqual(self.light(plain, node), self.light(moving, node))
        self.assertRegex(self.said, 'node 0 "room" and 2 more: animated, baked at its rest pose')
        channel, = moving.json["animations"][0]["channels"]
        sampler, = moving.json["animations"][0]["samplers"]
        self.assertEqual(channel, {"sampler": 0, "target": {"node": 3, "path": "rotation"}})
        self.assertEqual(moving.values(sampler["input"]), [(0,), (1,)])
        self.assertEqual(len(moving.values(sampler["output"])), 2)
        self.check_all_unlit(moving)

    def test_a_door_casts_a_shadow_and_is_lit_unless_left(self):
        scene = gltf_file.room()
        animate(scene, 1)
        self.check_all_unlit(self.draft(scene))
        self.assertEqual(self.light(self.draft(gltf_file.room()), "room"), self.light(self.draft(scene), "room"))
        left = self.draft(scene, "--moving", "leave")
        self.assertNotIn("COLOR_0", left.primitives("box")[0]["attributes"])
        self.assertIn('node 1 "box": not baked, animated', self.said)

    def test_what_is_hidden_neither_lights_nor_blocks(self):
        plain = gltf_file.room()
        hidden = gltf_file.room()
        hidden.add_mesh("hidden lamp", gltf_file.lamp(0.3, 1.5), 2)
        hidden.add_mesh("hidden box", gltf_file.box((-0.9, 0, -0.9), (-0.6, 1.8, -0.6)), 0)
        hidden.json["nodes"] += [
            {"name": "point", "translation": [0, 1, 0.5], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"name": "off", "children": [3, 4, 5], "extensions": {"KHR_node_visibility": {"visible": False}}},
            {"name": "on", "extensions": {"KHR_node_visibility": {"visible": True}}},
        ]
        hidden.json["scenes"][0]["nodes"] = [0, 1, 2, 6, 7]
        hidden.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 50}]}}
        hidden.json["extensionsUsed"] += ["KHR_lights_punctual", "KHR_node_visibility"]
        hidden.json["extensionsRequired"] = ["KHR_node_visibility"]
        expected, got = self.draft(plain), self.draft(hidden)
        for node in ("room", "box", "lamp"):
            self.assertEqual(self.light(expected, node), self.light(got, node))
        self.assertIn('node 6 "off": hidden (KHR_node_visibility)', self.said)
        self.assertEqual(got.json["nodes"][6], hidden.json["nodes"][6])
        self.assertNotIn("COLOR_0", got.primitives("hidden lamp")[0]["attributes"])
        self.assertIn("KHR_node_visibility", got.json["extensionsRequired"])

    def test_notes_are_one_line_a_kind(self):
        scene = gltf_file.room()
        for i in range(30):
            scene.json["materials"].append({**scene.json["materials"][0], "name": f"m{i}", "extensions": {
                "KHR_materials_clearcoat": {"clearcoatFactor": 0.5}, "KHR_materials_sheen": {}}})
            scene.add_mesh(f"tile {i}", gltf_file.box((-1 + i / 15, 0, 0.9), (-1 + (i + 1) / 15, 0.05, 1)), 3 + i)
        scene.json["extensionsUsed"] += ["KHR_materials_clearcoat", "KHR_materials_sheen"]
        self.draft(scene)
        for name in ("clearcoat", "sheen"):
            line, = [line for line in self.said.splitlines() if f"KHR_materials_{name}" in line]
            self.assertIn('material 3 "m0" and 29 more', line)


def cloth(side=8, size=0.8, height=0.6):
    """A square with vertices of its own, that faces up."""
    points = [[size * (x / side - 0.5), height, size * (z / side - 0.5)] for z in range(side + 1) for x in range(side + 1)]
    quads = [(z * (side + 1) + x, (z + 1) * (side + 1) + x) for z in range(side) for x in range(side)]
    return points, [t for a, b in quads for t in ((a, b, b + 1), (a, b + 1, a + 1))], [[0, 1, 0]] * len(points)


def skin(scene, mesh, node, lift):
    """Both joints lift by so much; vertices hang on one or the other."""
    count = scene.json["accessors"][scene.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"]]["count"]
    add = scene._add_accessor
    attributes = scene.json["meshes"][mesh]["primitives"][0]["attributes"]
    attributes["JOINTS_0"] = add([[v % 2, 1 - v % 2, 0, 0] for v in range(count)], "VEC4", 5121)
    attributes["WEIGHTS_0"] = add([[0.75, 0.25, 0, 0]] * count, "VEC4", gltf_file.FLOAT)
    nodes = scene.json["nodes"]
    nodes += [{"name": "joint", "translation": [0, lift, 0]}, {"name": "joint 2", "translation": [0, lift, 0]}]
    scene.json["scenes"][0]["nodes"].append(len(nodes) - 2)
    nodes[-2]["children"] = [len(nodes) - 1]  # joints have a root in common
    nodes[-1]["translation"] = [0, 0, 0]
    scene.json["skins"] = [{"joints": [len(nodes) - 2, len(nodes) - 1]}]
    nodes[node]["skin"] = 0


class Posed(Bakes):
    def lit_sheet(self, sides=False):
        scene = gltf_file.room()
        scene.json["materials"][0]["doubleSided"] = sides
        scene.add_mesh("sheet", cloth(), 0)
        return scene

    def test_what_is_skinned_is_lit_on_its_own_vertices_where_its_joints_are(self):
        plain = self.draft(self.lit_sheet())
        scene = self.lit_sheet()
        below = [[x, y - 0.25, z] for x, y, z in cloth()[0]]
        scene.json["meshes"][3]["primitives"][0]["attributes"]["POSITION"] = scene._add_accessor(below, "VEC3", gltf_file.FLOAT)
        skin(scene, 3, 3, 0.25)
        scene.json["nodes"][3]["translation"] = [5, 5, 5]  # which a skin does not follow
        baked = self.draft(scene)
        self.assertEqual(self.light(plain, "room"), self.light(baked, "room"))
        primitive, = baked.primitives("sheet")
        self.assertEqual(set(primitive["attributes"]) - {"COLOR_0", "_RADIOSITY"}, {"POSITION", "NORMAL", "JOINTS_0", "WEIGHTS_0"})
        self.assertEqual([p[1] for p in baked.values(primitive["attributes"]["POSITION"])][0], struct_float(0.35))
        attributes = primitive["attributes"]
        positions = [(x, struct_float(y + 0.25), z) for x, y, z in baked.values(attributes["POSITION"])]
        light = [row[0] for row in baked.values(attributes["_RADIOSITY"])]
        fine, = plain.primitives("sheet")
        found = {(round(x, 4), round(z, 4)): row[0] for (x, y, z), row in
                 zip(plain.values(fine["attributes"]["POSITION"]), plain.values(fine["attributes"]["_RADIOSITY"]))}
        pairs = [(a, found[key]) for (x, y, z), a in zip(positions, light) if (key := (round(x, 4), round(z, 4))) in found]
        self.assertGreater(len(pairs), 3)
        for got, right in pairs:
            self.assertAlmostEqual(got, right, delta=0.1 * right)  # colours of least squares, not of the point
        self.assertEqual(len(light), 81)
        self.assertIn('node 3 "sheet": skinned, baked at its rest pose', self.said)
        self.check_all_unlit(baked)
        left = self.draft(scene, "--moving", "leave")
        self.assertNotIn("COLOR_0", left.primitives("sheet")[0]["attributes"])

    def test_what_is_morphed_is_baked_in_the_shape_of_its_weights(self):
        plain = self.draft(self.lit_sheet())
        scene = self.lit_sheet()
        low = [[x, y - 0.5, z] for x, y, z in cloth()[0]]
        primitive = scene.json["meshes"][3]["primitives"][0]
        primitive["attributes"]["POSITION"] = scene._add_accessor(low, "VEC3", gltf_file.FLOAT)
        primitive["targets"] = [{"POSITION": scene._add_accessor([[0, 1, 0]] * 81, "VEC3", gltf_file.FLOAT)}]
        scene.json["meshes"][3]["weights"] = [0.5]
        baked = self.draft(scene)
        for near, far in zip(self.light(plain, "room")[0], self.light(baked, "room")[0]):
            self.assertAlmostEqual(near[0], far[0], delta=1e-3 * (1 + near[0]))  # 0.1 + 0.5 is 0.6 up to a float's rounding
        primitive, = baked.primitives("sheet")
        self.assertEqual(len(baked.values(primitive["targets"][0]["POSITION"])), 81)
        self.assertEqual(len(baked.values(primitive["attributes"]["COLOR_0"])), 81)

    def test_backs_of_what_is_posed_are_a_primitive_of_the_same_vertices(self):
        scene = self.lit_sheet(sides=True)
        skin(scene, 3, 3, 0)
        baked = self.draft(scene)
        front, back = baked.primitives("sheet")
        for name in ("POSITION", "JOINTS_0", "WEIGHTS_0"):
            self.assertEqual(front["attributes"][name], back["attributes"][name])
        triangles = [[i for i, in baked.values(p["indices"])] for p in (front, back)]
        self.assertEqual([triangles[0][i:i + 3][::-1] for i in range(0, len(triangles[0]), 3)],
                         [triangles[1][i:i + 3] for i in range(0, len(triangles[1]), 3)])
        above, below = (sum(row[0] for row in rows) for rows in self.light(baked, "sheet"))
        self.assertGreater(above, 1.5 * below)  # the lamp is above

    def test_levels_of_detail_are_lit_and_do_not_block(self):
        plain = gltf_file.room()
        scene = gltf_file.room()
        scene.add_mesh("box from afar", gltf_file.box((-0.24, 0, -0.24), (0.24, 0.49, 0.24)), 1)
        scene.json["scenes"][0]["nodes"].pop()
        scene.json["nodes"][1]["extensions"] = {"MSFT_lod": {"ids": [3]}}
        scene.json["extensionsUsed"] += ["MSFT_lod"]
        near, levels = self.draft(plain), self.draft(scene)
        for node in ("room", "box", "lamp"):
            self.assertEqual(self.light(near, node), self.light(levels, node))
        self.check_all_unlit(levels)
        (points, light), = [(levels.values(p["attributes"]["POSITION"]), levels.values(p["attributes"]["_RADIOSITY"]))
                            for p in levels.primitives("box from afar")]
        top = [row[0] for point, row in zip(points, light) if point[1] > 0.4]
        box, = [(levels.values(p["attributes"]["POSITION"]), levels.values(p["attributes"]["_RADIOSITY"]))
                for p in levels.primitives("box")]
        bright = max(row[0] for point, row in zip(*box) if point[1] > 0.45)
        self.assertGreater(max(top), 0.7 * bright)
        self.assertLessEqual(max(top), 1.01 * bright)


    def test_levels_of_a_material_share_the_light_and_keep_their_reflectance(self):
        scene, plain = gltf_file.room(), gltf_file.room()
        far, farther = scene.add_material("far", (0.25, 0.5, 0.125)), scene.add_material("farther", (0.0625, 0.5, 0.5))
        scene.json["materials"][1]["extensions"] = {"MSFT_lod": {"ids": [far, farther]}}
        scene.json["extensionsUsed"] += ["MSFT_lod"]
        near, levels = self.draft(plain), self.draft(scene)
        self.check_all_unlit(levels)
        primitive, = levels.primitives("box")
        materials = levels.json["materials"]
        copy = materials[primitive["material"]]
        ids = copy["extensions"]["MSFT_lod"]["ids"]
        self.assertEqual([materials[i]["name"] for i in ids], ["far", "farther"])
        for material, right in zip([materials[i] for i in ids], ((0.25, 0.5, 0.125), (0.0625, 0.5, 0.5))):
            self.assertIn("KHR_materials_unlit", material["extensions"])
            for got, c in zip(material["pbrMetallicRoughness"]["baseColorFactor"], right):
                self.assertAlmostEqual(got, c)


class Notes(Bakes):
    def test_what_materials_have_beside_is_one_line_a_kind(self):
        scene = gltf_file.room()
        for i in range(30):
            scene.add_mesh(f"block {i}", gltf_file.box((-0.9 + 0.06 * i, 1, 0.5), (-0.87 + 0.06 * i, 1.1, 0.6)), scene.add_material(f"m{i}", (0.5,) * 3))
            extensions = {"KHR_materials_sheen": {}, "KHR_materials_clearcoat": {}, "KHR_materials_specular": {}, "KHR_materials_ior": {}}
            scene.json["materials"][-1]["extensions"] = extensions
        scene.json["extensionsUsed"] += sorted(extensions)
        self.draft(scene)
        lines = [line for line in self.said.splitlines() if "KHR_materials" in line]
        for kind in ("sheen", "clearcoat", "specular"):
            found, = [line for line in lines if kind in line]
            self.assertRegex(found, r"\b(29 more|30)\b")


class Unlit(Bakes):
    def test_what_is_baked_already_stands_in_the_way(self):
        """A screen under the lamp that was baked before: the floor is as dark as under a black one."""
        screen = gltf_file.box((-0.8, 1.5, -0.8), (0.8, 1.6, 0.8))
        black, unlit = gltf_file.room(), gltf_file.room()
        for scene in (black, unlit):
            scene.add_mesh("screen", screen, scene.add_material("screen", (0, 0, 0)))
        unlit.json["materials"][3] = {"name": "screen", "extensions": {"KHR_materials_unlit": {}}}
        unlit.json["extensionsUsed"].append("KHR_materials_unlit")
        right = self.light(self.draft(black), "box")
        self.assertEqual(right, self.light(self.draft(unlit), "box"))
        self.assertIn('material 3 "screen": not baked, unlit: it stays, and stands in the way of light', self.said)
        unlit.json["asset"]["extras"] = {"hemibake": {"version": "1.0.0"}}
        self.assertEqual(right, self.light(self.draft(unlit), "box"))
        self.assertIn("already baked", self.said)

    def test_a_backdrop_around_all_else_does_not(self):
        scene = gltf_file.room()
        plain = self.light(self.draft(scene), "room")
        scene.add_mesh("sky", gltf_file.box((-50, -1, -50), (50, 50, 50), inward=True), 3)
        scene.json["materials"].append({"name": "sky", "extensions": {"KHR_materials_unlit": {}}})
        scene.json["extensionsUsed"].append("KHR_materials_unlit")
        self.assertEqual(plain, self.light(self.draft(scene), "room"))
        self.assertIn("an unlit backdrop around all else", self.said)
        self.assertIn("unlit: it stays, and stands in no light's way", self.said)


class Variants(Bakes):
    def sofa(self):
        """The box as a sofa that is red, blue or bare."""
        scene = gltf_file.room()
        scene.add_material("blue", (0.1, 0.1, 0.7))
        scene.json["meshes"][1]["primitives"][0]["extensions"] = {"KHR_materials_variants": {"mappings": [
            {"material": 1, "variants": [0]}, {"material": 3, "variants": [1]}]}}
        scene.json["extensions"] = {"KHR_materials_variants": {"variants": [{"name": "red"}, {"name": "blue"}, {"name": "bare"}]}}
        scene.json["extensionsUsed"] += ["KHR_materials_variants"]
        return scene

    def variants(self, asset):
        """Which name, shown how: by the primitive itself, then by each variant."""
        primitive, = asset.primitives("box")
        mappings = primitive["extensions"]["KHR_materials_variants"]["mappings"]
        materials = [asset.json["materials"][m["material"]] for m in (primitive, *mappings)]
        return primitive, [(m["name"], m["pbrMetallicRoughness"]["baseColorFactor"][:3]) for m in materials]

    def draft_whole(self, scene, *arguments):
        """No triangle is merged: how many are goes by the light of all that is shown, and the sofa of variants shows its irradiance."""
        return self.draft(scene, "--merge-error", 0, *arguments)

    def check_same_light(self, expected, baked):
        """Lists of a thousand rows: to print how they differ would take minutes."""
        self.assertTrue(self.light(expected, "room") == self.light(baked, "room"), "the room's light is another")

    def test_every_variant_has_its_baked_material_and_the_light_of_the_one_that_is_baked(self):
        baked = self.draft(self.sofa())
        self.check_same_light(self.draft_whole(gltf_file.room()), self.draft_whole(self.sofa()))
        primitive, variants = self.variants(baked)
        self.assertEqual(variants, [("red", [0.6, 0.1, 0.1]), ("red", [0.6, 0.1, 0.1]), ("blue", [0.1, 0.1, 0.7])])
        self.assertEqual([m["variants"] for m in primitive["extensions"]["KHR_materials_variants"]["mappings"]], [[0], [1]])
        self.assertEqual(baked.json["extensions"], self.sofa().json["extensions"])
        self.check_all_unlit(baked)
        light = baked.values(primitive["attributes"]["COLOR_0"])
        radiance = baked.values(primitive["attributes"]["_RADIOSITY"])
        self.assertEqual(len(light), len(radiance))
        shown = [(c[0] * 0.6, r[0]) for c, r in zip(light, radiance) if c[0] < 0.999]
        self.assertGreater(len(shown), 10)
        for got, right in shown:  # a fit of light times a reflectance is nearly that of their product, which is not all alike
            self.assertAlmostEqual(got, right, delta=0.02 * max(r for _, r in shown))

    def test_a_variant_is_baked_by_its_name(self):
        blue = gltf_file.room()
        blue.json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = [0.1, 0.1, 0.7, 1]
        baked = self.draft_whole(self.sofa(), "--variant", "blue")
        self.check_same_light(self.draft_whole(blue), baked)
        _, variants = self.variants(baked)
        self.assertEqual([name for name, _ in variants], ["blue", "red", "blue"])
        self.check_same_light(self.draft_whole(gltf_file.room()), self.draft_whole(self.sofa(), "--variant", "bare"))
        self.write("scene.glb", self.sofa().glb())
        ran = self.run_hemibake("bake", "scene.glb", "-o", "out.glb", "--variant", "green")
        self.assertEqual(ran.returncode, command.BAD_INPUT)
        self.assertIn("--variant: there is no variant 'green'; the asset has red, blue, bare", ran.stderr)


class Scenes(Bakes):
    def two_scenes(self):
        scene = gltf_file.room()
        scene.json["scenes"][0]["name"] = "day"
        scene.json["nodes"].append({"name": "room by night", "mesh": 0})
        scene.json["nodes"].append({"name": "moon", "translation": [0, 1.5, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        scene.json["scenes"].append({"name": "night", "nodes": [3, 4]})
        scene.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 3, "color": [0.4, 0.5, 1]}]}}
        scene.json["extensionsUsed"] += ["KHR_lights_punctual"]
        return scene

    def test_a_scene_is_chosen_by_name_or_number(self):
        day, night = self.draft(self.two_scenes()), self.draft(self.two_scenes(), "--scene", "night")
        self.assertIn("COLOR_0", day.primitives("room")[0]["attributes"])
        self.assertNotIn("COLOR_0", day.primitives("room by night")[0]["attributes"])
        self.assertNotIn("COLOR_0", night.primitives("room")[0]["attributes"])
        self.assertEqual((day.json["scene"], night.json["scene"]), (0, 1))  # what was baked is what opens
        light = self.light(night, "room by night")
        self.assertEqual(light, self.light(self.draft(self.two_scenes(), "--scene", "1"), "room by night"))
        self.assertGreater(sum(row[2] for row in light[0]), 1.5 * sum(row[0] for row in light[0]))  # the moon is blue
        self.assertIn('scene 0 "day": not baked, another scene is', self.said)

    def test_nodes_that_scenes_share_show_no_light_of_another(self):
        """The box stands in both scenes: by night it shows the night's light, or none."""
        def shared():
            scene = self.two_scenes()
            scene.json["scenes"][1]["nodes"].append(1)
            animate(scene, 1)
            return scene
        day = self.draft(shared())
        self.assertIn('node 1 "box": another scene shows it too, and gets a copy as it was', self.said)
        copy = day.json["nodes"][day.json["scenes"][1]["nodes"][2]]
        self.assertEqual(copy["name"], "box")
        primitive, = day.json["meshes"][copy["mesh"]]["primitives"]
        self.assertNotIn("COLOR_0", primitive["attributes"])
        self.assertEqual(day.json["materials"][primitive["material"]], shared().json["materials"][1])
        moved = [channel["target"]["node"] for channel in day.json["animations"][0]["channels"]]
        self.assertEqual(moved, [1, day.json["scenes"][1]["nodes"][2]])
        night = self.draft(shared(), "--scene", "night")
        both = self.draft(shared(), "--scene", "all")
        self.check_all_unlit(both)
        self.assertEqual(both.json["scene"], 0)
        of_both = [both.json["meshes"][both.json["nodes"][scene["nodes"][i]]["mesh"]]["primitives"][0]["attributes"]["_RADIOSITY"]
                   for scene, i in zip(both.json["scenes"], (1, 2))]
        self.assertEqual(both.values(of_both[0]), self.light(day, "box")[0])
        alone = night.json["nodes"][1]["mesh"]
        self.assertEqual(both.values(of_both[1]), night.values(night.json["meshes"][alone]["primitives"][0]["attributes"]["_RADIOSITY"]))

    def test_a_scene_that_is_not_there_is_refused_with_those_that_are(self):
        self.write("scene.glb", self.two_scenes().glb())
        for name in ("dusk", "2", "-1"):
            ran = self.run_hemibake("bake", "scene.glb", "-o", "out.glb", "--scene", name)
            self.assertEqual(ran.returncode, command.BAD_INPUT)
            self.assertIn(f"there is no scene '{name}'; the asset has 0 \"day\", 1 \"night\"", ran.stderr)


if __name__ == "__main__":
    command.main()
