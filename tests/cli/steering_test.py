# SPDX-License-Identifier: MIT
"""Do options that steer the light do what they say: bounces, ambient occlusion, the scale of what emits?

A closed box whose walls emit L and reflect rho shows, after N bounces, L (1 + rho + ... + rho^(N + 1)).
"""

import json

from command import BAD_INPUT, CommandCase, main
from gltf_file import Asset, Scene, box

L, RHO = 2.0, 0.5


def furnace():
    scene = Scene()
    scene.add_mesh("walls", box((0, 0, 0), (3, 2, 2), inward=True), scene.add_material("wall", (RHO,) * 3, (L,) * 3))
    return scene


def floor_and_ceiling(gap):
    """Two wide plates, one over the other; the lower is the first mesh."""
    scene = Scene()
    grey = scene.add_material("grey", (0.1, 0.1, 0.1))
    low = [[-5, 0, -5], [-5, 0, 5], [5, 0, 5], [5, 0, -5]]
    scene.add_mesh("floor", (low, [(0, 1, 2), (0, 2, 3)]), grey)
    scene.add_mesh("ceiling", ([[x, gap, z] for x, _, z in low], [(0, 2, 1), (0, 3, 2)]), grey)
    return scene


def two_squares():
    """Side by side under the same sky, each with a material of its own; "right" is the second node, mesh and material."""
    scene = Scene()
    for index, name in enumerate(("left", "right")):
        x = 3 * index
        positions = [[x, 0, 0], [x, 0, 2], [x + 2, 0, 2], [x + 2, 0, 0]]
        normals = [[0.6, 0.8, 0], [0.6, 0.8, 0], [-0.6, 0.8, 0], [-0.6, 0.8, 0]]
        scene.add_mesh(name, (positions, [(0, 1, 2), (0, 2, 3)], normals), scene.add_material(name, (0.5, 0.5, 0.5)))
    return scene


