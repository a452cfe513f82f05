# SPDX-License-Identifier: MIT
"""Does a bake write what was promised? Report keys, help examples, both containers, and all of it can be read back."""

import base64
import fcntl
import hashlib
import json
import os
import pty
import re
import shutil
import struct
import subprocess
import termios

import command
import gltf_file

# The contract of the report: add, never rename.
REPORT = {
    "hemibake": ["version"],
    "input": ["path", "sha256"],
    "output": ["path", "bytes"],
    "scene": ["surfaces", "materials", "lights", "patches", "elements", "vertices_out", "triangles_out"],
    "time": ["total_s", "read_s", "mesh_s", "factors_s", "solve_s", "reconstruct_s", "color_s", "write_s"],
    "memory": ["peak_bytes"],
    "solver": ["method", "threads", "shots", "hemicubes", "unshot_fraction", "converged"],
    "energy": ["emitted", "absorbed", "escaped", "unshot", "residual_fraction"],
    "factors": ["closure_min", "closure_mean", "closure_max", "analytic_fraction", "subdivided_patches", "clipped"],
    "error": ["estimate", "reference", "reference_median", "reference_95", "worst"],
    "color": ["config", "display", "view", "look", "exposure_ev", "clipped_fraction", "dark_fraction", "reflecting_fraction", "black"],
    "draco": ["bytes_before", "bytes_after", "max_position_error", "max_color_error"],
}
CURVE = ["t_s", "shots", "unshot_fraction", "error_estimate", "error_reference"]

FLOOR_PROBES = command.probes([((0.1 * x, 0, 0.6), (0, 1, 0), (0.5, 0.4, 0.4)) for x in range(-8, 9)])


