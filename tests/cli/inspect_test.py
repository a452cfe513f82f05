# SPDX-License-Identifier: MIT
"""Does 'inspect' tell what a bake would do, before it does it?"""

import json
import math
import os

import command
import gltf_file
from command import BAD_INPUT, DONE, USAGE


class Inspect(command.CommandCase):
    def inspect(self, scene, *arguments, status=DONE):
        self.write("scene.glb", scene.glb())
        ran = self.succeed("inspect", "scene.glb", "--json", *arguments, status=status)
        self.assertEqual(self.left(), ["scene.glb"])
        return json.loads(ran.stdout)

    def test_areas_reflectances_and_power_are_those_of_the_room(self):
        """A 2 m room, a box of 0.5 m and a square lamp: all by hand."""
        told = self.inspect(gltf_file.room())
        materials = {one["name"]: one for one in told["materials"]}
        self.assertAlmostEqual(materials["white"]["area_m2"], 24.0, places=5)
        self.assertAlmostEqual(materials["red"]["area_m2"], 1.5, places=5)
        for value, truth in zip(materials["red"]["reflectance"], (0.6, 0.1, 0.1)):
            self.assertAlmostEqual(value, truth, places=6)
        lamp = materials["lamp"]
        for band in lamp["power_w"]:
            self.assertAlmostEqual(band, 10 * math.pi * lamp["area_m2"], places=4)
        self.assertEqual((told["meshes"], told["triangles"], told["sky_by_default"], told["problems"]), (3, 26, False, []))

    def test_power_is_what_a_bake_emits(self):
        told = self.inspect(gltf_file.room((3, 2, 1)))
        self.succeed("bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--report", "r.json")
        emitted = json.loads(self.read("r.json"))["energy"]["emitted"]
        self.assertAlmostEqual(told["power_w"] / emitted, 1.0, places=5)

    def test_what_is_to_be_minded_is_a_line_and_a_status(self):
        self.inspect(gltf_file.room(), "--strict")
        dark = gltf_file.room((0, 0, 0))
        self.assertIn("nothing gives light", self.inspect(dark, "--strict", status=BAD_INPUT)["problems"][0])
        lit = self.inspect(dark, "--strict", "--environment", "1,1,1", status=BAD_INPUT)
        self.assertTrue(lit["sky"])
        self.assertEqual([line[:23] for line in lit["problems"]], ["material 'lamp' reflect"])
        black = gltf_file.room()
        black.add_mesh("soot", gltf_file.box((0.5, 0, 0.5), (0.7, 0.2, 0.7)), black.add_material("soot", (0, 0, 0)))
        told = self.inspect(black, "--strict", status=BAD_INPUT)
        self.assertEqual(told["problems"], ["material 'soot' reflects nothing, and 0.24 m2 of it stay black"])
        self.inspect(black)

    def test_a_metal_is_told(self):
        scene = gltf_file.room()
        scene.json["materials"][1]["pbrMetallicRoughness"].update(metallicFactor=1.0, roughnessFactor=0.5)
        red = self.inspect(scene)["materials"][1]
        self.assertEqual((red["name"], red["metal"], red["black"]), ("red", True, False))
        self.assertAlmostEqual(red["reflectance"][0], 0.6 * 0.125, places=6)
        self.assertIn("metal: 12 % of its colour", self.succeed("inspect", "scene.glb").stdout)
        self.assertTrue(self.inspect(scene, "--metals", "black")["materials"][1]["black"])

    def test_what_is_forecast_is_what_a_bake_has(self):
        for method, more in (("rows", []), ("hybrid", []), ("hybrid", ["--element-size", "0.1"])):
            told = self.inspect(gltf_file.room(), "--quality", "draft", "--method", method, "--threads", 2, *more)["forecast"]
            self.succeed("bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--method", method, *more, "--report", "r.json")
            report = json.loads(self.read("r.json"))
            for name in ("out.glb", "r.json"):
                os.remove(self.path(name))
            self.assertEqual(told["method"], method)
            self.assertEqual(told["threads"], 2)
            self.assertAlmostEqual(told["seconds"], told["processor_s"] / 2)
            self.assertEqual(told["surfaces"], report["scene"]["surfaces"])
            # Adapting adds elements, of which a forecast knows nothing.
            self.assertLess(abs(math.log2(told["elements"] / report["scene"]["elements"])), 1, (told, report["scene"]))
            self.assertGreater(told["processor_s"], 0)

    def test_what_a_bake_refuses_is_refused(self):
        self.write("bad.glb", b"nothing")
        ran = self.run_hemibake("inspect", "bad.glb")
        self.assertEqual((ran.returncode, ran.stderr.count("\n"), ran.stdout), (BAD_INPUT, 1, ""))
        self.assertEqual(self.run_hemibake("inspect").returncode, USAGE)
        self.assertEqual(self.run_hemibake("inspect", "bad.glb", "--preview", "p.png").returncode, USAGE)


if __name__ == "__main__":
    command.main()
