# SPDX-License-Identifier: MIT
"""Does the gallery show what was baked, with the figures of its report?"""

import math
import os
import subprocess
import sys

from command import ROOT, CommandCase, main
from gltf_file import Asset, room

SAMPLES = os.path.join(ROOT, "samples")


class Gallery(CommandCase):
    def test_the_page_shows_pictures_with_their_figures(self):
        self.write("room.glb", room().glb())
        for name in ("one", "a & b"):
            self.bake("room.glb", f"{name}.glb", "--quality", "draft", "--preview", f"{name}.jpg", "--report", f"{name}.json", "--size", "64x40")
        subprocess.run([sys.executable, os.path.join(SAMPLES, "gallery.py"), self.folder], check=True, capture_output=True)
        page = self.read("index.html").decode()
        self.assertEqual(page.count("<figure>"), 2)
        self.assertIn('src="one.jpg"', page)
        self.assertIn("a &amp; b", page)
        self.assertNotIn("a & b", page)
        self.assertRegex(page, r"\d elements in \d+\.\d s of processors; error about \d+\.\d %")
        self.assertLess(page.index("one.jpg"), page.index("a &amp; b.jpg"), "in the order in which they were baked")

    def test_the_pillar_room_is_what_its_script_writes_and_its_sphere_is_smooth(self):
        subprocess.run([sys.executable, os.path.join(SAMPLES, "pillar_room.py"), self.path("room.glb")], check=True)
        with open(os.path.join(SAMPLES, "pillar-room.glb"), "rb") as f:
            self.assertEqual(self.read("room.glb"), f.read())
        asset, corners = Asset(self.path("room.glb")), {}
        for one in asset.primitives("sphere"):
            for point, normal in zip(*(asset.values(one["attributes"][name]) for name in ("POSITION", "NORMAL"))):
                self.assertLess(math.dist(normal, corners.setdefault(point, normal)), 1e-6)
        self.assertGreater(len(corners), 100)

    def test_the_script_is_one_that_a_shell_reads(self):
        for name in ("gallery.sh", "bake.sh", "web-viewer/build.sh"):
            subprocess.run(["sh", "-n", os.path.join(SAMPLES, name)], check=True)


if __name__ == "__main__":
    main()
