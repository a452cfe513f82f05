# SPDX-License-Identifier: MIT
"""Which light falls on a bake: punctual lights, sun, sky, or none at all? Measured on the radiance that comes out."""

import json
import math
import struct

from command import BAD_INPUT, NOT_CONVERGED, USAGE, CommandCase, main
from gltf_file import Asset, Scene, box, room


def floor(half=1.0):
    """A square that faces up, of reflectance 0.5."""
    scene = Scene()
    positions = [[-half, 0, -half], [-half, 0, half], [half, 0, half], [half, 0, -half]]
    scene.add_mesh("floor", (positions, [(0, 1, 2), (0, 2, 3)]), scene.add_material("grey", (0.5, 0.5, 0.5)))
    return scene


def add_light(scene, light, **node):
    """A light at a node of its own."""
    lights = scene.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
    lights.append(light)
    scene.json.setdefault("extensionsUsed", []).append("KHR_lights_punctual")
    scene.json["nodes"].append({"extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}, **node})
    scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)


def hdr(width, height, rgb):
    """Bytes of a Radiance picture, not run-length coded; rgb(row, column)."""
    def rgbe(color):
        top = max(color)
        if top < 1e-32:
            return bytes(4)
        mantissa, exponent = math.frexp(top)
        return bytes(int(c / top * mantissa * 256) for c in color) + bytes([exponent + 128])

    pixels = b"".join(rgbe(rgb(row, column)) for row in range(height) for column in range(width))
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + pixels


class Lights(CommandCase):
    def radiance(self, scene, *options, quality="draft", residual=1e-6):
        """[(position, radiance)] of all vertices of the first mesh, and the report."""
        self.write("in.glb", scene.glb())
        # All triangles, so that there are vertices all over each face to look at.
        self.ran = self.bake("in.glb", "out.glb", "--scene-linear", "--no-draco", "--merge-error", "0", "--quality", quality,
                             "--report", "report.json", *options)
        asset = Asset(self.path("out.glb"))
        primitive = asset.json["meshes"][0]["primitives"][0]
        with open(self.path("report.json")) as f:
            report = json.load(f)
        self.assertLess(report["energy"]["residual_fraction"], residual)
        attributes = primitive["attributes"]
        return list(zip(asset.values(attributes["POSITION"]), asset.values(attributes["_RADIOSITY"]))), report

    def check_radiance(self, found, expected, relative):
        for position, radiance in found:
            for value, right in zip(radiance, expected(position)):
                self.assertAlmostEqual(value, right, delta=relative * max(right, 1e-6), msg=position)

    def test_a_point_light_in_candela_gives_I_cos_by_r_squared_times_rho_by_pi(self):
        scene = floor()
        add_light(scene, {"type": "point", "color": [1, 0.5, 0.25], "intensity": 80}, translation=[0, 2, 0])
        found, report = self.radiance(scene)

        def expected(p):
            r = math.sqrt(p[0] ** 2 + 4 + p[2] ** 2)
            return [80 * c * 2 / r ** 3 * 0.5 / math.pi for c in (1, 0.5, 0.25)]

        # Linear over elements of 4 cm, and least squares: measured 0.2 %.
        self.check_radiance(found, expected, 0.005)
        self.assertEqual(report["arrived"]["punctual_lights"], 1)

    def test_a_directional_light_shines_along_minus_z_of_its_node(self):
        scene = floor()
        half = math.sin(math.radians(-60) / 2), math.cos(math.radians(-60) / 2)
        add_light(scene, {"type": "directional", "intensity": 10}, rotation=[half[0], 0, 0, half[1]])
        found, _ = self.radiance(scene)
        right = 10 * math.cos(math.radians(30)) * 0.5 / math.pi
        self.check_radiance(found, lambda p: [right] * 3, 1e-5)

    def test_a_spot_is_dark_outside_its_cone(self):
        scene = floor()
        add_light(scene, {"type": "spot", "intensity": 10, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.3}},
                  translation=[0, 2, 0], rotation=[-math.sqrt(0.5), 0, 0, math.sqrt(0.5)])
        found, _ = self.radiance(scene)
        zones = set()
        for position, radiance in found:
            off = math.atan(math.hypot(position[0], position[2]) / 2)
            zones.add("outside" if off > 0.4 else "inside" if off < 0.15 else "between")
            if off > 0.4:
                self.assertEqual(max(radiance), 0, position)
            if off < 0.15:
                self.assertGreater(min(radiance), 0.3, position)
        self.assertGreaterEqual(zones, {"outside", "inside"})

    def room_under(self, copies, *options):
        """Radiances of a room under 50 lights, each of so many copies of a share, by rows; and the report."""
        scene = Scene()
        grey = scene.add_material("grey", (0.5, 0.5, 0.5))
        scene.add_mesh("room", box((-2, 0, -2), (2, 2.5, 2), True), grey)
        scene.add_mesh("table", box((-0.5, 0.7, -0.3), (0.6, 0.8, 0.4)), grey)
        for i in range(50 * copies):
            at = [1.7 * math.sin(0.7 * (i // copies)), 1.2 + 0.02 * (i // copies), 1.7 * math.cos(1.9 * (i // copies))]
            add_light(scene, {"type": "point", "intensity": 10 / copies}, translation=at)
        found, report = self.radiance(scene, "--method", "rows", *options, residual=1e-4)
        return [radiance[1] for _, radiance in found], report

    def test_very_many_lights_are_drawn_from_and_give_what_they_give_one_by_one(self):
        # Vertices are the same, since lights cut no elements.
        few, one_by_one = self.room_under(1)
        for options in ((), ("--rows", self.path("kept.rows"))):
            many, report = self.room_under(4, *options)
            self.assertEqual(report["arrived"]["punctual_lights"], 200)
            self.assertLess(abs(report["arrived"]["punctual_w"] / one_by_one["arrived"]["punctual_w"] - 1), 0.005)
            self.assertLess(abs(report["energy"]["absorbed"] / one_by_one["energy"]["absorbed"] - 1), 0.005)
            self.assertLess(abs(sum(many) / sum(few) - 1), 0.005)
            # By pictures each copy of a light gives what the light does, to the last digit.
            self.assertGreater(max(abs(a / b - 1) for a, b in zip(many, few)), 1e-3)
            self.assertLess(report["error"]["estimate"], 0.05)

    def test_where_time_runs_out_some_of_the_lights_stand_for_all_of_them(self):
        scene = floor()
        for i in range(100):
            add_light(scene, {"type": "point", "intensity": 1}, translation=[math.sin(i), 1 + 0.01 * i, math.cos(1.7 * i)])
        sums = []
        for options, status in (((), 0), (("--time", 1e-3), NOT_CONVERGED)):
            self.write("in.glb", scene.glb())
            self.bake("in.glb", "out.glb", "--scene-linear", "--no-draco", "--quality", "draft", "--method", "hybrid", "--element-size", 0.2,
                      "--merge-error", 0, *options, status=status)
            asset = Asset(self.path("out.glb"))
            found = asset.values(asset.json["meshes"][0]["primitives"][0]["attributes"]["_RADIOSITY"])
            sums.append(sum(value[1] for value in found) / len(found))
        # A sixth of the pictures is looked at.
        self.assertLess(abs(sums[1] / sums[0] - 1), 0.1)
        self.assertNotEqual(*sums)

    def test_the_sun_stands_where_it_is_told_to(self):
        # A wall, 1 high, along x = 0: a sun in the east at 45 degrees puts the metre west of it into shadow.
        scene = floor()
        wall = ([[0, 0, -1], [0, 1, -1], [0, 1, 1], [0, 0, 1]], [(0, 1, 2), (0, 2, 3)])
        scene.add_mesh("wall", wall, scene.add_material("black", (0, 0, 0)))
        scene.json["materials"][1]["doubleSided"] = True
        found, _ = self.radiance(scene, "--sun", "90,45,100,0")
        lit = 100 * math.sqrt(0.5) * 0.5 / math.pi
        sides = set()
        for position, radiance in found:
            if abs(position[2]) < 0.9 and abs(position[0]) > 0.1:
                sides.add(position[0] > 0)
                self.assertAlmostEqual(radiance[0], lit if position[0] > 0 else 0, delta=1e-3, msg=position)
        self.assertEqual(sides, {True, False})

    def test_edges_of_shadows_without_end_are_not_followed_without_end(self):
        """Under a grating in the sun, by columns, unless finer elements are asked for."""
        scene = Scene()
        grey = scene.add_material("grey", (0.5, 0.5, 0.5))
        scene.add_mesh("floor", ([[-2, 0, -2], [-2, 0, 2], [2, 0, 2], [2, 0, -2]], [(0, 1, 2), (0, 2, 3)]), grey)
        for i in range(16):
            x = -2 + 0.25 * i
            bar = [[x, 0.3, 2], [x + 0.12, 0.3, 2], [x + 0.12, 0.3, -2], [x, 0.3, -2]]
            scene.add_mesh(f"bar{i}", (bar, [(0, 1, 2), (0, 2, 3)]), grey)
        self.write("in.glb", scene.glb())
        counts = []
        for options in ((), ("--refine-levels", "3")):
            self.bake("in.glb", "out.glb", "--quality", "medium", "--sun", "35,50,10", "--method", "hybrid", "--report", "out.json", *options)
            scene = json.loads(self.read("out.json"))["scene"]
            counts.append(scene["elements"] / scene["coarse_elements"])
        print("elements: %.1f and %.1f times as many as at first" % tuple(counts))
        self.assertLessEqual(counts[0], 10)
        self.assertGreater(counts[1], 10)

    def test_an_even_environment_gives_an_open_floor_rho_times_its_radiance(self):
        found, report = self.radiance(floor(), "--environment", "1,2,4")
        # E = pi L but for the rule of the lowest row of patches: tests/core/direct_light_test.c
        self.check_radiance(found, lambda p: [0.5, 1, 2], 1.5e-3)
        self.assertEqual(report["arrived"]["sky_patches"], 290)

    def test_where_time_runs_out_a_part_of_the_sky_stands_for_all_of_it(self):
        """64 of its 290 directions, spread over it."""
        self.write("in.glb", floor().glb())
        self.bake("in.glb", "out.glb", "--scene-linear", "--no-draco", "--quality", "draft", "--environment", "1,2,4",
                  "--time", 1e-3, status=NOT_CONVERGED)
        asset = Asset(self.path("out.glb"))
        for value in asset.values(asset.json["meshes"][0]["primitives"][0]["attributes"]["_RADIOSITY"]):
            for got, right in zip(value, (0.5, 1, 2)):
                # A sum over 64 directions that no row or column of the sky has more of.
                self.assertAlmostEqual(got, right, delta=0.02 * right)

    def test_a_panorama_of_one_colour_is_the_same_environment(self):
        self.write("sky.hdr", hdr(32, 16, lambda row, column: (1, 2, 4)))
        found, _ = self.radiance(floor(), "--environment", "sky.hdr")
        self.check_radiance(found, lambda p: [0.5, 1, 2], 2e-3)

    def test_the_sun_of_a_panorama_is_a_sun(self):
        """By rows, whose rays meet it once in ten thousands; a bar between it and a part of the floor has the shadow that geometry says."""
        row, column, size = 30, 40, (256, 128)
        bright = 5e4
        self.write("sky.hdr", hdr(*size, lambda r, c: (bright,) * 3 if (r, c) == (row, column) else (1, 2, 4)))
        high, low = (math.pi * (0.5 - r / size[1]) for r in (row, row + 1))
        flux = bright * 2 * math.pi / size[0] * (math.sin(high) - math.sin(low))
        altitude = (high + low) / 2
        for method in ("rows", "hybrid"):
            found, report = self.radiance(floor(), "--environment", "sky.hdr", "--method", method, residual=1e-3)
            self.assertGreater(flux, 10)
            self.check_radiance(found, lambda p: [0.5 / math.pi * (math.pi * L + flux * math.sin(altitude)) for L in (1, 2, 4)], 0.01)
            self.assertEqual((report["arrived"]["punctual_lights"], report["arrived"]["punctual_w"]), (0, 0))
        azimuth = 2 * math.pi * ((column + 0.5) / size[0] - 0.5)
        away = [-math.cos(azimuth) / math.tan(altitude), -math.sin(azimuth) / math.tan(altitude)]
        scene = floor()
        # A plate of 0.4 m across, 0.3 m up.
        plate = ([[x, 0.3, z] for x, z in ((-0.2, -0.2), (-0.2, 0.2), (0.2, 0.2), (0.2, -0.2))], [(0, 1, 2), (0, 2, 3)])
        scene.add_mesh("plate", plate, scene.add_material("black", (0, 0, 0)))
        scene.json["materials"][1]["doubleSided"] = True
        found, _ = self.radiance(scene, "--environment", "sky.hdr", "--method", "rows", residual=1e-2)
        of_sun, shaded = 0.5 / math.pi * flux * math.sin(altitude), 0
        for p, radiance in found:
            off = max(abs(p[0] - 0.3 * away[0]), abs(p[2] - 0.3 * away[1]))
            if off < 0.15:
                shaded += 1
                self.assertLess(radiance[0], 0.5 + 0.1 * of_sun, p)
            elif off > 0.25:
                self.assertGreater(radiance[0], 0.9 * of_sun, p)
        self.assertGreater(shaded, 3)

    def test_a_panorama_bright_in_the_west_lights_what_faces_west(self):
        scene = Scene()
        scene.add_mesh("box", box((-1, -1, -1), (1, 1, 1)), scene.add_material("grey", (0.5, 0.5, 0.5)))
        # Column 0 is -x, the middle +x.
        self.write("sky.hdr", hdr(64, 32, lambda row, column: (100, 100, 100) if column == 0 else (0, 0, 0)))
        found, _ = self.radiance(scene, "--environment", "sky.hdr")
        west = [r[0] for p, r in found if abs(p[0] + 1) < 1e-6 and abs(p[1]) < 0.9 and abs(p[2]) < 0.9]
        east = [r[0] for p, r in found if abs(p[0] - 1) < 1e-6 and abs(p[1]) < 0.9 and abs(p[2]) < 0.9]
        self.assertGreater(min(west), 0.1)
        self.assertEqual(max(east), 0)

    def test_the_environment_of_the_asset_lights_it(self):
        scene = floor()
        # Irradiance pi in every direction: radiance 1. The coefficient times Y00 is the irradiance.
        zero = [[math.pi / 0.282094792] * 3] + [[0, 0, 0]] * 8
        scene.json["extensions"] = {"EXT_lights_image_based": {"lights": [{
            "irradianceCoefficients": zero, "intensity": 3, "specularImageSize": 1, "specularImages": [[0] * 6]}]}}
        scene.json["extensionsUsed"] = ["EXT_lights_image_based"]
        scene.json["scenes"][0]["extensions"] = {"EXT_lights_image_based": {"light": 0}}
        found, _ = self.radiance(scene)
        self.check_radiance(found, lambda p: [1.5] * 3, 2e-3)

    def test_a_scene_without_any_light_is_lit_by_a_sky_and_says_so(self):
        found, report = self.radiance(floor())
        self.check_radiance(found, lambda p: [0.5] * 3, 1.5e-3)
        self.assertTrue(report["arrived"]["sky_by_default"])
        self.assertIn("a sky of radiance 1 lights it", self.ran.stderr)
        self.assertEqual(self.ran.stderr.count("\n"), 1)

    def test_a_lamp_that_is_there_keeps_the_sky_away(self):
        self.write("in.glb", room().glb())
        ran = self.bake("in.glb", "out.glb", "--quality", "draft", "--report", "report.json")
        self.assertEqual(ran.stderr, "")
        with open(self.path("report.json")) as f:
            self.assertEqual(json.load(f)["arrived"]["sky_patches"], 0)

    def test_lights_stay_in_the_asset(self):
        scene = floor()
        add_light(scene, {"type": "point", "intensity": 80}, translation=[0, 2, 0])
        self.radiance(scene)
        out = Asset(self.path("out.glb")).json
        self.assertEqual(out["extensions"], scene.json["extensions"])
        self.assertIn("KHR_lights_punctual", out["extensionsUsed"])


class BadLights(CommandCase):
    def refuse(self, scene, *options, says, status=BAD_INPUT):
        self.write("in.glb", scene.glb())
        ran = self.run_hemibake("bake", "in.glb", "-o", "out.glb", "--quality", "draft", *options)
        self.assertEqual(ran.returncode, status, ran.stderr)
        self.assertEqual(ran.stderr.count("\n"), 1, ran.stderr)
        self.assertIn(says, ran.stderr)
        self.assertNotIn("out.glb", self.left())

    def test_a_malformed_sun_is_wrong_usage(self):
        for sun in ("", "1", "1,2", "1,2,x", "1,91,3", "1,2,-3", "1,2,3,46", "1,2,3,4,5", "1,2,inf", "1,2,nan"):
            self.refuse(floor(), "--sun", sun, says="AZIMUTH,ELEVATION,LUX", status=USAGE)

    def test_a_malformed_environment_is_one_line(self):
        self.refuse(floor(), "--environment", "nowhere.hdr", says="nowhere.hdr: --environment: cannot be opened: No such file")
        self.refuse(floor(), "--environment", "1,2,-3", says="R,G,B or a panorama")
        self.refuse(floor(), "--environment", ".", says="R,G,B or a panorama")
        whole = hdr(32, 16, lambda row, column: (1, 2, 4))
        bomb = whole.replace(b"-Y 16 +X 32", b"-Y 60000 +X 60000")
        for name, data in (("empty", b""), ("short", whole[:600]), ("text", b"hello"), ("bomb", bomb)):
            self.write(name + ".hdr", data)
            self.refuse(floor(), "--environment", name + ".hdr", says=name + ".hdr: --environment: it ")

    def test_malformed_lights_are_named_by_their_place(self):
        def scene(light, index=0):
            made = floor()
            add_light(made, light)
            made.json["nodes"][-1]["extensions"]["KHR_lights_punctual"]["light"] = index
            return made

        point = {"type": "point"}
        self.refuse(scene(point, 1), says="nodes[1].extensions.KHR_lights_punctual.light")
        self.refuse(scene(point, "a"), says="nodes[1].extensions.KHR_lights_punctual.light")
        self.refuse(scene(point, 2**31), says="nodes[1].extensions.KHR_lights_punctual.light is not an integer")
        self.refuse(scene({"type": "point", "color": [1, 1]}), says="lights[0].color")
        self.refuse(scene({"type": "lamp"}), says="lights[0].type")
        self.refuse(scene({"type": 3}), says="lights[0].type")
        self.refuse(scene({}), says="lights[0].type")

    def test_spots_without_a_cone_have_gltfs_and_closed_ones_are_left_out(self):
        def lit(light):
            scene = floor()
            add_light(scene, {"type": "spot", "intensity": 100, **light}, translation=[0, 2, 0], rotation=[-0.5 ** 0.5, 0, 0, 0.5 ** 0.5])
            self.write("scene.glb", scene.glb())
            ran = self.bake("scene.glb", "out.glb", "--quality", "draft", "--scene-linear", "--no-draco")
            primitive, = Asset(self.path("out.glb")).primitives("floor")
            return Asset(self.path("out.glb")).values(primitive["attributes"]["_RADIOSITY"]), ran.stderr

        default, _ = lit({"spot": {}})
        bare, said = lit({})
        self.assertEqual(bare, default)
        self.assertIn("a spot without a cone", said)
        _, said = lit({"spot": {"innerConeAngle": 0, "outerConeAngle": 0}})
        self.assertIn("its cone is closed, and its light is left out", said)

    def test_malformed_environments_of_the_asset_are_named_by_their_place(self):
        made = floor()
        made.json["extensions"] = {"EXT_lights_image_based": {"lights": [{"irradianceCoefficients": [[1, 2]] * 9}]}}
        made.json["extensionsUsed"] = ["EXT_lights_image_based"]
        made.json["scenes"][0]["extensions"] = {"EXT_lights_image_based": {"light": 0}}
        self.refuse(made, says="lights[0].irradianceCoefficients[0]")
        made.json["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 7
        self.refuse(made, says="scenes[0].extensions.EXT_lights_image_based.light")

    def test_light_that_reaches_no_front_is_said(self):
        scene = floor()
        add_light(scene, {"type": "point", "intensity": 80}, translation=[0, -2, 0])
        self.refuse(scene, says="no light reaches the front of a surface")


if __name__ == "__main__":
    main()
