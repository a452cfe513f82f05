# SPDX-License-Identifier: MIT
"""What happens when a bake cannot be made? One clear line, the promised exit status, and nothing left behind."""

import os
import resource
import signal
import struct
import unittest

import command
import gltf_file
from command import BAD_INPUT, OUTPUT, USAGE, SAMPLES


def glb_of(json_text, binary=b""):
    """A GLB around JSON text that json.dumps would never write."""
    text = json_text + b" " * (-len(json_text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text
    if binary:
        body += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


class Failures(command.CommandCase):
    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.glb", gltf_file.room().glb())

    def refuse(self, status, named, *arguments, words=()):
        """The command fails with status and one line 'hemibake: named: ...', and leaves the folder as it was."""
        before = self.left()
        ran = self.run_hemibake(*arguments)
        self.assertEqual(ran.returncode, status, f"{arguments}\n{ran.stderr}")
        self.assertEqual(ran.stdout, "", arguments)
        self.assertRegex(ran.stderr, r"\A[^\n]+\n\Z", f"not one line: {arguments}")
        start = f"hemibake: {named}: " if named else "hemibake: "
        self.assertTrue(ran.stderr.startswith(start), f"{ran.stderr!r} does not start with {start!r}")
        self.assertGreater(len(ran.stderr.strip()), len(start.strip()), f"says nothing: {ran.stderr!r}")
        for word in words:
            self.assertIn(word, ran.stderr)
        self.assertEqual(self.left(), before, f"left behind by {arguments}")
        return ran.stderr

    def refuse_bake(self, status, named, scene, *arguments, out="out.glb", words=()):
        """With every kind of output asked for."""
        return self.refuse(status, named, "bake", scene, "-o", out, "--quality", "draft", "--report", "out.json",
                           "--preview", "out.png", *arguments, words=words)


class BadInput(Failures):
    def test_a_missing_file(self):
        self.refuse_bake(BAD_INPUT, "nowhere.glb", "nowhere.glb")
        self.refuse_bake(BAD_INPUT, "nowhere.gltf", "nowhere.gltf")

    def test_a_folder_as_input(self):
        os.mkdir(self.path("folder.glb"))
        self.refuse_bake(BAD_INPUT, "folder.glb", "folder.glb")

    def test_a_file_that_is_no_gltf(self):
        files = {"empty.glb": b"", "text.glb": b"This is not a scene.\n", "text.gltf": b"This is not a scene.\n",
                 "zeros.glb": bytes(64), "number.gltf": b"17", "list.gltf": b"[1, 2]", "half.gltf": b'{"asset": {',
                 "png.glb": b"\x89PNG\r\n\x1a\n" + bytes(64), "nul.gltf": b'{"asset":{"version":"2.0"}}\0{'}
        for name, data in files.items():
            with self.subTest(name):
                self.write(name, data)
                self.refuse_bake(BAD_INPUT, name, name)

    def test_a_version_that_is_not_2(self):
        self.write("one.glb", b"glTF" + struct.pack("<II", 1, 20) + bytes(8))
        self.refuse_bake(BAD_INPUT, "one.glb", "one.glb")

    def test_a_truncated_glb(self):
        with open(os.path.join(SAMPLES, "pillar-room.glb"), "rb") as f:
            whole = f.read()
        json_end = 20 + struct.unpack("<I", whole[12:16])[0]
        for length in (1, 4, 11, 12, 16, 19, 20, 21, json_end - 1, json_end, json_end + 4, json_end + 8,
                       len(whole) // 2, len(whole) - 4, len(whole) - 1):
            with self.subTest(length):
                self.write("cut.glb", whole[:length])
                self.refuse_bake(BAD_INPUT, "cut.glb", "cut.glb")

    def test_a_truncated_glb_whose_header_was_mended(self):
        whole = gltf_file.room().glb()
        for length in (len(whole) - 4, len(whole) - 200):
            with self.subTest(length):
                self.write("cut.glb", whole[:8] + struct.pack("<I", length) + whole[12:length])
                self.refuse_bake(BAD_INPUT, "cut.glb", "cut.glb")

    def test_a_chunk_that_says_it_is_longer_than_the_file(self):
        whole = bytearray(gltf_file.room().glb())
        whole[12:16] = struct.pack("<I", 0xFFFFFFF0)
        self.write("long.glb", bytes(whole))
        self.refuse_bake(BAD_INPUT, "long.glb", "long.glb")

    def test_a_gltf_without_its_bin(self):
        scene = gltf_file.room()
        scene.json["buffers"] = [{"uri": "lost.bin", "byteLength": len(scene.bin)}]
        self.write("scene.gltf", gltf_file.json.dumps(scene.json).encode())
        self.refuse_bake(BAD_INPUT, "scene.gltf", "scene.gltf", words=["lost.bin"])

    def test_no_triangles(self):
        empty, lines = gltf_file.Scene(), gltf_file.Scene()
        material = lines.add_material("white", (0.7, 0.7, 0.7))
        lines.add_mesh("lines", ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [(0, 1, 2), (1, 2, 3)]), material, mode=1)
        for name, data in (("empty.glb", empty.glb()), ("lines.glb", lines.glb()),
                           ("bare.glb", glb_of(b'{"asset":{"version":"2.0"}}'))):
            with self.subTest(name):
                self.write(name, data)
                self.refuse_bake(BAD_INPUT, name, name, words=["triangles"])

    def test_only_triangles_without_area(self):
        scene = gltf_file.Scene()
        light = scene.add_material("lamp", (0, 0, 0), (5, 5, 5))
        scene.add_mesh("line", ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [(0, 1, 2)]), light)
        scene.add_mesh("point", ([[0, 0, 0]] * 3, [(0, 1, 2)]), light)
        self.write("thin.glb", scene.glb())
        self.refuse_bake(BAD_INPUT, "thin.glb", "thin.glb")

    def test_no_light_at_all(self):
        """A closed room: nothing in it emits, and no sky comes in."""
        self.write("dark.glb", gltf_file.room(emission=(0, 0, 0)).glb())
        self.refuse_bake(BAD_INPUT, "dark.glb", "dark.glb", words=["light"])

    def test_warnings_do_not_crowd_the_one_line(self):
        """A white of reflectance 1, glTF's default, is clamped with a warning when a bake is made; not when none is."""
        scene = gltf_file.room(emission=(0, 0, 0))
        scene.json["materials"][0]["pbrMetallicRoughness"] = {"metallicFactor": 0}
        self.write("dark.glb", scene.glb())
        self.refuse_bake(BAD_INPUT, "dark.glb", "dark.glb", words=["light"])

    def test_names_in_the_file_cannot_break_the_line(self):
        """Nor colour the terminal: an edge with three triangles is no cage, and the message names its node."""
        scene = gltf_file.room()
        scene.add_mesh("fin\n\033[31m", ([[0, 1, 0], [0, 1.2, 0], [0.1, 1, 0], [-0.1, 1, 0], [0, 1, 0.1]],
                                         [(0, 1, 2), (1, 0, 3), (0, 1, 4)]), 0)
        self.write("names.glb", scene.glb())
        said = self.refuse_bake(BAD_INPUT, "names.glb", "names.glb", "--subdivide", 1, words=["fin"])
        self.assertNotIn("\033", said)

    def test_positions_none_of_which_is_a_number(self):
        scene = gltf_file.room()
        for at in range(0, 96, 4):  # the room's eight corners
            struct.pack_into("<f", scene.bin, at, float("nan"))
        self.write("nan.glb", scene.glb())
        self.refuse_bake(BAD_INPUT, "nan.glb", "nan.glb")

    def test_a_node_moved_or_scaled_past_what_a_float_holds(self):
        for key, value in (("scale", [1e300] * 3), ("translation", [0, 1e308, 0])):
            scene = gltf_file.room()
            scene.json["nodes"][0][key] = value
            self.write("far.glb", scene.glb())
            self.refuse_bake(BAD_INPUT, "far.glb", "far.glb")

    def test_an_index_past_the_vertices(self):
        scene = gltf_file.room()
        view = scene.json["bufferViews"][1]
        struct.pack_into("<I", scene.bin, view["byteOffset"], 1 << 30)
        self.write("index.glb", scene.glb())
        self.refuse_bake(BAD_INPUT, "index.glb", "index.glb")

    def test_an_image_bomb_is_not_unpacked_into_memory(self):
        """A PNG of 60000 x 60000 pixels in a few bytes: passed on, or refused in one line, and either way within 1 GiB."""
        scene = gltf_file.room()
        header = struct.pack(">II5B", 60000, 60000, 8, 6, 0, 0, 0)
        image = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + header + bytes(4)
        view = {"buffer": 0, "byteOffset": len(scene.bin), "byteLength": len(image)}
        scene.bin += image
        scene.json["bufferViews"].append(view)
        scene.json["images"] = [{"bufferView": len(scene.json["bufferViews"]) - 1, "mimeType": "image/png"}]
        scene.json["textures"] = [{"source": 0}]
        scene.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        scene.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = scene._add_accessor(
            [[0, 0]] * 8, "VEC2", gltf_file.FLOAT)
        self.write("bomb.glb", scene.glb())
        ran = self.run_hemibake("bake", "bomb.glb", "-o", "out.glb", "--quality", "draft", "--report", "out.json")
        self.assertIn(ran.returncode, (0, BAD_INPUT), ran.stderr)
        self.assertLessEqual(ran.stderr.count("\n"), 1)
        if ran.returncode == 0:
            self.assertLess(gltf_file.json.loads(self.read("out.json"))["memory"]["peak_bytes"], 1 << 30)

    def test_too_many_elements(self):
        self.refuse_bake(BAD_INPUT, "scene.glb", "scene.glb", "--max-elements", 10)
        self.refuse_bake(BAD_INPUT, "scene.glb", "scene.glb", "--element-size", "1e-7")

    def test_a_required_extension_that_nobody_knows(self):
        scene = gltf_file.room()
        scene.json["extensionsUsed"] = scene.json["extensionsRequired"] = ["HEMI_made_up"]
        self.write("required.glb", scene.glb())
        self.refuse_bake(BAD_INPUT, "required.glb", "required.glb", words=["HEMI_made_up"])


class BadColors(Failures):
    def test_an_unknown_view_display_or_look(self):
        for flag in ("--view", "--display", "--look"):
            with self.subTest(flag):
                self.refuse_bake(BAD_INPUT, "scene.glb", "scene.glb", flag, "Kodachrome", words=["Kodachrome"])

    def test_a_configuration_that_is_missing_or_is_none(self):
        self.write("text.ocio", b"This is not a configuration.\n")
        for name in ("lost.ocio", "text.ocio"):
            with self.subTest(name):
                self.refuse_bake(BAD_INPUT, name, "scene.glb", "--ocio", name)


class BadReference(Failures):
    GOOD = command.probes([((0, 0, 0.9), (0, 1, 0), (1, 1, 1))])

    def bad(self):
        return {"lost.hprb": None, "text.hprb": b"probes, many of them\n", "empty.hprb": b"", "cut.hprb": self.GOOD[:-4],
                "counts.hprb": b"HPRB" + struct.pack("<I", 1 << 31) + self.GOOD[8:], "none.hprb": command.probes([]),
                "nan.hprb": command.probes([((float("nan"), 0, 0), (0, 1, 0), (1, 1, 1))])}

    def test_refused_by_bake(self):
        for name, data in self.bad().items():
            with self.subTest(name):
                if data is not None:
                    self.write(name, data)
                self.refuse_bake(BAD_INPUT, name, "scene.glb", "--reference", name)

    def test_refused_by_compare(self):
        self.bake("scene.glb", "baked.glb", "--quality", "draft", "--scene-linear", "--quiet")
        for name, data in self.bad().items():
            with self.subTest(name):
                if data is not None:
                    self.write(name, data)
                self.refuse(BAD_INPUT, name, "compare", "baked.glb", name)

    def test_compare_needs_a_bake(self):
        self.write("good.hprb", self.GOOD)
        self.refuse(BAD_INPUT, "scene.glb", "compare", "scene.glb", "good.hprb", words=["_RADIOSITY"])
        self.refuse(BAD_INPUT, "nowhere.glb", "compare", "nowhere.glb", "good.hprb")


class FoundEarly(Failures):
    """A mistake in the command is found before the work, not after hours of it: no progress is shown first."""

    def test_a_reference_that_cannot_be_read(self):
        self.refuse_bake(BAD_INPUT, "lost.hprb", "scene.glb", "--reference", "lost.hprb", "--progress", "json")

    def test_a_camera_that_is_not_there(self):
        self.refuse_bake(BAD_INPUT, "scene.glb", "scene.glb", "--camera", "nobody", "--progress", "json", words=["nobody"])

    def test_a_view_that_is_not_there(self):
        self.refuse_bake(BAD_INPUT, "scene.glb", "scene.glb", "--view", "Kodachrome", "--progress", "json")

    def test_an_output_that_cannot_be_written(self):
        self.refuse_bake(OUTPUT, "no/out.glb", "scene.glb", "--progress", "json", out="no/out.glb")


class BadOutput(Failures):
    def test_a_folder_that_is_not_there(self):
        self.refuse_bake(OUTPUT, "nowhere/out.glb", "scene.glb", out="nowhere/out.glb")
        self.refuse_bake(OUTPUT, "nowhere/out.gltf", "scene.glb", out="nowhere/out.gltf")

    def test_a_folder_that_is_a_file(self):
        self.refuse_bake(OUTPUT, "scene.glb/out.glb", "scene.glb", out="scene.glb/out.glb")

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_a_folder_that_may_not_be_written(self):
        os.mkdir(self.path("closed"), 0o555)
        self.refuse_bake(OUTPUT, "closed/out.glb", "scene.glb", out="closed/out.glb")

    def test_an_output_that_is_a_folder(self):
        for name in ("out.glb", "out.gltf", "out.bin"):
            os.mkdir(self.path(name))
        self.refuse_bake(OUTPUT, "out.glb", "scene.glb")
        self.refuse_bake(OUTPUT, "out.gltf", "scene.glb", out="out.gltf")

    def test_a_report_or_preview_that_cannot_be_written(self):
        for flag, name in (("--report", "nowhere/r.json"), ("--preview", "nowhere/p.png")):
            with self.subTest(flag):
                self.refuse(OUTPUT, name, "bake", "scene.glb", "-o", "out.glb", "--quality", "draft", flag, name)

    def test_a_disk_that_fills_up(self):
        """Limits between the sizes of the files stand in for a full disk: whichever write fails, none stays."""
        bake = ("bake", "scene.glb", "-o", "out.gltf", "--quality", "draft", "--no-draco", "--report", "out.json",
                "--preview", "out.png", "--size", "8x8")
        outputs = [f"out.{end}" for end in ("gltf", "bin", "json", "png")]
        self.succeed(*bake)
        sizes = sorted(os.path.getsize(self.path(name)) for name in outputs)
        for name in outputs:
            os.remove(self.path(name))
        before = self.left()

        for size in sizes:
            def limit(size=size):
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (size - 64, size - 64))  # times in the report vary in length

            with self.subTest(f"no file may have {size} bytes"):
                ran = self.run_hemibake(*bake, preexec_fn=limit)
                self.assertEqual(ran.returncode, OUTPUT, ran.stderr)
                self.assertRegex(ran.stderr, r"\Ahemibake: out\.[a-z]+: [^\n]+\n\Z")
                left, names = self.left(), set(self.left()) - set(before)
                for name in names:
                    os.remove(self.path(name))
                self.assertEqual(left, before)

    def test_an_old_output_survives_a_failure(self):
        self.write("out.glb", b"old")
        self.write("out.png", b"old too")
        self.refuse_bake(BAD_INPUT, "nowhere.glb", "nowhere.glb")
        self.refuse_bake(OUTPUT, "nowhere/r.json", "scene.glb", "--report", "nowhere/r.json")
        self.assertEqual((self.read("out.glb"), self.read("out.png")), (b"old", b"old too"))

    def test_render_to_a_place_that_cannot_be_written(self):
        self.refuse(OUTPUT, "nowhere/p.png", "render", "scene.glb", "-o", "nowhere/p.png")
        self.refuse(BAD_INPUT, "nowhere.glb", "render", "nowhere.glb", "-o", "p.png")


