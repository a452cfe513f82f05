# SPDX-License-Identifier: MIT
"""Does it matter what draws item buffers? The same light by OpenGL and by rays, and the report says which and why."""

import json
import os
import statistics

from command import CommandCase, main
from gltf_file import Asset

ROOM = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../samples/pillar-room.glb")


class Visibility(CommandCase):
    def baked(self, *options):
        """Radiance of all vertices, and the report's solver."""
        self.ran = self.bake(ROOM, "out.glb", "--scene-linear", "--no-draco", "--merge-error", "0", "--quality", "draft", "--uniform",
                             "--report", "report.json", *options)
        asset = Asset(self.path("out.glb"))
        values = [value for mesh in asset.json["meshes"] for p in mesh["primitives"]
                  for value in asset.values(p["attributes"]["_RADIOSITY"])]
        with open(self.path("report.json"), encoding="utf-8") as f:
            return values, json.load(f)["solver"]

    def test_opengl_and_rays_give_the_same_light(self):
        by_opengl, solver = self.baked("--method", "hybrid")
        self.assertIn(solver["visibility"], ("osmesa", "egl"))
        self.assertIn("first that is there", solver["visibility_why"])
        by_rays, solver = self.baked("--method", "hybrid", "--visibility", "rays")
        self.assertEqual((solver["visibility"], solver["visibility_why"]), ("rays", "asked for"))
        self.assertEqual(len(by_opengl), len(by_rays))
        level = statistics.mean(max(value) for value in by_opengl)
        off = sorted(abs(a - b) / level for one, other in zip(by_opengl, by_rays) for a, b in zip(one, other))
        # Pixels on edges differ, so that shadows' edges do here and there.
        self.assertLess(off[len(off) // 2], 1e-3)
        self.assertLess(off[int(0.99 * len(off))], 0.05)
        self.assertGreater(off[-1], 0.0)

    def test_rows_draw_nothing(self):
        self.assertIsNone(self.baked("--method", "rows")[1]["visibility"])


if __name__ == "__main__":
    main()
