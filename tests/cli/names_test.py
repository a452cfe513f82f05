# SPDX-License-Identifier: MIT
"""Is what a stranger called things printed so that it moves no cursor, colours nothing and reads in its order?"""

import json
import os
import subprocess

import command
import gltf_file
from command import BAD_INPUT, DONE, NOT_CONVERGED, OUTPUT, USAGE

# ESC, BEL and line end; the one-character CSI of C1; overrides and isolates of direction; a separator; a byte that is no UTF-8.
EVIL = "n\x1b[31m\x07\n\u009b31m\u202e\u2066\u200f\u2028e"
FORBIDDEN = [chr(c) for c in (*range(0x00, 0x09), *range(0x0B, 0x20), *range(0x7F, 0xA0), 0x61C, 0x200E, 0x200F, *range(0x2028, 0x202F),
                              *range(0x2066, 0x206A))]


class Names(command.CommandCase):
    def clean(self, text, what):
        for c in FORBIDDEN:
            self.assertNotIn(c, text, f"U+{ord(c):04X} in {what}: {text!r}")

    def run_clean(self, *arguments, status=DONE):
        ran = subprocess.run([command.HEMIBAKE, *map(str, arguments)], cwd=self.folder, capture_output=True, timeout=command.PATIENCE_S)
        self.assertEqual(ran.returncode, status, ran.stderr)
        out, err = ran.stdout.decode(), ran.stderr.decode()  # UTF-8, whatever went in
        self.clean(out, arguments)
        self.clean(err, arguments)
        return out, err

    def setUp(self):
        super().setUp()
        scene = gltf_file.room()
        for kind in ("nodes", "meshes", "materials"):
            for entry in scene.json[kind]:
                entry["name"] = EVIL + entry.get("name", "")
        # White of reflectance 1: a warning names the material.
        scene.json["materials"][0]["pbrMetallicRoughness"] = {"metallicFactor": 0}
        scene.json["images"] = [{"uri": EVIL + ".png"}]
        self.write("scene.glb", scene.glb())

    def test_a_bake_and_its_warnings(self):
        out, err = self.run_clean("bake", "scene.glb", "-o", "out.glb", "--quality", "draft")
        self.assertIn("?[31m", err)

    def test_factors_on_stdout_and_in_a_file(self):
        out, _ = self.run_clean("factors", "scene.glb", "--tolerance", "0.1")
        self.assertIn('"n?[31m', out)
        self.run_clean("factors", "scene.glb", "--tolerance", "0.1", "-o", "out.csv")
        self.clean(self.read("out.csv").decode(), "CSV")

    def test_compare_as_a_table_and_as_json(self):
        self.bake("scene.glb", "out.glb", "--quality", "draft", "--scene-linear", "--no-draco", "--quiet")
        self.write("floor.hprb", command.probes([((x / 10, 0, 0.9), (0, 1, 0), (1, 1, 1)) for x in range(-8, 9)]))
        self.run_clean("compare", "out.glb", "floor.hprb")
        out, _ = self.run_clean("compare", "out.glb", "floor.hprb", "--json")
        self.assertTrue(any(node["name"].startswith(EVIL) for node in json.loads(out)["nodes"]), out)

    def test_file_names_options_and_commands(self):
        evil = EVIL.encode() + b"\xff\xc0\x80"
        self.run_clean_bytes([b"bake", evil + b".glb", b"-o", b"out.glb"], BAD_INPUT)
        self.run_clean_bytes([b"bake", b"scene.glb", b"-o", evil], USAGE)
        self.run_clean_bytes([evil], USAGE)
        self.run_clean_bytes([b"bake", b"scene.glb", b"--" + evil], USAGE)
        self.run_clean_bytes([b"bake", b"scene.glb", b"--quality", evil], USAGE)
        self.run_clean_bytes([b"bake", b"scene.glb", b"-o", b"out.glb", b"--view", evil], BAD_INPUT)
        self.run_clean_bytes([b"bake", b"scene.glb", b"-o", evil + b".glb", b"--quality", b"draft"], DONE)

    def run_clean_bytes(self, arguments, status):
        ran = subprocess.run([command.HEMIBAKE.encode(), *arguments], cwd=self.folder, capture_output=True, timeout=command.PATIENCE_S)
        self.assertEqual(ran.returncode, status, ran.stderr)
        self.clean(ran.stdout.decode() + ran.stderr.decode(), arguments)
        if status != DONE:
            self.assertEqual(ran.stderr.count(b"\n"), 1, ran.stderr)


class Streams(command.CommandCase):
    """What is printed to stdout and does not get there is exit 3 with a line."""

    def setUp(self):
        super().setUp()
        self.write("scene.glb", gltf_file.room().glb())

    def full(self, *arguments, status=OUTPUT):
        with open("/dev/full", "wb") as full:
            ran = subprocess.run([command.HEMIBAKE, *arguments], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, text=True,
                                 timeout=command.PATIENCE_S)
        self.assertEqual(ran.returncode, status, arguments)
        self.assertEqual(ran.stderr.splitlines(True)[-1], "hemibake: stdout: cannot be written: No space left on device\n", arguments)

    def test_help_and_version(self):
        for arguments in (["--help"], ["--version"], ["help", "--json"], ["bake", "--help"]):
            self.full(*arguments)

    def test_factors_compare_and_a_summary(self):
        self.write("floor.hprb", command.probes([((x / 10, 0, 0.9), (0, 1, 0), (1, 1, 1)) for x in range(-8, 9)]))
        self.full("bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--scene-linear")
        self.assertEqual(self.read("out.glb")[:4], b"glTF")
        self.full("compare", "out.glb", "floor.hprb")
        self.full("compare", "out.glb", "floor.hprb", "--json")
        self.full("factors", "scene.glb", "--tolerance", "0.1")

    def test_a_reader_that_goes_away(self):
        ran = subprocess.run(["sh", "-c", '"$0" factors scene.glb --tolerance 0.1; echo $? >status', command.HEMIBAKE], cwd=self.folder,
                             stdout=self.closed_pipe(), stderr=subprocess.PIPE, text=True, timeout=command.PATIENCE_S)
        self.assertEqual(self.read("status"), b"3\n", ran.stderr)
        self.assertIn("stdout: cannot be written: Broken pipe", ran.stderr)

    def closed_pipe(self):
        read, write = os.pipe()
        os.close(read)
        self.addCleanup(os.close, write)
        return write


if __name__ == "__main__":
    command.main()