class Outputs(command.CommandCase):
    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.glb", gltf_file.room().glb())

    def draft(self, out, *arguments, status=command.DONE):
        return self.bake("scene.glb", out, "--quality", "draft", *arguments, status=status)

    # ---- report ------------------------------------------------------------------------------------------------------

    def report(self, *arguments):
        self.draft("out.glb", "--report", "out.json", "--quiet", *arguments)
        return json.loads(self.read("out.json"))

    def test_the_report_has_every_key_of_the_contract(self):
        report = self.report()
        for name, keys in REPORT.items():
            for key in keys:
                self.assertIn(key, report[name], name)
        self.assertTrue(report["curve"])
        for point in report["curve"]:
            for key in CURVE:
                self.assertIn(key, point)

    def test_the_report_agrees_with_the_files(self):
        report = self.report()
        self.assertEqual(report["input"]["sha256"], hashlib.sha256(self.read("scene.glb")).hexdigest())
        self.assertEqual(report["output"], {"path": "out.glb", "bytes": len(self.read("out.glb"))})
        asset = gltf_file.Asset(self.path("out.glb"))
        accessors = asset.json["accessors"]
        primitives = [p for mesh in asset.json["meshes"] for p in mesh["primitives"]]
        self.assertEqual(report["scene"]["triangles_out"], sum(accessors[p["indices"]]["count"] // 3 for p in primitives))

    def test_the_energy_books_close(self):
        """emitted = absorbed + escaped + unshot, in watts: of sums in double, 1e-9 is far more than rounding loses."""
        energy = self.report()["energy"]
        spent = energy["absorbed"] + energy["escaped"] + energy["unshot"]
        self.assertAlmostEqual(spent / energy["emitted"], 1.0, delta=1e-9)
        self.assertLess(abs(energy["residual_fraction"]), 1e-9)
        # A lamp of 0.36 m2 that emits radiance 10 in three bands; float emission and positions keep seven digits.
        self.assertAlmostEqual(energy["emitted"] / (3 * 10 * 3.14159265 * 0.36), 1.0, delta=1e-6)

    def test_sizes_are_those_of_elements_and_patches(self):
        """Half the edge is four times as many, where sides are whole numbers of both and nothing stands on anything."""
        counts, room = [], gltf_file.Scene()
        room.add_mesh("room", gltf_file.box((-1, 0, -1), (1, 2, 1), inward=True), room.add_material("white", (0.7, 0.7, 0.7)))
        room.add_mesh("lamp", gltf_file.lamp(0.25, 1.9), room.add_material("lamp", (0, 0, 0), (10, 10, 10)))
        for sizes in ((0.5, 0.5), (0.25, 0.5), (0.25, 0.25)):
            self.write("scene.glb", room.glb())
            scene = self.report("--element-size", sizes[0], "--patch-size", sizes[1], "--uniform")["scene"]
            counts.append((scene["elements"], scene["patches"]))
        self.assertGreater(counts[1][0], 3 * counts[0][0])
        self.assertEqual(counts[1][1], counts[0][1])
        self.assertEqual(counts[2][0], counts[1][0])
        self.assertGreater(counts[2][1], 3 * counts[1][1])

    def test_the_report_names_what_was_not_baked(self):
        scene = gltf_file.room()
        scene.add_mesh("pane", gltf_file.box((-0.5, 1, 0.5), (0.5, 1.5, 0.6)), 0, mode=1)
        self.write("scene.glb", scene.glb())
        report = self.report()
        self.assertTrue(any("pane" in line for line in report["scene"]["not_baked"]), report["scene"])
        pane, = gltf_file.Asset(self.path("out.glb")).primitives("pane")
        self.assertNotIn("COLOR_0", pane["attributes"])

    def test_a_reference_appears_in_the_report(self):
        self.write("floor.hprb", FLOOR_PROBES)
        report = self.report("--reference", "floor.hprb")
        self.assertGreater(report["error"]["reference"], 0.0)
        self.assertEqual(report["curve"][-1]["error_reference"], report["error"]["reference"])

    def two_rooms(self, slot):
        """A lamp is in the near one; the wall between them ends so far beside the side wall."""
        scene, ends = gltf_file.Scene(), (("near", -2, 0, 1), ("far", 0, 2, 0))
        white = scene.add_material("white", (0.7, 0.7, 0.7))
        for name, low, high, open_side in ends:
            positions, triangles = gltf_file.box((low, 0, -1), (high, 2, 1), inward=True)
            scene.add_mesh(name, (positions, [t for i, t in enumerate(triangles) if i // 2 != open_side]), white)
        scene.add_mesh("wall", gltf_file.box((-0.05, 0, -1), (0.05, 2, 1 - slot)), white)
        positions, triangles = gltf_file.lamp(0.25, 1.9)
        scene.add_mesh("lamp", ([[x - 1, y, z] for x, y, z in positions], triangles), scene.add_material("lamp", (0, 0, 0), (10, 10, 10)))
        return scene.glb()

    def test_the_room_that_is_worst_by_itself_is_named(self):
        """Of a slot of 1 cm few rays know: the room behind it is noisy, and the whole is not. Without a wall it has its share."""
        for slot, is_told in ((0.01, True), (2.0, False)):
            self.write("scene.glb", self.two_rooms(slot))
            ran = self.draft("out.glb", "--method", "rows", "--report", "out.json")
            error = json.loads(self.read("out.json"))["error"]
            told = [line for line in ran.stdout.splitlines() if line.startswith("worst")]
            self.assertEqual(len(told), 1 if is_told else 0, error)
            if is_told:
                self.assertEqual(error["worst"]["node"], "far")
                self.assertGreater(error["worst"]["estimate"], 3 * error["estimate"])
                self.assertLess(error["worst"]["light"], 0.1)
                self.assertAlmostEqual(error["worst"]["area"], 0.4, delta=0.1)
                self.assertIn("'far'", told[0])

    def test_columns_do_not_know_which_node_is_worst(self):
        self.assertIsNone(self.report("--method", "hybrid")["error"]["worst"])

    # ---- what it prints ----------------------------------------------------------------------------------------------

    def test_a_bake_ends_with_six_lines(self):
        ran = self.draft("out.glb", "--report", "out.json", "--preview", "out.png")
        self.assertEqual([line.split()[0] for line in ran.stdout.splitlines()], ["baked", "error", "colour", "time", "size", "files"])
        for name in ("out.glb", "out.json", "out.png"):
            self.assertIn(name, ran.stdout.splitlines()[-1])

    def test_quiet_prints_nothing(self):
        for more in ((), ("--scene-linear",), ("--progress", "json")):
            ran = self.draft("out.glb", "--preview", "out.png", "--quiet", *more)
            self.assertEqual((ran.stdout, ran.stderr), ("", ""), more)
        ran = self.succeed("render", "out.glb", "-o", "out.png", "--quiet")
        self.assertEqual((ran.stdout, ran.stderr), ("", ""))

    def test_a_bake_that_is_no_terminal_shows_no_progress(self):
        self.assertEqual(self.draft("out.glb").stderr, "")

    def test_progress_as_json_is_json(self):
        ran = self.draft("out.glb", "--progress", "json")
        steps = [json.loads(line) for line in ran.stderr.splitlines()]
        self.assertTrue(steps)
        for step in steps:
            self.assertLessEqual(0.0, step["fraction"])
            self.assertLessEqual(step["fraction"], 1.0)
            self.assertTrue(step["stage"])

    def test_every_stage_says_what_is_known_of_the_error(self):
        """All is missing before anything is known; then it falls to what the report says, in steps on the way: by columns as patches
        shoot, by rows as rays are cast, after which iterations leave a residual of nothing."""
        for method in ("hybrid", "rows"):
            ran = self.draft("out.glb", "--method", method, "--progress", "json", "--report", "out.json")
            steps = [json.loads(line) for line in ran.stderr.splitlines()]
            known = [step["error_estimate"] for step in steps]
            self.assertTrue(all(0.0 <= one <= 1.0 for one in known), (method, known))
            before = [step["error_estimate"] for step in steps if step["stage"] in ("read", "mesh", "light")]
            self.assertEqual(set(before) - {1.0}, set(), method)
            self.assertLess(known[-1], 0.1, method)
            self.assertAlmostEqual(known[-1], json.loads(self.read("out.json"))["error"]["estimate"], 5, method)
            later = [step for step in steps if step["stage"] in ("refine", "reconstruct")]
            self.assertTrue(later, method)
            for step in later:
                self.assertLess(step["error_estimate"], 0.25, method)
                self.assertLess(step["unshot_fraction"], 0.05, method)

    def test_plain_progress_has_no_escapes(self):
        ran = self.draft("out.glb", "--progress", "plain")
        self.assertTrue(ran.stderr)
        self.assertNotIn("\033", ran.stderr)
        self.assertNotIn("\r", ran.stderr)

    def test_a_line_of_progress_fits_the_terminal_and_ends_with_what_is_left(self):
        """By columns, which say most: shots, unshot, error."""
        for columns in (120, 80, 72):
            ours, theirs = pty.openpty()
            fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 25, columns, 0, 0))
            bake = subprocess.Popen([command.HEMIBAKE, "bake", self.path("scene.glb"), "-o", self.path("out.glb"), "--method", "hybrid",
                                     "--quality", "draft"], stdout=subprocess.DEVNULL, stderr=theirs)
            os.close(theirs)
            said = b""
            try:
                while part := os.read(ours, 4096):
                    said += part
            except OSError:  # what Linux says where the other end is closed
                pass
            os.close(ours)
            self.assertEqual(bake.wait(), 0)
            lines = [line for line in re.split(r"[\r\n]+(?:\033\[K)?", said.decode()) if "unshot" in line]
            self.assertTrue(lines)
            for line in lines:
                self.assertLess(len(line), columns)
                self.assertRegex(line, r"unshot, error \d.*%, \d+\.\d s, \d+ s left\Z")
                self.assertEqual("shots" in line, columns >= 100)

    def test_shares_are_written_out(self):
        """What has only begun is off by all: that is 100 %, not 1e+02 %."""
        ran = self.bake("scene.glb", "out.glb", "--method", "pr", "--element-size", "0.02", "--patch-size", "0.03", "--time", "2s",
                        "--progress", "plain", status=command.NOT_CONVERGED)
        self.assertRegex(ran.stderr, r"error \d")
        self.assertRegex(ran.stdout, r"% unshot")
        self.assertNotIn("e+", ran.stderr + ran.stdout)

    def test_help_and_version(self):
        for arguments in (["--help"], ["-h"], ["help"], ["bake", "--help"], ["compare", "--help"], ["render", "-h"]):
            ran = self.succeed(*arguments)
            self.assertEqual(ran.stderr, "")
            self.assertIn("hemibake", ran.stdout)
        self.assertRegex(self.succeed("--version").stdout, r"\Ahemibake \d+\.\d+\.\d+\n\Z")

    def test_every_example_in_help_runs(self):
        """In their order, in one folder: later examples use what earlier ones wrote."""
        os.mkdir(self.path("samples"))
        for sample in ("pillar-room.glb", "l-room.vs3"):
            shutil.copy(os.path.join(command.SAMPLES, sample), self.path("samples"))
        self.write("pillar-room.hprb", command.probes([((x / 4, 0, -0.5), (0, 1, 0), (1, 1, 1)) for x in range(1, 12)]))
        overview = self.succeed("--help").stdout
        names = [line.split()[1] for line in overview.splitlines() if line.startswith("  hemibake ")]
        self.assertGreaterEqual(set(names), {"bake", "compare", "factors", "render"})
        for name in sorted(set(names) - {"view"}):  # which ends with the viewer, and needs it built: view_test.py
            lines = self.succeed(name, "--help").stdout.splitlines()
            examples = [line.split() for line in lines[lines.index("Example:") + 1:] if line.strip()]
            self.assertTrue(examples, name)
            for words in examples:
                self.assertEqual(words[0], "hemibake")
                self.succeed(*words[1:])

    # ---- the asset ---------------------------------------------------------------------------------------------------

    def check_baked(self, name, linear):
        """Every visible primitive has colours in [0,1] on an unlit material, and _RADIOSITY only when asked for."""
        asset = gltf_file.Asset(self.path(name))
        self.assertIn("KHR_materials_unlit", asset.json["extensionsUsed"])
        for node in ("room", "box", "lamp"):
            for primitive in asset.primitives(node):
                material = asset.json["materials"][primitive["material"]]
                self.assertIn("KHR_materials_unlit", material["extensions"])
                self.assertIn("COLOR_0", primitive["attributes"])
                self.assertEqual("_RADIOSITY" in primitive["attributes"], linear)
                if "extensions" not in primitive:
                    rows = asset.values(primitive["attributes"]["COLOR_0"])
                    self.assertTrue(all(0.0 <= x <= 1.0 for row in rows for x in row))
        return asset

    def test_both_containers_with_and_without_draco(self):
        for out in ("out.glb", "out.gltf"):
            for draco in (True, False):
                for linear in (True, False):
                    with self.subTest(f"{out}, Draco {draco}, linear {linear}"):
                        more = ([] if draco else ["--no-draco"]) + (["--scene-linear"] if linear else [])
                        self.draft(out, *more)
                        asset = self.check_baked(out, linear)
                        self.assertEqual("KHR_draco_mesh_compression" in asset.json.get("extensionsUsed", []), draco)
        self.assertEqual(self.left(), ["out.bin", "out.glb", "out.gltf", "scene.glb"])
        self.assertEqual(gltf_file.Asset(self.path("out.gltf")).json["buffers"][0]["uri"], "out.bin")

    def test_a_gltf_in_a_folder_names_its_bin_beside_it(self):
        os.mkdir(self.path("sub folder"))
        self.draft("sub folder/my room.gltf", "--no-draco")
        self.assertIn("sub folder/my room.bin", self.left())
        self.succeed("render", "sub folder/my room.gltf", "-o", "p.png")

    def test_flat_is_one_colour_a_triangle(self):
        """The triangles are those of a smooth bake that merges none, each with the mean of its corners' colours."""
        meshes = {}
        for name, options in (("smooth", ("--merge-error", "0")), ("flat", ("--flat",))):
            self.draft(f"{name}.glb", "--scene-linear", "--no-draco", *options)
            asset = gltf_file.Asset(self.path(f"{name}.glb"))
            for node in asset.json["nodes"]:
                for primitive in asset.primitives(node["name"]):
                    indices = [row[0] for row in asset.values(primitive["indices"])]
                    columns = [asset.values(primitive["attributes"][key]) for key in ("POSITION", "_RADIOSITY")]
                    meshes.setdefault(name, []).append([[column[v] for v in indices] for column in columns])
        for smooth, flat in zip(meshes["smooth"], meshes["flat"], strict=True):
            self.assertEqual(smooth[0], flat[0])
            for t in range(0, len(flat[1]), 3):
                self.assertEqual(flat[1][t], flat[1][t + 1])
                self.assertEqual(flat[1][t], flat[1][t + 2])
                for band in range(3):
                    mean = sum(smooth[1][t + k][band] for k in range(3)) / 3
                    self.assertAlmostEqual(flat[1][t][band], mean, delta=1e-6 * (1 + mean))

    def test_the_lamp_shows_its_own_radiance(self):
        """Scene-linear radiance of a surface that reflects nothing is what its material emits, to float precision."""
        self.draft("out.glb", "--scene-linear", "--no-draco")
        asset = gltf_file.Asset(self.path("out.glb"))
        for primitive in asset.primitives("lamp"):
            for row in asset.values(primitive["attributes"]["_RADIOSITY"]):
                for x in row:
                    self.assertAlmostEqual(x, 10.0, delta=1e-4)

    def test_every_output_can_be_read_back(self):
        self.write("floor.hprb", FLOOR_PROBES)
        for out in ("out.glb", "out.gltf"):
            for more in ((), ("--no-draco",)):
                with self.subTest(f"{out} {more}"):
                    self.draft(out, "--scene-linear", *more)
                    found = json.loads(self.succeed("compare", out, "floor.hprb", "--json").stdout)
                    self.assertEqual((found["matched"], found["unmatched"]), (17, 0))
                    self.assertIn("relative error", self.succeed("compare", out, "floor.hprb").stdout)
                    self.succeed("render", out, "-o", "out.png", "--size", "64x48")
                    self.assertEqual(self.read("out.png")[:8], b"\x89PNG\r\n\x1a\n")

    def test_compare_finds_what_was_put_in(self):
        """Probes that hold the bake's own radiance have no error; twice the radiance has the error 1/2."""
        self.draft("out.glb", "--scene-linear", "--no-draco")
        asset = gltf_file.Asset(self.path("out.glb"))
        rows = []  # of the box's top face, off its edges
        for primitive in asset.primitives("box"):
            places = zip(asset.values(primitive["attributes"]["POSITION"]), asset.values(primitive["attributes"]["_RADIOSITY"]))
            rows += [(p, (0, 1, 0), c) for p, c in places if p[1] == 0.5 and max(abs(p[0]), abs(p[2])) < 0.2]
        self.assertTrue(rows)
        for factor, error in ((1.0, 0.0), (2.0, 0.5)):
            self.write("own.hprb", command.probes([(p, n, [factor * x for x in c]) for p, n, c in rows]))
            found = json.loads(self.succeed("compare", "out.glb", "own.hprb", "--json").stdout)
            self.assertEqual(found["matched"], len(rows))
            self.assertAlmostEqual(found["error"], error, delta=1e-5)  # floats in the file

    def test_baking_a_bake_again_is_refused_or_done_but_never_half(self):
        """Its materials are unlit: nothing in it is left to light."""
        self.draft("once.glb", "--scene-linear", "--quiet")
        ran = self.run_hemibake("bake", "once.glb", "-o", "twice.glb", "--quality", "draft", "--quiet")
        self.assertIn(ran.returncode, (command.DONE, command.BAD_INPUT), ran.stderr)
        self.assertEqual("twice.glb" in self.left(), ran.returncode == command.DONE)

    def test_warnings_are_lines_of_their_own(self):
        """Whatever a material is called; and --quiet silences them."""
        scene = gltf_file.room()
        # Reflectance 1 is clamped, with a warning.
        scene.json["materials"][0] = {"name": "two\nlines \033[31m", "pbrMetallicRoughness": {"metallicFactor": 0}}
        self.write("scene.glb", scene.glb())
        warned = self.draft("out.glb").stderr
        self.assertRegex(warned, r"\A(hemibake: scene\.glb: warning: [^\n]+\n)+\Z")
        self.assertNotIn("\033", warned)
        self.assertEqual(self.draft("out.glb", "--quiet").stderr, "")

    def test_an_output_may_replace_its_input(self):
        self.bake("scene.glb", "scene.glb", "--force", "--quality", "draft")
        self.check_baked("scene.glb", linear=False)

    def test_input_as_gltf_with_bin_and_with_a_data_uri(self):
        scene = gltf_file.room()
        self.draft("glb.glb", "--no-draco")
        uris = {"bin": "a scene.bin", "data": "data:application/octet-stream;base64," + base64.b64encode(scene.bin).decode()}
        self.write("a scene.bin", bytes(scene.bin))
        for kind, uri in uris.items():
            tree = dict(scene.json, buffers=[{"uri": uri.replace(" ", "%20"), "byteLength": len(scene.bin)}])
            self.write("scene.gltf", json.dumps(tree).encode())
            self.bake("scene.gltf", f"{kind}.glb", "--quality", "draft", "--no-draco")
            self.assertEqual(self.read(f"{kind}.glb"), self.read("glb.glb"), kind)


if __name__ == "__main__":
    command.main()
