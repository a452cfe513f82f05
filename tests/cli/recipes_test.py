# SPDX-License-Identifier: MIT
"""Does every line of samples/RECIPES.md do what it says? Each runs as it stands, on a small room, in the order of the page."""

import json
import os
import re
import shlex
import shutil

import gltf_file
from command import DONE, NOT_CONVERGED, ROOT, CommandCase, main

# So small that a line takes a fraction of a second; lines that say how fine keep their word.
COARSE = ["--quality", "draft"]
SERVES = "view"


def blocks(kind):
    with open(os.path.join(ROOT, "samples/RECIPES.md"), encoding="utf-8") as f:
        return re.findall(rf"```{kind}\n(.*?)```", f.read(), re.S)


def spread(folder, word):
    return sorted(name for name in os.listdir(folder) if name.endswith(word[1:])) if word.startswith("*.") else [word]


class Recipes(CommandCase):
    def test_every_line_runs(self):
        lines = [shlex.split(line, comments=True)[1:] for block in blocks("sh") for line in block.splitlines()]
        self.assertGreater(len(lines), 20)
        for name in ("room.glb", "before.glb"):
            self.write(name, gltf_file.room().glb())
        for words in lines:
            if words[0] == SERVES:
                continue
            if "--resume" in words:
                # What was kept is gone with the end of that bake: there is nothing to go on from, and it says so.
                self.assertIn(words[words.index("--resume") + 1], self.run_hemibake(*words).stderr)
                continue
            if "*.glb" in words:
                for name in os.listdir(self.folder):
                    if name not in ("room.glb", "before.glb"):
                        shutil.rmtree(self.path(name)) if os.path.isdir(self.path(name)) else os.remove(self.path(name))
            words = [name for word in words for name in spread(self.folder, word)]
            coarse = [] if words[0] != "bake" or {"--error", "--time", "--quality"} & set(words) else COARSE
            done = self.run_hemibake(*words, *coarse)
            self.assertIn(done.returncode, (DONE, NOT_CONVERGED) if "--time" in words else (DONE,), f"{words}: {done.stderr}")
            for option in ("-o", "--preview", "--report", "--heatmap", "--depfile", "--rows"):
                if option in words and "--turntable" not in words:
                    self.assertTrue(os.path.exists(self.path(words[words.index(option) + 1])), words)

    def test_what_it_says_of_extras_is_known(self):
        known = {"bake", "castShadow", "elementSize", "group", "normals", "emission"}
        lines = [json.loads(line) for block in blocks("json") for line in block.splitlines()]
        self.assertEqual(len(lines), 3)
        for line in lines:
            self.assertLessEqual(set(line["extras"]["hemibake"]), known)


if __name__ == "__main__":
    main()
