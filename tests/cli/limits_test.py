# SPDX-License-Identifier: MIT
"""What may a file ask for: how much memory, which files, and what of them ends up in the output?"""

import json
import os
import resource
import shutil
import struct
import subprocess
import time
import zlib

import command
import gltf_file
from command import BAD_INPUT, DONE

SECRET = b"root:x:0:0:the secret of this machine:/root:/bin/sh\n"


def png(width, height, rows=None):
    """A grey PNG; without rows all of it is black, and small."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    data = b"".join(b"\0" + row for row in rows) if rows else bytes((width + 1) * height)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">II5B", width, height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b""))


def textured(uri=None, image=None):
    """A room whose walls show an image, by its uri or in the file."""
    scene = gltf_file.room()
    scene.json["images"] = [{"uri": uri}] if uri else []
    if image is not None:
        view = {"buffer": 0, "byteOffset": len(scene.bin), "byteLength": len(image)}
        scene.bin += image + bytes(-len(image) % 4)
        scene.json["bufferViews"].append(view)
        scene.json["images"] = [{"bufferView": len(scene.json["bufferViews"]) - 1, "mimeType": "image/png"}]
    scene.json["textures"] = [{"source": 0}]
    scene.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    count = scene.json["accessors"][scene.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]["count"]
    scene.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = scene._add_accessor([[0, 0]] * count, "VEC2", gltf_file.FLOAT)
    return scene


class Limits(command.CommandCase):
    def draft(self, scene, *more, status=DONE):
        return self.bake(scene, "out.glb", "--quality", "draft", *more, status=status)

    def refused(self, ran, *words):
        self.assertRegex(ran.stderr, r"\Ahemibake: [^\n]+\n\Z")
        for word in words:
            self.assertIn(word, ran.stderr)
        self.assertNotIn("out.glb", self.left())

    # ---- how much ------------------------------------------------------------------------------------------------

    def test_a_large_image_needs_the_flag(self):
        self.write("scene.glb", textured(image=png(8000, 8000)).glb())
        self.refused(self.draft("scene.glb", status=BAD_INPUT), "images[0]", "8000 x 8000", "--max-pixels")
        self.draft("scene.glb", "--max-pixels", 64000000)

    def test_a_deep_subdivision_needs_the_flag(self):
        self.write("scene.glb", gltf_file.room().glb())
        begin = time.monotonic()
        self.refused(self.draft("scene.glb", "--subdivide", 8, "--max-elements", 20000, status=BAD_INPUT), "levels", "--max-elements")
        self.assertLess(time.monotonic() - begin, 20)
        scene = gltf_file.room()  # many small cages are as much as a large one
        for i in range(60):
            scene.add_mesh(f"cage {i}", ([[i, 0, 0], [i + 1, 0, 0], [i, 1, 0], [i, 0, 1]], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]), 0)
        self.write("many.glb", scene.glb())
        self.refused(self.draft("many.glb", "--subdivide", 8, status=BAD_INPUT), "levels", "--max-elements")

    def test_a_mesh_that_many_nodes_show_needs_the_flag(self):
        """9,000 nodes show a mesh of 4,000 triangles: 36 million from 400 kB."""
        scene = gltf_file.room()
        points = [[x / 100, 0.5, z] for x in range(2001) for z in (0, 1)]
        scene.add_mesh("strip", (points, [t for x in range(0, 4000, 2) for t in ((x, x + 1, x + 2), (x + 1, x + 3, x + 2))]), 0)
        strip = len(scene.json["nodes"]) - 1
        scene.json["nodes"] += [{"mesh": scene.json["nodes"][strip]["mesh"], "translation": [0, i, 0]} for i in range(9000)]
        scene.json["scenes"][0]["nodes"] += list(range(strip + 1, strip + 9001))
        self.write("scene.glb", scene.glb())
        for command_name in ("bake", "inspect"):
            ran = self.run_hemibake(command_name, "scene.glb", *(("-o", "out.glb") if command_name == "bake" else ()))
            self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
            self.refused(ran, "scene.glb", "36004026 triangles", "32000000", "--max-elements to 4500504")

    def test_memory_is_kept_to_or_refused_with_figures(self):
        """The peak is the process's own, of the report; a sanitizer's shadow is larger than any limit."""
        if "ASAN_OPTIONS" in os.environ:
            self.skipTest("a sanitizer takes memory of its own")
        shutil.copy(os.path.join(command.SAMPLES, "pillar-room.glb"), self.path("room.glb"))
        more = ("--element-size", "0.1", "--method", "rows", "--quality", "draft", "--environment", "1,1,1", "--report", "r.json")
        peaks = {}
        for allowed in (1000, 130, 115):
            ran = self.bake("room.glb", "out.glb", *more, "--memory", allowed, status=DONE if allowed > 115 else BAD_INPUT)
            if allowed > 115:
                peaks[allowed] = json.loads(self.read("r.json"))["memory"]["peak_bytes"] / 2**20
                self.assertLessEqual(peaks[allowed], 1.1 * allowed)
                self.assertEqual("of the rays" in ran.stderr, allowed == 130, ran.stderr)
                os.remove(self.path("out.glb"))
            else:
                self.refused(ran, "115", "MiB", "larger elements")
        self.assertLess(peaks[130], peaks[1000])

    def test_memory_is_for_pictures_too(self):
        """Of 12 million pixels: 98 MB while they are decoded."""
        if "ASAN_OPTIONS" in os.environ:
            self.skipTest("a sanitizer takes memory of its own")
        self.write("scene.glb", textured(image=png(3500, 3500)).glb())
        self.refused(self.draft("scene.glb", "--memory", 140, status=BAD_INPUT), "images[0]", "--memory leaves")
        self.draft("scene.glb", "--memory", 300, "--report", "r.json")
        self.assertLessEqual(json.loads(self.read("r.json"))["memory"]["peak_bytes"] / 2**20, 330)

    def test_a_hole_of_two_gigabytes_takes_none(self):
        """As the asset, as its buffer, and as what 'factors' reads."""
        scene = gltf_file.room()
        scene.json["buffers"] = [{"uri": "hole.bin", "byteLength": len(scene.bin)}]
        self.write("scene.gltf", json.dumps(scene.json).encode())
        names = ("hole.glb", "hole.gltf", "hole.bin", "hole.vs3", "hole.hdr")
        for name in names:
            with open(self.path(name), "wb") as f:
                if name == "hole.glb":
                    f.write(struct.pack("<4sII", b"glTF", 2, 2**31 - 4) + struct.pack("<I4s", 2**31 - 24, b"JSON"))
                f.truncate(2**31 - 4 if name != "hole.hdr" else 2**30)
        self.write("room.glb", gltf_file.room().glb())
        # A sanitizer's shadow of the memory is larger than any limit; what it takes is seen in the other build.
        limit = None if "ASAN_OPTIONS" in os.environ else lambda: resource.setrlimit(resource.RLIMIT_DATA, (2**30, 2**30))
        for arguments in (["bake", "hole.glb", "-o", "out.glb"], ["bake", "hole.gltf", "-o", "out.glb"], ["bake", "scene.gltf", "-o", "out.glb"],
                          ["factors", "hole.vs3"], ["factors", "hole.glb"], ["compare", "hole.glb", "x.hprb"],
                          ["bake", "room.glb", "-o", "out.glb", "--environment", "hole.hdr"]):
            begin = time.monotonic()
            ran = self.run_hemibake(*arguments, preexec_fn=limit)
            self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
            self.refused(ran)
            self.assertLess(time.monotonic() - begin, 20)

    # ---- what kind of file -----------------------------------------------------------------------------------------

    def test_a_fifo_that_nobody_writes_to_does_not_block(self):
        self.write("room.glb", gltf_file.room().glb())
        for name in ("pipe.vs3", "pipe.glb", "pipe.hprb", "pipe"):
            os.mkfifo(self.path(name))
        for arguments in (["factors", "pipe.vs3"], ["factors", "pipe.glb"], ["factors", "pipe"], ["bake", "pipe.glb", "-o", "out.glb"],
                          ["bake", "room.glb", "-o", "out.glb", "--reference", "pipe.hprb"]):
            begin = time.monotonic()
            ran = self.run_hemibake(*arguments)
            self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
            self.refused(ran, "FIFO that nobody writes to")
            self.assertLess(time.monotonic() - begin, 20)
        for more, env in ((["--ocio", "pipe"], None), ([], dict(os.environ, OCIO="pipe"))):
            ran = self.run_hemibake("bake", "room.glb", "-o", "out.glb", *more, env=env)
            self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
            self.refused(ran, "pipe: it is a FIFO")

    def test_process_substitution_is_read(self):
        if not shutil.which("bash"):
            self.skipTest("no bash")
        self.write("room.glb", gltf_file.room().glb())
        shutil.copy(os.path.join(command.SAMPLES, "l-room.vs3"), self.path("l-room.vs3"))
        for name in ("room.glb", "l-room.vs3"):
            direct = self.succeed("factors", name, "--tolerance", "0.1").stdout
            for reader in ("<(cat $1)", "<(sleep 0.3; head -c 100 $1; sleep 3; tail -c +101 $1)", "/dev/stdin < <(cat $1)"):
                ran = subprocess.run(["bash", "-c", f'"$0" factors {reader} --tolerance 0.1', command.HEMIBAKE, name], cwd=self.folder,
                                     capture_output=True, text=True, timeout=command.PATIENCE_S)
                self.assertEqual((ran.returncode, ran.stdout), (DONE, direct), (reader, ran.stderr))

    def test_devices_are_not_read(self):
        for name in ("/dev/zero", "/dev/null", "/dev/tty"):
            ran = self.run_hemibake("factors", name)
            self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
            self.refused(ran)

    # ---- which file ------------------------------------------------------------------------------------------------

    def make_places(self):
        """A secret beside the asset's folder, and every way that a name leads to it."""
        os.makedirs(self.path("asset/sub"))
        os.makedirs(self.path("textures"))
        self.write("secret", SECRET)
        self.write("textures/wall.png", png(4, 4))
        os.symlink("../secret", self.path("asset/link.png"))
        os.symlink("../textures", self.path("asset/folder"))
        return ["../secret", "%2e%2e/secret", "sub/../../secret", "link.png", self.path("secret").lstrip("/"), "..%2fsecret"]

    def test_only_pictures_are_embedded_as_images(self):
        for uri in self.make_places():
            with self.subTest(uri):
                self.write("asset/scene.glb", textured(uri=uri).glb())
                ran = self.draft("asset/scene.glb")
                self.assertNotIn(b"secret of this machine", self.read("out.glb"))
                self.assertIn("image 0: ", ran.stderr)

    def test_textures_beside_the_folder_are_read(self):
        self.make_places()
        for uri in ("../textures/wall.png", "%2e%2e/textures/wall.png", "folder/wall.png"):
            self.write("asset/scene.glb", textured(uri=uri).glb())
            ran = self.draft("asset/scene.glb")
            self.assertNotIn("image 0", ran.stderr)
            self.assertIn(png(4, 4), self.read("out.glb"))

    def test_root_confines_images_and_buffers(self):
        self.make_places()
        for uri in ("../textures/wall.png", "%2e%2e/textures/wall.png", "folder/wall.png"):
            self.write("asset/scene.glb", textured(uri=uri).glb())
            ran = self.draft("asset/scene.glb", "--root", "asset")
            self.assertIn("image 0: ", ran.stderr)
            self.assertIn("outside of the folder", ran.stderr)
            self.assertNotIn(png(4, 4), self.read("out.glb"))
            self.draft("asset/scene.glb", "--root", ".")
            self.assertIn(png(4, 4), self.read("out.glb"))
            os.remove(self.path("out.glb"))
        scene = gltf_file.room()
        self.write("room.bin", bytes(scene.bin))
        os.symlink("../room.bin", self.path("asset/linked.bin"))
        for uri in ("../room.bin", "linked.bin"):
            scene.json["buffers"] = [{"uri": uri, "byteLength": len(scene.bin)}]
            self.write("asset/scene.gltf", json.dumps(scene.json).encode())
            self.refused(self.draft("asset/scene.gltf", "--root", "asset", status=BAD_INPUT), "buffers[0]", "outside of the folder")

    def test_root_confines_what_the_command_names(self):
        self.make_places()
        self.write("asset/room.glb", gltf_file.room().glb())
        self.write("room.glb", gltf_file.room().glb())
        self.write("sky.hdr", b"#?RADIANCE\n")
        self.write("config.ocio", b"ocio_profile_version: 2\n")
        self.write("truth.hprb", command.probes([((0, 0, 0.9), (0, 1, 0), (1, 1, 1))]))
        os.mkdir(self.path("asset2"))  # begins like asset
        self.write("asset2/room.glb", gltf_file.room().glb())
        for more in (["--environment", "sky.hdr"], ["--ocio", "config.ocio"], ["--reference", "truth.hprb"]):
            self.refused(self.draft("asset/room.glb", "--root", "asset", *more, status=BAD_INPUT), more[1], "outside of the folder")
        for scene in ("room.glb", "asset2/room.glb", "asset/../room.glb"):
            self.refused(self.draft(scene, "--root", "asset", status=BAD_INPUT), "outside of the folder")
        for arguments in (["factors", "room.glb"], ["compare", "room.glb", "x.hprb"], ["render", "room.glb", "-o", "x.png"]):
            ran = self.run_hemibake(*arguments, "--root", "asset")
            self.assertEqual(ran.returncode, BAD_INPUT)
            self.refused(ran, "outside of the folder")
        self.draft("asset/room.glb", "--root", "asset")

    def test_root_confines_tables_of_a_configuration(self):
        """By their place, by links, by the search path and by variables; and tables that ask for further ones."""
        self.make_places()
        self.write("asset/room.glb", gltf_file.room().glb())
        with open(os.path.join(command.ROOT, "color", "hemibake.ocio"), encoding="utf-8") as f:
            own = f.read()
        table = b"LUT_1D_SIZE 2\n0 0 0\n1 1 1\n"
        for name in ("outside.cube", "asset/inside.cube", "textures/far.cube"):
            self.write(name, table)
        os.symlink("../outside.cube", self.path("asset/link.cube"))
        reference = '<{0}Reference path="x.cube" inBitDepth="32f" outBitDepth="32f"/>'
        clf = '<?xml version="1.0"?>{1}<ProcessList id="a" version="1.3">' + reference + "</ProcessList>"
        self.write("asset/asks.ctf", clf.format("", "").encode())
        self.write("asset/asks16.ctf", clf.format("", "").encode("utf-16"))
        self.write("asset/hides.ctf", clf.format("", '<!DOCTYPE a [<!ENTITY b "&#60;Reference/>">]>').encode())
        allowed = ("inside.cube", "lost.cube")
        for source in (*allowed, "link.cube", "../outside.cube", self.path("outside.cube"), "$UP/outside.cube", "far.cube", "asks.ctf",
                       "asks16.ctf", "hides.ctf"):
            for kind in ("", "looks", "named_transforms") if source == "link.cube" else ("",):
                transform = f'!<GroupTransform> {{children: [!<FileTransform> {{src: "{source}"}}]}}'
                text = own.replace('search_path: ""', "search_path: .:../textures").replace("environment: {}", "environment: {UP: ..}")
                if kind:
                    text += {"looks": f"looks:\n  - !<Look> {{name: l, process_space: scene_linear, transform: {transform}}}\n",
                             "named_transforms": f"named_transforms:\n  - !<NamedTransform> {{name: n, transform: {transform}}}\n"}[kind]
                else:
                    text += f"  - !<ColorSpace> {{name: tabled, to_scene_reference: {transform}}}\n"
                self.write("asset/c.ocio", text.encode())
                more = ("--ocio", "asset/c.ocio", "--element-size", "1", "--patch-size", "2")
                with self.subTest(source=source, kind=kind):
                    if source in allowed:
                        self.draft("asset/room.glb", "--root", "asset", *more)
                        os.remove(self.path("out.glb"))
                    else:
                        words = ("further files",) if source.endswith(".ctf") else ("outside of the folder",)
                        self.refused(self.draft("asset/room.glb", "--root", "asset", *more, status=BAD_INPUT), "c.ocio", "table", *words)
        self.draft("asset/room.glb", *more)  # without --root any table may be named


if __name__ == "__main__":
    command.main()
