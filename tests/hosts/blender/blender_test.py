# SPDX-License-Identifier: MIT
"""Does the add-on export what Blender shows, with the light that Cycles gives? In Blender without a window.

Relative error: the root of the squared differences over the root of the squared truth, over all texels of all walls, of radiance.
"""

import json
import os
import shutil
import struct
import sys
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.dirname(HERE), os.path.join(os.path.dirname(os.path.dirname(HERE)), "cli")]
import gltf_file
from host import BUILD, ROOT, HostCase, main

ADDON = os.path.join(ROOT, "plugin/hosts/blender/hemibake")
PROGRAM = os.path.join(BUILD, "bin/hemibake")


def to_blender(p):
    """glTF is y up."""
    return (p[0], -p[2], p[1])


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


class Wall:
    """Radiance of a baked wall at any point of it, by its texture coordinates."""

    def __init__(self, asset, name, origin, u, v):
        (primitive,) = asset.primitives(name)
        points = map(to_blender, asset.values(primitive["attributes"]["POSITION"]))
        self.uv = [(dot(sub(p, origin), u) / dot(u, u), dot(sub(p, origin), v) / dot(v, v)) for p in points]
        self.radiance = asset.values(primitive["attributes"]["_RADIOSITY"])
        flat = [i for (i,) in asset.values(primitive["indices"])]
        self.triangles = [flat[i : i + 3] for i in range(0, len(flat), 3)]

    def at(self, x, y):
        best, closest = None, -1e9
        for triangle in self.triangles:
            (ax, ay), (bx, by), (cx, cy) = (self.uv[i] for i in triangle)
            whole = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
            if whole == 0:
                continue
            b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / whole
            c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / whole
            weights = (1 - b - c, b, c)
            if min(weights) > closest:
                closest, best = min(weights), (triangle, weights)
            if closest >= 0:
                break
        return [sum(w * self.radiance[i][k] for i, w in zip(*best)) for k in range(3)]


