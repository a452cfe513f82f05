# SPDX-License-Identifier: MIT
"""Are two bakes of one scene the same file, byte for byte? For any number of threads, whatever else is asked for."""

import os
import shutil

import command
import gltf_file


class Determinism(command.CommandCase):
    def setUp(self):
        super().setUp()
        shutil.copy(os.path.join(command.SAMPLES, "pillar-room.glb"), self.path("room.glb"))

    def check_threads(self, *arguments, threads=(1, 2)):
        first = None
        for n in threads:
            self.bake("room.glb", f"{n}.gltf", "--threads", n, "--preview", f"{n}.png", *arguments)
            files = self.read(f"{n}.bin"), self.read(f"{n}.gltf").replace(f"{n}.bin".encode(), b"1.bin"), self.read(f"{n}.png")
            first = first or files
            for what, mine, theirs in zip(("geometry", "JSON", "picture"), files, first):
                self.assertTrue(mine == theirs, f"{what} of {n} threads differs from that of {threads[0]}: {arguments}")

    def test_display_colours_with_draco(self):
        self.check_threads("--quality", "draft")

    def test_display_colours_without_draco(self):
        self.check_threads("--quality", "draft", "--no-draco")

    def test_scene_linear_with_draco(self):
        self.check_threads("--quality", "draft", "--scene-linear")

    def test_scene_linear_without_draco(self):
        self.check_threads("--quality", "draft", "--scene-linear", "--no-draco", threads=(1, 2, 3, 7))

    def test_lights_and_sky(self):
        self.check_threads("--quality", "draft", "--sun", "200,50,6,1", "--environment", "0.5,0.6,0.8", threads=(1, 3))

    def test_a_glb_at_the_default_quality(self):
        for n in (1, 2):
            self.bake("room.glb", f"{n}.glb", "--threads", n)
        self.assertTrue(self.read("1.glb") == self.read("2.glb"))

    def test_memory_that_forgets_form_factors_changes_rounding_only(self):
        """Columns that are computed again are delivered in another order: sums in double, shown as float, fitted until a
        residual of 1e-7. A thousand times that is still nothing that anyone sees. Which triangles merge may hang on a
        rounding, so none do."""
        options = ("--quality", "draft", "--scene-linear", "--no-draco", "--merge-error", "0", "--uniform")
        # Less than the least is refused at once.
        least = next(m for m in range(104, 160, 2)
                     if self.run_hemibake("bake", "room.glb", "-o", "0.glb", "--memory", m, *options).returncode == 0)
        for memory in (least, 4096):
            self.bake("room.glb", f"{memory}.glb", "--memory", memory, *options)
        few, all_kept = (gltf_file.Asset(self.path(f"{memory}.glb")) for memory in (least, 4096))
        for node in (n["name"] for n in few.json["nodes"]):
            pairs = zip(few.primitives(node), all_kept.primitives(node))
            rows = [row for pair in pairs for row in zip(*(a.values(p["attributes"]["_RADIOSITY"])
                                                          for a, p in zip((few, all_kept), pair)))]
            brightest = max(x for row, _ in rows for x in row)
            worst = max(abs(x - y) for row, other in rows for x, y in zip(row, other))
            self.assertLessEqual(worst, 1e-4 * brightest, node)

    def test_the_name_and_place_of_the_input_change_nothing(self):
        os.mkdir(self.path("elsewhere"))
        shutil.copy(self.path("room.glb"), self.path("elsewhere/other.glb"))
        self.bake("room.glb", "a.glb", "--quality", "draft")
        self.bake(self.path("elsewhere/other.glb"), self.path("elsewhere/b.glb"), "--quality", "draft")
        self.assertTrue(self.read("a.glb") == self.read("elsewhere/b.glb"))

    def test_a_seed_changes_something(self):
        for seed in (0, 1):
            self.bake("room.glb", f"{seed}.glb", "--quality", "draft", "--seed", seed, "--scene-linear", "--no-draco")
        # The light, that is: an asset says by itself what it was baked with.
        lights = []
        for asset in (gltf_file.Asset(self.path(f"{seed}.glb")) for seed in (0, 1)):
            primitives = [p for node in asset.json["nodes"] for p in asset.primitives(node["name"])]
            lights.append([asset.values(p["attributes"]["_RADIOSITY"]) for p in primitives])
        self.assertTrue(all(lights))
        self.assertNotEqual(*lights)


if __name__ == "__main__":
    command.main()
