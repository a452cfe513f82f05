# SPDX-License-Identifier: MIT
"""Does any damage to a file crash the command? Bytes and JSON values of a small scene are changed at random, from a seed.

Whatever comes out is a bake or one line and a promised exit status; nothing else is left behind. Worth most in the
sanitized build.
"""

import copy
import os
import random

import command
import gltf_file

SEED, BYTE_DAMAGES, JSON_DAMAGES = 1989, 60, 90
ODD_VALUES = (None, True, -1, 0, 1, 2**31, 2**32, 2**53, 1e308, -1e308, 0.5, "", "x", "data:;base64,", [], {}, [[]], [0] * 3)


def places(tree, at=()):
    """Path of every value in a JSON tree."""
    yield at
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield from places(value, (*at, key))


def damage_json(tree, random_source):
    tree = copy.deepcopy(tree)
    *parents, last = random_source.choice([p for p in places(tree) if p])
    holder = tree
    for key in parents:
        holder = holder[key]
    if random_source.random() < 0.25:
        del holder[last]
    else:
        holder[last] = random_source.choice(ODD_VALUES)
    return tree


def damage_bytes(data, random_source):
    data = bytearray(data)
    for _ in range(random_source.choice((1, 2, 8))):
        data[random_source.randrange(len(data))] = random_source.choice((0, 1, 0x7F, 0x80, 0xFF, random_source.randrange(256)))
    return bytes(data)


class Hostile(command.CommandCase):
    def survive(self, data, what):
        self.write("scene.glb", data)
        ran = self.run_hemibake("bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--max-elements", 20000, "--time", 2,
                                "--quiet")
        with self.subTest(what):
            self.assertIn(ran.returncode, (command.DONE, command.BAD_INPUT, command.NOT_CONVERGED), ran.stderr)
            if ran.returncode == command.BAD_INPUT:
                self.assertRegex(ran.stderr, r"\Ahemibake: [^\n]+\n\Z")
                self.assertEqual(self.left(), ["scene.glb"])
            else:
                self.assertEqual(self.left(), ["out.glb", "scene.glb"])
        for name in set(self.left()) - {"scene.glb"}:
            os.remove(self.path(name))

    def test_damaged_bytes(self):
        random_source, whole = random.Random(SEED), gltf_file.room().glb()
        for i in range(BYTE_DAMAGES):
            self.survive(damage_bytes(whole, random_source), f"bytes {i}")

    def test_damaged_json(self):
        random_source, scene = random.Random(SEED), gltf_file.room()
        scene.json["buffers"] = [{"byteLength": len(scene.bin)}]
        for i in range(JSON_DAMAGES):
            self.survive(gltf_file.glb(damage_json(scene.json, random_source), bytes(scene.bin)), f"JSON {i}")

    def test_damaged_draco(self):
        self.write("scene.glb", gltf_file.room().glb())
        self.bake("scene.glb", "baked.glb", "--quality", "draft")
        random_source, whole = random.Random(SEED), self.read("baked.glb")
        start = whole.index(b"BIN\0") + 4
        os.remove(self.path("baked.glb"))
        for i in range(BYTE_DAMAGES):
            self.survive(whole[:start] + damage_bytes(whole[start:], random_source), f"Draco {i}")


if __name__ == "__main__":
    command.main()
