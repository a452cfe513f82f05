# SPDX-License-Identifier: MIT
"""Does --root hold a USD stage? Layers, whatever names them, and pictures, links followed; and a FIFO in the place of a stage."""

import os
import subprocess
import sys
import time

from command import BAD_INPUT, DONE, main
from gltf_file import png
from usd_file import SKY, UsdCase, quad

TEXTURED = """def Material "{0}" {{
    token outputs:surface.connect = </World/{0}/S.outputs:surface>
    def Shader "S" {{
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </World/{0}/T.outputs:rgb>
        token outputs:surface
    }}
    def Shader "T" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @{1}@
        color3f outputs:rgb
    }}
}}
"""
BOUND = """rel material:binding = </World/{}>
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "vertex")"""
OTHER = png(4, 4, lambda x, y: (20, 10, 5))
PICTURE = png(4, 4, lambda x, y: (200, 100, 50))
CLIPS = 'def Xform "C" (clips = {\n dictionary default = {\n asset[] assetPaths = [@../other.usda@]\n string primPath = "/World"\n}\n}) {}\n'


class Roots(UsdCase):
    def setUp(self):
        super().setUp()
        os.makedirs(self.path("in/sub"))
        self.stage(quad("Other"), "other.usda")
        self.stage(quad("Inner"), "in/inner.usda")
        os.symlink("../other.usda", self.path("in/link.usda"))
        self.write("other.png", OTHER)
        self.write("in/wall.png", PICTURE)

    def bake_within(self, body, *more):
        self.stage(SKY + quad("Floor") + body, "in/stage.usda")
        return self.run_hemibake("bake", "in/stage.usda", "-o", "out.glb", "--quality", "draft", "--no-draco", "--root", "in", *more)

    def test_layers_outside_are_refused(self):
        bodies = ('def "A" (references = @{}@) {{}}\n', 'def "A" (payload = @{}@) {{}}\n',
                  'def "A" (variantSets = "v") {{\n variantSet "v" = {{\n "x" {{\n def "B" (references = @{}@) {{}}\n}}\n}}\n}}\n')
        for named, body in (("../other.usda", bodies[0]), ("link.usda", bodies[1]), (self.path("other.usda"), bodies[2])):
            with self.subTest(named):
                ran = self.bake_within(body.format(named))
                self.assertEqual(ran.returncode, BAD_INPUT, ran.stderr)
                self.assertRegex(ran.stderr, r"\Ahemibake: in/stage\.usda: [^\n]*outside of the folder that --root allows\n\Z")
        self.stage('def "A" (references = @../other.usda@) {}\n', "in/between.usda")
        ran = self.bake_within('def "A" (references = @between.usda@) {}\n')
        self.assertEqual(ran.returncode, BAD_INPUT, "a layer that a layer names")
        self.assertIn("between.usda", ran.stderr)

    def test_clips_are_refused(self):
        ran = self.bake_within(CLIPS)
        self.assertEqual(ran.returncode, BAD_INPUT)
        self.assertIn("value clips", ran.stderr)

    def test_what_lies_inside_is_read(self):
        body = TEXTURED.format("Paint", "wall.png") + TEXTURED.format("Other", "../other.png") + 'def "A" (references = @inner.usda@) {}\n'
        ran = self.bake_within(body + quad("Wall", BOUND.format("Paint"), y=1.0) + quad("Back", BOUND.format("Other"), y=2.0), "--depfile", "out.d")
        self.assertEqual(ran.returncode, DONE, ran.stderr)
        written, listed = self.read("out.glb"), self.read("out.d").decode()
        self.assertEqual((PICTURE in written, OTHER in written), (True, False), ran.stderr)
        self.assertEqual([name in listed for name in ("in/stage.usda", "inner.usda", "wall.png", "other.png")], [True] * 3 + [False], listed)

    def test_a_stage_outside_is_refused(self):
        ran = self.run_hemibake("bake", "other.usda", "-o", "out.glb", "--root", "in")
        self.assertEqual((ran.returncode, "outside of the folder" in ran.stderr), (BAD_INPUT, True))

    def test_a_package_is_read(self):
        self.stage(SKY + quad("Floor"), "in/stage.usda")
        made = "from pxr import UsdUtils; import sys; sys.exit(not UsdUtils.CreateNewUsdzPackage('in/stage.usda', 'in/p.usdz'))"
        subprocess.run([sys.executable, "-c", made], cwd=self.folder, check=True, capture_output=True)
        ran = self.run_hemibake("bake", "in/p.usdz", "-o", "out.glb", "--quality", "draft", "--root", "in")
        self.assertEqual(ran.returncode, DONE, ran.stderr)

    def test_a_fifo_is_no_stage(self):
        os.mkfifo(self.path("pipe.usda"))
        begin = time.monotonic()
        ran = self.run_hemibake("bake", "pipe.usda", "-o", "out.glb")
        self.assertEqual((ran.returncode, "FIFO" in ran.stderr), (BAD_INPUT, True), ran.stderr)
        self.assertLess(time.monotonic() - begin, 30)


if __name__ == "__main__":
    main()
