# SPDX-License-Identifier: MIT
"""Are long thin triangles, of which each is many patches, solved in the way that costs less for them?"""

import json

import command
import gltf_file


def panel(scene, count):
    """A fan of so many triangles, all as high as the room, before its back wall."""
    rim = [[-0.9 + 1.8 * i / count, 0.1, -0.9] for i in range(count + 1)]
    scene.add_mesh("panel", ([[0, 1.9, -0.9], *rim], [(0, i + 1, i + 2) for i in range(count)]), 0)
    return scene


class Slivers(command.CommandCase):
    def light(self, count, *options):
        """(How it was solved, mean radiance of the panel's corners.)"""
        self.write("in.glb", panel(gltf_file.room(), count).glb())
        self.bake("in.glb", "out.glb", "--quality", "draft", "--scene-linear", "--no-draco", "--report", "r.json", *options)
        out = gltf_file.Asset(self.path("out.glb"))
        values = [v[0] for p in out.primitives("panel") for v in out.values(p["attributes"]["_RADIOSITY"])]
        return json.loads(self.read("r.json"))["solver"]["method"], sum(values) / len(values)

    def test_many_slivers_take_rows(self):
        self.assertEqual(self.light(300)[0], "rows")

    def test_a_few_large_triangles_do_not(self):
        self.assertEqual(self.light(3)[0], "hybrid")


if __name__ == "__main__":
    command.main()
