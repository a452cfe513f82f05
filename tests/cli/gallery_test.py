# SPDX-License-Identifier: MIT
"""Does the gallery show what was baked, with the figures of its report?"""

import os
import subprocess
import sys

from command import ROOT, CommandCase, main
from gltf_file import room

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

    def test_the_script_is_one_that_a_shell_reads(self):
        for name in ("gallery.sh", "bake.sh", "web-viewer/build.sh"):
            subprocess.run(["sh", "-n", os.path.join(SAMPLES, name)], check=True)


if __name__ == "__main__":
    main()
