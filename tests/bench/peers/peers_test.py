# SPDX-License-Identifier: MIT
"""Do the peers bake what they are asked for, and are their times compared as they should be?

    PATH_BAKE=build/release/tests/bench/path_bake HEMIBAKE=build/release/bin/hemibake python3 tests/bench/peers/peers_test.py
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import peers  # noqa: E402
from peers import Crossing, Point  # noqa: E402

TRUTH = os.path.join(peers.ROOT, "tests", "accuracy", "truth", "cornell-box")
PATH_BAKE = os.environ.get("PATH_BAKE", os.path.join(peers.ROOT, "build", "release", "tests", "bench", "path_bake"))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(peers.ROOT, "build", "release", "bin", "hemibake"))


def tool(name, *points):
    return name, points, [Point(s, e, name) for s, e in points]


class Comparison(unittest.TestCase):
    def crossing(self, target, *points):
        return peers.crossings([tool("vertices", *points)], target)["vertices"]

    def test_between_two_bakes_a_peer_is_measured(self):
        found = self.crossing(0.05, (1, 0.1), (4, 0.025))
        self.assertEqual(found.kind, "measured")
        self.assertAlmostEqual(found.seconds, 2)

    def test_past_its_slowest_it_is_extrapolated_by_a_half_at_best(self):
        # These fall as t^-1; noise does not go on like that.
        found = self.crossing(0.0125, (1, 0.1), (2, 0.05), (4, 0.025))
        self.assertEqual(found.kind, "extrapolated")
        self.assertAlmostEqual(found.seconds, 16)

    def test_further_than_ten_times_nothing_is_claimed_but_a_bound(self):
        found = self.crossing(0.001, (1, 0.1), (2, 0.071), (4, 0.05))
        self.assertEqual((found.kind, found.seconds), ("beyond", 40))
        self.assertEqual(peers.time_shown(found), "> 40")

    def test_a_ratio_is_a_bound_where_either_time_is(self):
        ours, early = Crossing(2, "measured"), Crossing(2, "at most")
        for kind, own, expected in (("measured", ours, "4"), ("extrapolated", ours, "~ 4"), ("beyond", ours, ">= 4"),
                                    ("at most", ours, "<= 4"), ("measured", early, ">= 4"), ("at most", early, "-"),
                                    ("measured", None, "lost"), ("beyond", None, "-")):
            self.assertEqual(peers.times_slower(own, Crossing(8, kind)), expected, (kind, own))
        self.assertEqual(peers.times_slower(ours, None), "-")


class Bakes(unittest.TestCase):
    def bake(self, way, *options):
        text = subprocess.run([PATH_BAKE, way, f"{TRUTH}.glb", f"{TRUTH}.hprb", *options, "--samples", "32"], check=True,
                              stdout=subprocess.PIPE, text=True).stdout
        lines = [json.loads(line) for line in text.splitlines()]
        for line in lines:
            self.assertEqual(line["unmatched"], 0)
        return lines

    def check(self, lines):
        """Noise halves at least where paths are sixteen times as many, and what is left of it has no side."""
        errors = {n: min(line["error"] for line in lines if line["samples"] == n) for n in (2, 32)}
        self.assertLess(errors[32], errors[2] / 2)
        self.assertLess(errors[32], 0.10)  # 0.05 to 0.07 was measured
        self.assertLess(abs(lines[-1]["bias"]), 0.02)  # a few thousand vertices interpolate some contact shadows away
        for before, after in zip(lines, lines[1:]):
            if before["samples"] < after["samples"]:
                self.assertLess(before["seconds"], after["seconds"])

    def setUp(self):
        if not os.path.exists(PATH_BAKE):
            self.skipTest("there is no Embree 3 (libembree-dev)")

    def test_vertices_of_a_tessellation(self):
        self.check(self.bake("vertices", "--edge", "0.4"))

    def test_a_fit_to_a_tessellation(self):
        self.check(self.bake("fitted", "--edge", "0.4"))

    def test_a_fit_to_our_own_output(self):
        with tempfile.TemporaryDirectory() as folder:
            baked = os.path.join(folder, "baked.glb")
            subprocess.run([HEMIBAKE, "bake", f"{TRUTH}.glb", "-o", baked, "--quality", "draft", "--scene-linear", "--no-draco",
                            "--quiet"], check=True)
            self.check(self.bake("fitted", baked))

    def test_the_same_light_for_any_number_of_threads(self):
        for way in ("vertices", "fitted"):
            one, two = ([(line["error"], line["bias"]) for line in self.bake(way, "--edge", "0.6", "--threads", n)] for n in "12")
            self.assertEqual(one, two)


if __name__ == "__main__":
    unittest.main(verbosity=2)
