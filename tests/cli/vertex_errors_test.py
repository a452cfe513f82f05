# SPDX-License-Identifier: MIT
"""Does _ERROR say where the estimated error lies, and come with every kind of mesh?"""

import json
import math
import os
import shutil

import gltf_file
from command import ROOT, CommandCase, main

TRUTH = os.path.join(ROOT, "tests/accuracy/truth/pillar-room.glb")


def area(a, b, c):
    u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    return 0.5 * math.sqrt(sum(x * x for x in n))


class VertexErrors(CommandCase):
    def rows(self, name):
        """(positions, errors, triangles) of each baked primitive of what does not emit."""
        asset = gltf_file.Asset(self.path(name))
        for mesh in asset.json["meshes"]:
            for primitive in mesh["primitives"]:
                at = primitive["attributes"]
                indices = [i for i, in asset.values(primitive["indices"])]
                yield asset.values(at["POSITION"]), [e for e, in asset.values(at["_ERROR"])], list(zip(*[iter(indices)] * 3))

    def estimate(self, name):
        return json.loads(self.read(name))["error"]["estimate"]

    def test_the_mean_square_is_the_square_of_the_estimate(self):
        shutil.copy(TRUTH, self.path("room.glb"))
        self.bake("room.glb", "out.glb", "--quality", "draft", "--no-draco", "--vertex-errors", "--merge-error", "0", "--report", "out.json")
        square = whole = largest = 0.0
        for positions, errors, triangles in self.rows("out.glb"):
            for t in triangles:
                a = area(*(positions[i] for i in t))
                square += a * sum(errors[i] ** 2 for i in t) / 3
                whole += a
            largest = max(largest, max(errors))
        found = math.sqrt(square / whole)
        # Meshes of the truth are not scaled; its lamp, a hundredth of the area, has no error, and nodes at its rim count twice.
        self.assertLess(abs(found / self.estimate("out.json") - 1), 0.1, found)
        self.assertGreater(largest, 3 * found, "it is not the same everywhere")

    def test_draco_keeps_it_as_it_is_and_it_is_there_on_request_alone(self):
        self.write("room.glb", gltf_file.room().glb())
        self.bake("room.glb", "packed.glb", "--quality", "draft", "--vertex-errors")
        self.bake("room.glb", "plain.glb", "--quality", "draft")
        packed, plain = gltf_file.Asset(self.path("packed.glb")), gltf_file.Asset(self.path("plain.glb"))
        for primitive in (p for m in packed.json["meshes"] for p in m["primitives"]):
            self.assertEqual(packed.json["accessors"][primitive["attributes"]["_ERROR"]]["type"], "SCALAR")
            self.assertIn("_ERROR", primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"])
        self.assertNotIn(b"_ERROR", self.read("plain.glb"))
        self.assertTrue(plain.json)

    def test_flat_and_kept_meshes_and_copies_have_it_too(self):
        scene = gltf_file.room()
        scene.json["nodes"].append({"name": "twin", "mesh": scene.json["nodes"][-1]["mesh"]})
        scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)
        self.write("room.glb", scene.glb())
        for name, options in (("flat", ["--flat"]), ("shared", ["--keep-instances"]), ("pbr", ["--keep-pbr"])):
            self.bake("room.glb", f"{name}.glb", "--quality", "draft", "--no-draco", "--vertex-errors", *options)
            found = list(self.rows(f"{name}.glb"))
            self.assertTrue(found)
            for positions, errors, _ in found:
                self.assertEqual(len(errors), len(positions))
                self.assertTrue(all(0 <= e < 1 for e in errors))

    def test_a_second_bake_takes_its_own(self):
        self.write("room.glb", gltf_file.room().glb())
        self.bake("room.glb", "once.glb", "--quality", "draft", "--no-draco", "--vertex-errors", "--keep-pbr")
        self.bake("once.glb", "twice.glb", "--quality", "draft", "--no-draco")
        self.assertNotIn(b"_ERROR", self.read("twice.glb"))


if __name__ == "__main__":
    main()
