# SPDX-License-Identifier: MIT
"""Which colours does a bake solve in and write? --ocio, --input-space, --working-space and --scene-linear from outside."""

import json
import os

import command
import gltf_file

TREE = os.path.join(command.ROOT, "color")

# Floats in the file, and two matrices of float32 there and back: seven digits less the few that sums cost.
ROUNDING = 2e-5


def saturated_room():
    """Red walls, a green box and a white lamp: every bounce multiplies colours."""
    scene = gltf_file.Scene()
    red, green = scene.add_material("red", (0.7, 0.05, 0.05)), scene.add_material("green", (0.05, 0.7, 0.05))
    light = scene.add_material("lamp", (0, 0, 0), (10, 10, 10))
    scene.add_mesh("room", gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True), red)
    scene.add_mesh("box", gltf_file.box((-0.25, 0, -0.25), (0.25, 0.5, 0.25)), green)
    scene.add_mesh("lamp", gltf_file.lamp(0.3, 1.9), light)
    return scene


class Color(command.CommandCase):
    def setUp(self):
        super().setUp()
        self.write("scene.glb", gltf_file.room().glb())

    def linear(self, *arguments, **popen):
        """Rows of _RADIOSITY by node, and the report's part about colour."""
        # All triangles, so that bakes can be compared vertex by vertex.
        ran = self.run_hemibake("bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--scene-linear", "--no-draco",
                                "--merge-error", "0", "--report", "out.json", *arguments, **popen)
        self.assertEqual(ran.returncode, command.DONE, ran.stderr)
        asset = gltf_file.Asset(self.path("out.glb"))
        rows = {name: [row for primitive in asset.primitives(name)
                       for row in asset.values(primitive["attributes"]["_RADIOSITY"])] for name in ("room", "box", "lamp")}
        return rows, json.loads(self.read("out.json"))["color"], ran.stderr

    def largest_difference(self, a, b):
        """Of all bands of what reflects, as a part of the largest."""
        pairs = [(x, y) for name in ("room", "box") for p, q in zip(a[name], b[name]) for x, y in zip(p, q)]
        return max(abs(x - y) for x, y in pairs) / max(abs(x) for x, _ in pairs)

    def check_lamp(self, rows, expected):
        for row in rows["lamp"]:
            for x, e in zip(row, expected):
                self.assertAlmostEqual(x, e, delta=ROUNDING * max(map(abs, expected)))

    # ---- working space -----------------------------------------------------------------------------------------------

    def test_radiosity_in_rgb_depends_on_the_primaries(self):
        """Light of one bounce is a product of two spectra, and three bands of other primaries multiply otherwise."""
        self.write("scene.glb", saturated_room().glb())
        rec709, named, _ = self.linear()
        self.assertEqual(named["working_space"], "Linear Rec.709")
        acescg, named, _ = self.linear("--working-space", "ACEScg")
        self.assertEqual(named["working_space"], "ACEScg")
        difference = self.largest_difference(rec709, acescg)
        print(f"saturated room, Rec.709 against ACEScg: {100 * difference:.1f} % of the largest radiance")
        self.assertGreater(difference, 0.05)
        # What is only emitted is the same light in either.
        self.check_lamp(rec709, (10, 10, 10))
        self.check_lamp(acescg, (10, 10, 10))

    def test_a_grey_room_does_not_depend_on_them(self):
        scene = gltf_file.room()
        scene.json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = [0.3, 0.3, 0.3, 1]
        self.write("scene.glb", scene.glb())
        difference = self.largest_difference(self.linear()[0], self.linear("--working-space", "ACEScg")[0])
        print(f"grey room, Rec.709 against ACEScg: {100 * difference:.4f} % of the largest radiance")
        # Neutral colours stay neutral to the digits of the matrices, and bounces repeat the rounding.
        self.assertLess(difference, 1e-4)

    # ---- input space -------------------------------------------------------------------------------------------------

    def test_factors_are_read_in_the_space_that_is_named(self):
        scene = gltf_file.Scene()
        scene.add_material("dark", (0.1, 0.1, 0.1))
        lamp = scene.add_material("lamp", (0, 0, 0), (20, 10, 0))  # factor (1, 0.5, 0), strength 20
        scene.add_mesh("room", gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True), 0)
        scene.add_mesh("box", gltf_file.box((-0.2, 0, -0.2), (0.2, 0.5, 0.2)), 0)
        scene.add_mesh("lamp", gltf_file.lamp(0.3, 1.9), lamp)
        self.write("scene.glb", scene.glb())
        rows, named, _ = self.linear()
        self.assertEqual(named["input_space"], "linear Rec.709")
        self.check_lamp(rows, (20, 10, 0))
        rows, named, _ = self.linear("--input-space", "sRGB - Texture")
        self.assertEqual(named["input_space"], "sRGB - Texture")
        self.check_lamp(rows, (20, 20 * 0.2140411, 0))  # the curve is that of the factor, not of its product
        rows, named, _ = self.linear("--input-space", "file-rules")
        self.assertEqual(named["input_space"], "Linear Rec.709")
        self.check_lamp(rows, (20, 10, 0))
        # AP1 solved in AP1: negative bands of Rec.709 are real colours, kept in _RADIOSITY and clipped in COLOR_0.
        rows, named, warned = self.linear("--input-space", "ACEScg", "--working-space", "ACEScg")
        self.check_lamp(rows, (20 * (1.70505 - 0.5 * 0.62179), 20 * (-0.13026 + 0.5 * 1.14080), 20 * (-0.02400 - 0.5 * 0.12897)))
        self.assertGreater(named["clipped_fraction"], 0)
        self.assertIn("COLOR_0 is clamped", warned)

    def test_colours_that_the_working_space_cannot_hold_are_named(self):
        ran = self.bake("scene.glb", "out.glb", "--quality", "draft")
        self.assertEqual(ran.stderr, "")
        scene = gltf_file.room()
        scene.json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] = [0, 0.5, 0, 1]
        self.write("scene.glb", scene.glb())
        ran = self.bake("scene.glb", "out.glb", "--quality", "draft", "--input-space", "ACES2065-1")
        self.assertRegex(ran.stderr, r"(?m)^hemibake: scene\.glb: warning: material 'red' has a colour outside .*Linear Rec\.709")

    # ---- configuration -----------------------------------------------------------------------------------------------

    def config(self, old, new, name):
        with open(os.path.join(TREE, "hemibake.ocio"), encoding="utf-8") as f:
            text = f.read()
        self.assertIn(old, text)
        self.write(name, text.replace(old, new).encode())

    def test_the_configuration_decides_what_is_solved_in(self):
        self.config("scene_linear: Linear Rec.709", "scene_linear: ACEScg", "aces.ocio")
        self.assertEqual(self.linear("--ocio", "aces.ocio")[1]["working_space"], "ACEScg")

    def test_the_environment_names_a_configuration_and_the_option_wins(self):
        self.config("scene_linear: Linear Rec.709", "scene_linear: ACEScg", "aces.ocio")
        self.config("scene_linear: Linear Rec.709", "scene_linear: Linear Rec.2020", "wide.ocio")
        environment = dict(os.environ, OCIO=self.path("aces.ocio"))
        _, named, _ = self.linear(env=environment)
        self.assertEqual((named["config"], named["working_space"]), (self.path("aces.ocio"), "ACEScg"))
        _, named, _ = self.linear("--ocio", "wide.ocio", env=environment)
        self.assertEqual((named["config"], named["working_space"]), ("wide.ocio", "Linear Rec.2020"))

    def test_the_installed_file_is_the_configuration_inside(self):
        self.bake("scene.glb", "inside.glb", "--quality", "draft", "--view", "Filmic")
        self.bake("scene.glb", "file.glb", "--quality", "draft", "--view", "Filmic", "--ocio", os.path.join(TREE, "hemibake.ocio"))
        inside, from_file = (gltf_file.Asset(self.path(name)) for name in ("inside.glb", "file.glb"))
        for asset in (inside, from_file):
            del asset.json["asset"]["extras"]["hemibake"]  # options and digest name the file
        self.assertEqual(inside.json, from_file.json)
        self.assertEqual(inside.bin, from_file.bin)

    def refuse(self, *arguments, words, **popen):
        before = self.left()
        ran = self.run_hemibake("bake", "scene.glb", "-o", "refused.glb", *arguments, **popen)
        self.assertEqual(ran.returncode, command.BAD_INPUT, ran.stderr)
        self.assertRegex(ran.stderr, r"\Ahemibake: [^\n]+\n\Z")
        for word in words:
            self.assertIn(word, ran.stderr)
        self.assertEqual(self.left(), before)

    def test_what_is_wrong_with_colours_is_one_line(self):
        self.config('search_path: ""', "search_path: luts", "table.ocio")
        with open(self.path("table.ocio"), "a", encoding="utf-8") as f:
            f.write("\nlooks:\n  - !<Look> {name: lost, process_space: ACEScg, transform: !<FileTransform> {src: lost.cube}}\n")
        self.config("ocio_profile_version: 2", "ocio_profile_version: 2.71", "newer.ocio")
        self.refuse("--ocio", "table.ocio", "--look", "lost", words=["table.ocio", "lost.cube"])
        self.refuse("--ocio", "newer.ocio", words=["newer.ocio", "2.71", "2."])
        self.refuse("--ocio", "ocio://default", words=["ocio://default", "OpenColorIO 2.2"])
        self.refuse(env=dict(os.environ, OCIO="lost.ocio"), words=["lost.ocio"])
        self.refuse("--view", "Kodachrome", words=["Kodachrome", "Soft, Standard, ACES 1.x SDR, Filmic, Raw"])
        self.refuse("--display", "Kodachrome", words=["Kodachrome", "sRGB, Display P3"])
        self.refuse("--working-space", "Kodachrome", words=["Kodachrome", "Linear Rec.709, ACEScg"])
        self.refuse("--input-space", "Kodachrome", words=["Kodachrome", "Linear Rec.709, ACEScg"])
        self.refuse("--working-space", "sRGB - Texture", words=["not linear"])
        self.refuse("--working-space", "Raw", words=["data"])


if __name__ == "__main__":
    command.main()