class WrongUsage(Failures):
    def test_an_unknown_command_or_flag(self):
        self.refuse(USAGE, None, "cook", "scene.glb", words=["cook"])
        self.refuse_bake(USAGE, None, "scene.glb", "--bounce", words=["--bounce"])
        self.refuse_bake(USAGE, None, "scene.glb", "-x", words=["-x"])
        self.refuse_bake(USAGE, None, "scene.glb", "--json", words=["--json"])

    def test_a_missing_input_or_output(self):
        self.refuse(USAGE, None, "bake")
        self.refuse(USAGE, None, "bake", "scene.glb", words=["-o"])
        self.refuse(USAGE, None, "bake", "-o", "out.glb")
        self.refuse(USAGE, None, "bake", "scene.glb", "-o")
        self.refuse(USAGE, None, "compare", "scene.glb")
        self.refuse_bake(USAGE, None, "scene.glb", "one too many.glb")

    def test_no_arguments_print_the_overview_and_fail(self):
        ran = self.run_hemibake()
        self.assertEqual((ran.returncode, ran.stdout), (USAGE, ""))
        self.assertIn("hemibake bake IN... -o OUT", ran.stderr)

    def test_bad_values(self):
        bad = {"--quality": ["best", "", "Draft"], "--method": ["magic"], "--error": ["0", "-1", "nan", "2", "1x"],
               "--time": ["0", "-3", "soon", "nan", "inf"], "--unshot": ["0", "1"], "--element-size": ["0", "-0.1", "nan"],
               "--patch-size": ["0", "small"], "--hemicube": ["0", "15", "64.5", "99999"], "--hemicube-light": ["-64"],
               "--subdivide": ["-1", "9", "1.5"], "--subdivide-scheme": ["butterfly"], "--threads": ["0", "-1", "257", "two"],
               "--seed": ["-1", "x"], "--memory": ["0"], "--max-elements": ["0", "1e12"], "--exposure": ["bright", "nan", "65"],
               "--draco-level": ["11", "-1"], "--draco-bits": ["position", "position=0", "position=31", "size=12", "color=", "="],
               "--size": ["100", "0x10", "10x", "x", "axb", "99999x10"], "--progress": ["loud"]}
        for flag, values in bad.items():
            for value in values:
                with self.subTest(f"{flag} {value}"):
                    self.refuse_bake(USAGE, None, "scene.glb", flag, value, words=[flag])

    def test_a_flag_without_its_value(self):
        for flag in ("--quality", "--time", "--threads", "--report", "--view"):
            with self.subTest(flag):
                self.refuse(USAGE, None, "bake", "scene.glb", "-o", "out.glb", flag, words=[flag])
        self.refuse_bake(USAGE, None, "scene.glb", "--quiet=yes", words=["--quiet"])

    def test_an_output_that_is_neither_glb_nor_gltf(self):
        for name in ("out.obj", "out", "out.glb.gz", "glb"):
            with self.subTest(name):
                self.refuse_bake(USAGE, name, "scene.glb", out=name)

    def test_an_unknown_camera(self):
        self.refuse_bake(BAD_INPUT, "scene.glb", "scene.glb", "--camera", "nobody", words=["nobody"])
        self.refuse(BAD_INPUT, "scene.glb", "render", "scene.glb", "-o", "p.png", "--camera", "7", words=["7"])


if __name__ == "__main__":
    command.main()
