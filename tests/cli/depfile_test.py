# SPDX-License-Identifier: MIT
"""Does --depfile name what a bake depends on, in a way that Make reads?"""

import json
import os
import shutil
import subprocess
import sys

from command import OUTPUT, ROOT, SAMPLES, CommandCase, main

ASSETS = os.path.join(ROOT, "samples/asset-pipeline/assets.py")


class Depfile(CommandCase):
    def prerequisites(self, name):
        """What Make understands: its database of the rules in a depfile."""
        ran = subprocess.run(["make", "-pn", "-f", name], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(ran.returncode, 0, "a name cut in two is a file that Make cannot find")
        rules = [line for line in ran.stdout.splitlines() if line.startswith("out")]
        return rules[0].partition(": ")[2]

    def test_a_file_of_its_own_depends_on_itself(self):
        scene = os.path.join(SAMPLES, "pillar-room.glb")
        self.bake(scene, "out.glb", "--quality", "draft", "--depfile", "out.d")
        self.assertEqual(self.read("out.d").decode().split(), ["out.glb:", "\\", scene])

    def test_buffers_textures_and_configuration_are_named_whatever_they_are_called(self):
        subprocess.run([sys.executable, ASSETS, self.path("a")], check=True)
        with open(self.path("a/niche-01.gltf")) as f:
            asset = json.load(f)
        asset["buffers"][0]["uri"] = "a%20buffer%23.bin"
        asset["images"] = [{"uri": "cost$.png"}, {"uri": "data:image/png;base64,AAAA"}]
        with open(self.path("a/scene.gltf"), "w") as f:
            json.dump(asset, f)
        os.rename(self.path("a/niche-01.bin"), self.path("a/a buffer#.bin"))
        os.rename(self.path("a/plaster.png"), self.path("a/cost$.png"))
        with open(os.path.join(ROOT, "color/hemibake.ocio"), encoding="utf-8") as f:
            look = "looks:\n  - !<Look> {name: l, process_space: scene_linear, transform: !<FileTransform> {src: %s}}\n"
            self.write("my.ocio", (f.read().replace('search_path: ""', "search_path: tables") + look % "t.cube").encode())
        os.mkdir(self.path("tables"))
        self.write("tables/t.cube", b"LUT_1D_SIZE 2\n0 0 0\n1 1 1\n")
        self.bake("a/scene.gltf", "out.glb", "--quality", "draft", "--ocio", "my.ocio", "--depfile", "out.d")
        self.assertEqual(self.prerequisites("out.d"), "a/scene.gltf a/a buffer#.bin a/cost$.png my.ocio " + self.path("tables/t.cube"))

    def test_a_missing_image_is_no_reason_to_bake_for_ever(self):
        subprocess.run([sys.executable, ASSETS, self.path("a")], check=True)
        os.unlink(self.path("a/plaster.png"))
        self.bake("a/niche-01.gltf", "out.glb", "--quality", "draft", "--depfile", "out.d")
        self.assertEqual(self.read("out.d").decode().split()[2::2], ["a/niche-01.gltf", "a/niche-01.bin"])

    def test_a_failure_leaves_none(self):
        self.write("broken.gltf", b"{}")
        self.bake("broken.gltf", "out.glb", "--depfile", "out.d", status=1)
        scene = os.path.join(SAMPLES, "pillar-room.glb")
        self.bake(scene, "out.glb", "--depfile", "missing/out.d", status=OUTPUT)
        self.assertEqual(self.left(), ["broken.gltf"])


if __name__ == "__main__":
    main()