class Steering(CommandCase):
    def radiance(self, scene, *options):
        """[(position, radiance)] of the first mesh."""
        self.write("in.glb", scene.glb())
        self.ran = self.bake("in.glb", "out.glb", "--scene-linear", "--no-draco", "--merge-error", "0", "--quality", "draft",
                             "--element-size", "0.4", "--report", "report.json", *options)
        asset = Asset(self.path("out.glb"))
        attributes = asset.json["meshes"][0]["primitives"][0]["attributes"]
        return list(zip(asset.values(attributes["POSITION"]), asset.values(attributes["_RADIOSITY"])))

    def test_bounces_are_the_terms_of_the_series(self):
        for options, terms in ((["--direct-only"], 1), (["--bounces", "0"], 1), (["--bounces", "2"], 3)):
            expected = L * sum(RHO**k for k in range(terms + 1))
            found = [radiance[0] for _, radiance in self.radiance(furnace(), *options)]
            # Of one vertex the rays to emitters, eight at draft, are as noisy as the corner beside it is near.
            self.assertAlmostEqual(sum(found) / len(found), expected, delta=0.02 * expected, msg=options)
            report = json.loads(self.read("report.json"))
            self.assertEqual(report["solver"]["method"], "rows")
            self.assertLess(report["energy"]["residual_fraction"], 1e-4)
            # The box is closed: what seems to escape is noise of rays, and less than none cannot.
            self.assertTrue(0 <= report["energy"]["escaped"] < 0.01 * report["energy"]["emitted"], report["energy"])
            # The next bounces would be half of the light and more; nobody asked for them.
            self.assertLess(report["error"]["estimate"], 0.3)

    def test_methods_that_cannot_count_bounces_say_so(self):
        self.write("in.glb", floor_and_ceiling(1).glb())
        for options in (["--bounces", "1", "--method", "hybrid"], ["--ao", "--method", "hybrid"]):
            ran = self.run_hemibake("bake", "in.glb", "-o", "out.glb", *options)
            self.assertEqual(ran.returncode, BAD_INPUT)
            self.assertEqual(len(ran.stderr.splitlines()), 1)
            self.assertIn("method rows", ran.stderr)
        self.assertEqual(self.left(), ["in.glb"])

    def test_what_emits_is_scaled(self):
        once, twice = (self.radiance(furnace(), "--emissive-scale", x) for x in ("1", "2.5"))
        for (_, a), (_, b) in zip(once, twice):
            self.assertAlmostEqual(b[0], 2.5 * a[0], delta=1e-4 * b[0])

    def test_ambient_occlusion_is_the_share_of_the_sky_that_is_seen(self):
        def middle(gap, *options):
            found = self.radiance(floor_and_ceiling(gap), "--ao", *options)
            return min(found, key=lambda v: v[0][0] ** 2 + v[0][2] ** 2)[1][0]

        # Half a metre below a plate of ten only a rim of the sky is seen; past what is near, all of it.
        self.assertLess(middle(0.5, "--ao-distance", "100"), 0.02)
        self.assertAlmostEqual(middle(0.5, "--ao-distance", "0.4"), 1.0, delta=1e-3)
        # A plate at height h is hit within d where cos > h / d: what is seen is (h / d)^2.
        self.assertAlmostEqual(middle(0.5, "--ao-distance", "1"), 0.25, delta=0.03)
        # The diagonal is 14.2 m; a tenth of it reaches far enough.
        self.assertAlmostEqual(middle(0.5), (0.5 / 1.4151) ** 2, delta=0.03)
        asset = Asset(self.path("out.glb"))
        colors = asset.values(asset.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"])
        self.assertLess(max(c[0] for c in colors), 65536)


class Extras(CommandCase):
    """What extras.hemibake of nodes and materials ask."""

    def outcome(self, node=None, material=None, scene=None, *options):
        """The baked asset and what was said."""
        scene = scene or two_squares()
        if node is not None:
            scene.json["nodes"][1]["extras"] = {"hemibake": node}
        if material is not None:
            scene.json["materials"][1]["extras"] = {"hemibake": material}
        self.write("in.glb", scene.glb())
        ran = self.bake("in.glb", "out.glb", "--scene-linear", "--no-draco", "--uniform", "--environment", "1,1,1", "--method",
                        "hybrid", "--quality", "draft", "--element-size", "1", *options)
        return Asset(self.path("out.glb")), ran.stderr

    def primitive(self, asset, name):
        (node,) = [n for n in asset.json["nodes"] if n.get("name") == name]
        return asset.json["meshes"][node["mesh"]]["primitives"][0]

    def test_what_is_not_to_be_baked_stays_as_it_is(self):
        for asked in ({"node": {"bake": False}}, {"material": {"bake": 0}}):
            asset, said = self.outcome(**asked)
            self.assertNotIn("COLOR_0", self.primitive(asset, "right")["attributes"])
            self.assertIn("NORMAL", self.primitive(asset, "right")["attributes"])
            self.assertIn("COLOR_0", self.primitive(asset, "left")["attributes"])
            self.assertIn("not baked, as its extras ask; it stands in the way of light", said)

    def test_unlit_surfaces_are_said_to_block_where_they_do(self):
        def said(*nodes):
            scene = two_squares()
            scene.json["materials"][1]["extensions"] = {"KHR_materials_unlit": {}}
            scene.json["extensionsUsed"] = scene.json.get("extensionsUsed", []) + ["KHR_materials_unlit"]
            right = scene.json["nodes"][1]
            for i in range(1, len(nodes)):
                scene.json["nodes"].append(dict(right, name=f"right {i}", translation=[0, 0, 9 * i]))
                scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)
            for node, asked in zip([right, *scene.json["nodes"][-len(nodes) + 1:]], nodes):
                node["extras"] = {"hemibake": asked}
            line, = [line for line in self.outcome(None, None, scene)[1].splitlines() if "not baked, unlit" in line]
            return line.split("it stays, ")[1]

        out = {"bake": False, "castShadow": False}
        self.assertEqual(said({}), "and stands in the way of light")
        self.assertEqual(said(out), "and stands in no light's way")
        self.assertEqual(said(out, {}), "and stands in the way of light on 1 of 2 meshes")

    def test_what_is_not_baked_blocks_unless_it_is_to_cast_no_shadow(self):
        def middle(asked):
            scene = floor_and_ceiling(0.5)
            asset, _ = self.outcome(asked, None, scene)
            attributes = self.primitive(asset, "floor")["attributes"]
            found = zip(asset.values(attributes["POSITION"]), asset.values(attributes["_RADIOSITY"]))
            return min(found, key=lambda v: v[0][0] ** 2 + v[0][2] ** 2)[1][0]

        self.assertLess(middle({"bake": False}), 0.02)
        # Reflectance 0.1 under a sky of radiance 1.
        self.assertAlmostEqual(middle({"bake": False, "castShadow": False}), 0.1, delta=1e-3)

    def test_elements_have_the_size_that_is_asked_for(self):
        def triangles(**asked):
            asset, _ = self.outcome(**asked, scene=two_squares())
            return [asset.json["accessors"][self.primitive(asset, name)["indices"]]["count"] // 3 for name in ("left", "right")]

        self.assertEqual(triangles(), triangles(node={}))
        coarse, fine = triangles(node={"elementSize": 0.25})
        self.assertEqual(fine, 16 * coarse)
        self.assertEqual(triangles(node={"elementSize": 0.25}, material={"elementSize": 0.5}), [coarse, fine])

    def test_emission_is_scaled_or_set(self):
        def light(asked, *options):
            scene = Scene()
            scene.add_mesh("left", box((0, 0, 0), (1, 1, 1)), scene.add_material("left", (0, 0, 0)))
            scene.add_mesh("right", box((5, 0, 0), (6, 1, 1)), scene.add_material("right", (0, 0, 0), (2, 1, 0.5)))
            asset, _ = self.outcome(None, asked, scene, *options)
            return asset.values(self.primitive(asset, "right")["attributes"]["_RADIOSITY"])[0]

        for asked, expected in (({}, (2, 1, 0.5)), ({"emission": 3}, (6, 3, 1.5)), ({"emission": [1, 2, 3]}, (1, 2, 3))):
            for value, right in zip(light(asked), expected):
                self.assertAlmostEqual(value, right, delta=1e-5, msg=asked)
        self.assertAlmostEqual(light({"emission": 3}, "--emissive-scale", "2")[0], 12, delta=1e-4)

    def test_facets_are_shaded_flat_where_that_is_asked_for(self):
        def spread(node):
            asset, _ = self.outcome(node, None, None, "--sun", "90,45,10,0")
            values = [v[0] for v in asset.values(self.primitive(asset, "right")["attributes"]["_RADIOSITY"])]
            return max(values) / min(values)

        # A low sun lights a flat square evenly, and one by the normals that lean to it or away as they lean.
        self.assertAlmostEqual(spread({"normals": "faces"}), 1, delta=1e-3)
        self.assertGreater(spread({}), 1.3)

    def test_below_a_node_all_is_as_it_asks(self):
        scene = two_squares()
        scene.json["nodes"].append({"name": "above", "children": [0, 1], "extras": {"hemibake": {"elementSize": 0.5}}})
        scene.json["scenes"][0]["nodes"] = [2]
        asset, _ = self.outcome({"elementSize": 0.25}, None, scene)
        counts = [asset.json["accessors"][self.primitive(asset, name)["indices"]]["count"] for name in ("left", "right")]
        self.assertEqual(counts[1], 4 * counts[0])

    def test_what_is_not_understood_is_one_line_a_kind(self):
        for asked, line in (
            ({"bakes": False}, "extras.hemibake.bakes is not known"),
            ({"elementSize": -1}, "extras.hemibake.elementSize is not what that takes"),
            ({"normals": "smooth"}, "extras.hemibake.normals is not what that takes"),
            ({"emission": 2}, "extras.hemibake.emission is for materials"),
            ({"castShadow": False}, "castShadow false is for what has bake false too"),
            ("no", "extras.hemibake is no object"),
        ):
            _, said = self.outcome(asked)
            self.assertEqual(said.count(line), 1, said)


if __name__ == "__main__":
    main()