@unittest.skipUnless(shutil.which("blender"), "no Blender here (apt install blender)")
class Blender(HostCase):
    def setUp(self):
        super().setUp()
        os.makedirs(self.path("scripts/addons"))
        os.symlink(ADDON, self.path("scripts/addons/hemibake"))
        os.makedirs(self.path("bin"))
        os.symlink(PROGRAM, self.path("bin/hemibake"))

    def inside(self, task):
        # Debian's Blender takes its modules from the Python that PATH shows first; that has to be Debian's, which has numpy.
        environment = dict(os.environ, BLENDER_USER_SCRIPTS=self.path("scripts"), PYTHONDONTWRITEBYTECODE="1",
                           PATH=self.path("bin") + ":/usr/bin:/bin", HOME=self.folder)
        self.run_program("blender", "-b", "--factory-startup", "--python-exit-code", "1", "-t", "2", "-P",
                         os.path.join(HERE, "inside.py"), "--", task, self.folder, env=environment)
        with open(self.path(task + ".json")) as f:
            return json.load(f)

    def error(self, done):
        asset = gltf_file.Asset(self.path("room.glb"))
        difference = truth = 0.0
        for name, frame in done["walls"].items():
            wall, rows = Wall(asset, name, *frame), done["truth"][name]
            for y, row in enumerate(rows):
                for x, texel in enumerate(row):
                    ours = wall.at((x + 0.5) / len(row), (y + 0.5) / len(rows))
                    difference += sum(d * d for d in sub(ours, texel))
                    truth += dot(texel, texel)
        return (difference / truth) ** 0.5

    def check_against_cycles(self, task):
        done = self.inside(task)
        self.assertEqual(done["result"], ["FINISHED"])
        self.assertTrue(done["left"], "the scene is as it was before the export")
        error = self.error(done)
        print(f"{task}: {100 * error:.2f} % from Cycles; export and bake {done['seconds'][0]:.1f} s, Cycles {done['seconds'][1]:.1f} s")
        # Promised; Cycles' own noise at these samples is about 1 %.
        self.assertLessEqual(error, 0.05)

    def test_area_lamps_and_emission_arrive(self):
        self.check_against_cycles("area")

    def test_points_spots_and_the_sun_arrive(self):
        self.check_against_cycles("lamps")

    def test_the_panel_reaches_the_program_and_errors_the_interface(self):
        done = self.inside("options")
        self.assertEqual([done[key] for key in ("first", "gltf", "time", "selection")], [["FINISHED"]] * 4, done)
        for name in ("a.glb", "a.json", "a.png", "b.gltf", "b.bin", "e.glb", "g.glb"):
            self.assertTrue(os.path.exists(self.path(name)), name)
        for key, word in (("bad view", "None such"), ("bad folder", "cannot be written"), ("no program", "is not found"),
                          ("dark", "no light reaches the front of a surface")):
            self.assertIn(word, done[key])
        for name in ("c.glb", "f.glb", "h.glb"):
            self.assertFalse(os.path.exists(self.path(name)), name)
        names = {node["name"] for node in gltf_file.Asset(self.path("g.glb")).json["nodes"] if "mesh" in node}
        self.assertEqual(names, {"floor", "lamp (hemibake)"})

    def test_what_objects_and_materials_ask_leaves_as_extras(self):
        done = self.inside("steering")
        self.assertEqual(done["result"], ["FINISHED"], done)
        asset = gltf_file.Asset(self.path("steered.glb"))
        asked = {one["name"]: one["extras"]["hemibake"] for kind in ("nodes", "materials") for one in asset.json[kind]
                 if "hemibake" in one.get("extras", {})}
        self.assertEqual(asked, {"floor": {"bake": False, "castShadow": False, "elementSize": 0.25, "normals": "faces"},
                                 self.emitter(asset): {"emission": 2.5}})
        (primitive,) = asset.primitives("floor")
        self.assertNotIn("COLOR_0", primitive["attributes"], "it stays as it is")
        with open(self.path("plain.glb"), "rb") as f:
            self.assertEqual(f.read().count(b'"hemibake"'), 1, "of Blender's own exporter: the material's alone")

    def emitter(self, asset):
        return next(one["name"] for one in asset.json["materials"] if one.get("extras", {}).get("hemibake", {}).get("emission"))

    def test_cages_become_their_limit_surface(self):
        done = self.inside("cages")
        self.assertEqual((done["applied"], done["cage"], done["modifiers"]), (["FINISHED"], ["FINISHED"], [True]))
        self.assertIn("have the levels [1, 2]", done["levels"])
        self.assertIn("has no Subdivision Surface", done["without"])
        radii = {}
        for name in ("applied", "cage"):
            asset = gltf_file.Asset(self.path(name + ".glb"))
            (primitive,) = asset.primitives("ball")
            radii[name] = max(dot(p, p) ** 0.5 for p in asset.values(primitive["attributes"]["POSITION"]))
        # Blender, too, moves vertices to the limit.
        self.assertAlmostEqual(radii["cage"] / radii["applied"], 1.0, delta=0.01)

    def test_the_hook_bakes_what_the_exporter_wrote(self):
        done = self.inside("hook")
        self.assertEqual((done["off"], done["on"], done["untouched"]), ([], [], True))
        for key, word in (("bad view", "None such"), ("no program", "is not found"), ("missing", "missing.glb")):
            (text,) = done[key]
            self.assertIn(word, text)
        self.assertEqual(done["still untouched"], sorted([*self.KEPT, "apart.bin", "apart.gltf", "hooked.glb"]))
        with open(self.path("hooked.glb"), "rb") as f:
            data = f.read()
        tree = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
        with open(self.path("apart.gltf")) as f:
            apart = json.load(f)
        for each in (tree, apart):
            self.assertIn("KHR_materials_unlit", each["extensionsUsed"])
        self.assertNotEqual(*done["sizes"])
        self.assertTrue(done["again"], "the add-on goes off and on again")

    # What is in the folder before Blender starts.
    KEPT = ("bin", "scripts")

    def test_the_exporter_of_4_4_gets_a_box(self):
        done = self.inside("panel")
        self.assertEqual(done["closed"], ["bake_on_export"])
        self.assertEqual(done["open"][:2], ["bake_on_export", "quality"])
        self.assertIn("draco", done["open"])
        self.assertEqual(done["left"], ["other"], "it goes with the add-on")

    def test_in_a_window_it_shows_progress_and_is_cancelled_by_esc(self):
        done = self.inside("modal")
        for key in ("whole", "refused", "escaped", "killed"):
            self.assertTrue(done[key]["timer gone"], key)
            self.assertFalse(done[key]["folder"] or done[key]["running"], key)
            self.assertEqual(done[key]["progress"], sorted(done[key]["progress"]), key)
            self.assertIsNone(done[key]["status"][-1], "the status bar is given back")
            self.assertEqual(done[key]["file"], key == "whole", key)
        whole, refused, escaped, killed = (done[key] for key in ("whole", "refused", "escaped", "killed"))
        self.assertEqual((whole["answer"], whole["passed"], whole["progress"][-1]), ("FINISHED", True, 100))
        self.assertEqual(whole["reports"][-1], ["INFO", f"Baked {self.path('whole.glb')}"])
        self.assertRegex(whole["status"][0], r"^hemibake: \d+ % .* Esc: Cancel$")
        self.assertEqual(refused["answer"], "CANCELLED")
        self.assertIn("None such", refused["reports"][-1][1])
        self.assertEqual((escaped["answer"], escaped["reports"]), ("CANCELLED", [["WARNING", "Cancelled; nothing is written"]]))
        self.assertGreater(escaped["progress"][-1], 0)
        self.assertEqual((killed["answer"], killed["reports"]), ("CANCELLED", [["ERROR", "hemibake was ended by signal 9"]]))
        self.assertEqual((done["not begun"]["answer"], done["not begun"]["calls"]), ("CANCELLED", []))
        self.assertIn("is not found", done["not begun"]["reports"][0][1])


if __name__ == "__main__":
    main()
