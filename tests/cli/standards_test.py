# SPDX-License-Identifier: MIT
"""Do others accept what a bake writes? The Khronos validator finds no error, and Draco's own decoder finds the triangles.

Needs node and the npm packages that tests/run.sh puts into build/tests; skipped without them.
"""

import os
import shutil
import subprocess
import unittest

import command
import gltf_file

NODE = shutil.which("node")
MODULES = os.environ.get("HEMIBAKE_NODE_MODULES", os.path.join(command.ROOT, "build/tests/node_modules"))
TRUTH = os.path.join(command.ROOT, "tests/accuracy/truth")


@unittest.skipUnless(NODE and os.path.isdir(os.path.join(MODULES, "gltf-validator")),
                     "needs node and the npm packages of tests/package.json: sh tests/run.sh gets them")
class Standards(command.CommandCase):
    def setUp(self):
        super().setUp()
        # Node looks for modules upwards from the script's own place.
        for script in ("validate.mjs", "same_triangles.mjs"):
            shutil.copy(os.path.join(command.ROOT, "tests/converters/gltf", script), self.folder)
        os.symlink(MODULES, self.path("node_modules"))

    def validate(self, *names):
        ran = subprocess.run([NODE, "validate.mjs", *names], cwd=self.folder, capture_output=True, text=True,
                             timeout=command.PATIENCE_S)
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)
        self.assertEqual(ran.stdout.count(": 0 errors, 0 warnings"), len(names), ran.stdout)
        return ran.stdout

    def bake_all_ways(self, scene, *arguments):
        names = []
        for end in ("glb", "gltf"):
            for draco in ((), ("--no-draco",)):
                for linear in ((), ("--scene-linear",)):
                    names.append(f"{len(names)}.{end}")
                    self.bake(scene, names[-1], "--quality", "draft", "--quiet", *draco, *linear, *arguments)
        report = self.validate(*names)
        for line in report.splitlines():
            index = int(line.split(".")[0])
            self.assertEqual(" 0 Draco primitives" in line, index // 2 % 2 == 1, line)

    def test_the_sample_room(self):
        self.bake_all_ways(os.path.join(command.SAMPLES, "pillar-room.glb"))

    def test_the_cornell_box(self):
        self.bake_all_ways(os.path.join(TRUTH, "cornell-box.glb"))

    def test_a_scene_without_normals(self):
        self.write("scene.glb", gltf_file.room().glb())
        self.bake_all_ways("scene.glb")

    def test_dracos_decoder_gives_the_triangles_of_the_plain_file(self):
        scene = os.path.join(command.SAMPLES, "pillar-room.glb")
        self.bake(scene, "plain.glb", "--quality", "draft", "--no-draco", "--quiet")
        self.bake(scene, "draco.glb", "--quality", "draft", "--quiet")
        ran = subprocess.run([NODE, "same_triangles.mjs", "plain.glb", "draco.glb"], cwd=self.folder, capture_output=True,
                             text=True, timeout=command.PATIENCE_S)
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)
        self.assertIn(" 0 different", ran.stdout)

    def test_subdivision_surfaces(self):
        self.write("scene.glb", gltf_file.room().glb())
        self.bake_all_ways("scene.glb", "--subdivide", "2", "--element-size", "0.5")

    def test_coarse_and_fine_quantisation(self):
        self.write("scene.glb", gltf_file.room().glb())
        names = []
        for bits in ("position=8,normal=6,color=8,texcoord=8", "position=20,normal=16,color=16,texcoord=16"):
            for level in (0, 10):
                names.append(f"{len(names)}.glb")
                self.bake("scene.glb", names[-1], "--quality", "draft", "--draco-bits", bits, "--draco-level", level)
        self.validate(*names)


if __name__ == "__main__":
    command.main()
