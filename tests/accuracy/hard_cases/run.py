# SPDX-License-Identifier: MIT
"""Do the hard cases come out right, on both roads? One table: case, error, estimate, worst region, time; ends with how many are right.

    python3 tests/accuracy/hard_cases/run.py [--quality draft|medium|high] [--road columns|rows|both] [--quick] [--no-turns] [case ...]

The truth is path-traced by tests/oracle once and kept in build/hard_cases, which may be deleted. Exit status 0: all are right; 1: not all;
77: there is no oracle. --quick: a few that take a second each, at draft. HEMIBAKE names the command.
"""

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import truth  # noqa: E402
from scenes import CASES  # noqa: E402
from shapes import gltf_file  # noqa: E402
from turned import TURNS, UPRIGHT, root_at_origin, under  # noqa: E402

HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(truth.ROOT, "build/release/bin/hemibake"))
ROADS = {"columns": "hybrid", "rows": "rows"}

# Relative error by eq. 12 of [Baum89], of the whole and of each node by itself; what is promised of the qualities, and of a node three
# times as much, since a node may be all penumbra.
MOST = {"draft": 0.10, "medium": 0.06, "high": 0.03}
NODE_MOST = {quality: 3 * most for quality, most in MOST.items()}

# The estimate, either way; judged where the error is above so many times the noise of the truth.
FACTOR, ABOVE_NOISE = 2.0, 2.0

# Of what is emitted, or arrives: what the books may be off by. Columns shoot what there is; rows gather by rays, and their books
# close as well as these do, which is what the estimate says.
BOOKS = 1e-6

# What the oracle finds black may have so much of the mean, all of it taken together.
DARK = 1e-3

# How far a scaled, rotated or shifted bake may be from the one as it is, relative, at draft: twice what is promised of draft.
TURNED = 0.10

# A node is judged by itself from so many probes on.
NODE_PROBES = 20

PATIENCE_S = 900
QUICK = ("lamp_in_the_plane_of_its_ceiling", "lamp_touches_ceiling", "partition_1mm_seals_dark_room", "gap_10cm_beside_wall", "nested_glass",
         "sphere_through_a_box")


class Bake:
    """What one bake says at the probes; wrong holds what is plainly wrong with it."""

    def __init__(self, data, options, folder, road, quality):
        self.wrong, self.values, self.road = [], {}, road
        self.is_judged, self.is_doubtful = True, False  # its estimate
        scene, self.out, report = (os.path.join(folder, n) for n in ("scene.glb", "out.glb", "out.json"))
        for path in (self.out, report):
            if os.path.exists(path):
                os.remove(path)
        with open(scene, "wb") as f:
            f.write(data)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            ran = subprocess.run([HEMIBAKE, "bake", scene, "-o", self.out, "--quality", quality, "--method", ROADS[road], "--scene-linear",
                                  "--no-draco", "--quiet", "--report", report, *options], capture_output=True, text=True, timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            ran = subprocess.CompletedProcess([], -1, "", f"not done in {PATIENCE_S} s")
        now = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.seconds = now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime
        self.report = None
        if ran.returncode != 0:
            self.wrong.append(f"ended with {ran.returncode}: {ran.stderr.strip().splitlines()[-1:]}")
            return
        with open(report, encoding="utf-8") as f:
            self.report = json.load(f)
        self.check_books()
        self.check_finite()

    def check_books(self):
        may = BOOKS if self.road == "columns" else self.report["error"]["estimate"]
        if not self.report["energy"]["residual_fraction"] <= may:
            self.wrong.append(f"the books are off by {self.report['energy']['residual_fraction']:.2g}")

    def check_finite(self):
        asset = gltf_file.Asset(self.out)
        for mesh in asset.json["meshes"]:
            for primitive in mesh["primitives"]:
                accessor = primitive["attributes"].get("_RADIOSITY")
                if accessor is not None and not all(math.isfinite(x) and x >= 0 for v in asset.values(accessor) for x in v):
                    self.wrong.append(f"{mesh.get('name')} has a radiance that is not finite, or negative")

    def ask(self, probes, folder, turn=None):
        """The radiance at each probe, by the number of the probe; those of a turned scene lie where it took them."""
        at = [turn.point(p.position) if turn else p.position for p in probes]
        placed = [truth.Probe(p.node, [truth.single(x) for x in q], turn.normal(p.normal) if turn else p.normal) for p, q in zip(probes, at)]
        for p, q in zip(placed, probes):
            p.truth, p.noise = q.truth, q.noise
        path = os.path.join(folder, "asked.hprb")
        truth.write(path, placed)
        ran = subprocess.run([HEMIBAKE, "compare", self.out, path, "--json", "--worst", "1000"], capture_output=True, text=True, timeout=PATIENCE_S)
        if ran.returncode != 0:
            self.wrong.append(f"cannot be compared: {ran.stderr.strip()[-100:]}")
            return
        number = {tuple(p.position): i for i, p in enumerate(placed)}
        for one in json.loads(ran.stdout)["worst"]:
            self.values[number[tuple(truth.single(x) for x in one["position"])]] = one["baked"]
        if len(self.values) < len(number):
            self.wrong.append(f"{len(number) - len(self.values)} probes lie on no triangle of the bake")


class Figures:
    """Error, its noise taken out, and bias of some probes."""

    def __init__(self, probes, values, chosen):
        rows = [(probes[i], values[i]) for i in chosen if i in values]
        self.count = len(rows)
        self.power = sum(p.weight * x * x for p, _ in rows for x in p.truth)
        off = sum(p.weight * (x - y) ** 2 for p, v in rows for x, y in zip(p.truth, v))
        noise = 3 * sum(p.weight * p.noise ** 2 for p, _ in rows)
        total = sum(p.weight * x for p, _ in rows for x in p.truth)
        self.raw = math.sqrt(off / self.power) if self.power else (math.inf if off > 0 else 0.0)
        self.noise = math.sqrt(noise / self.power) if self.power else 0.0
        self.error = math.sqrt(max(0.0, off - noise) / self.power) if self.power else self.raw
        self.bias = (sum(p.weight * sum(v) for p, v in rows) - total) / total if total else 0.0
        # Below that the truth cannot tell: squares of noise have a noise of their own.
        self.blur = self.noise * (8 / max(1, self.count)) ** 0.25


def dark_share(probes, values):
    """Mean of the bake where the oracle finds nothing, of the mean of all; None: there is no such place."""
    dark = [(p.weight, sum(values[i])) for i, p in enumerate(probes) if i in values and not any(p.truth)]
    area = sum(p.weight for p in probes)
    mean = sum(p.weight * sum(p.truth) for p in probes) / area
    return sum(w * x for w, x in dark) / sum(w for w, _ in dark) / mean if len(dark) >= 5 and mean > 0 else None


def worst_node(probes, values):
    """(figures, name) of the node that is worst by itself, of those that the oracle knows well enough."""
    nodes = {}
    for i, p in enumerate(probes):
        nodes.setdefault(p.node, []).append(i)
    found = []
    for name, chosen in nodes.items():
        figures = Figures(probes, values, chosen)
        if figures.count >= NODE_PROBES and figures.power > 0:
            found.append((figures.error - figures.blur, name, figures))
    return max(found)[1:] if found else ("-", None)


def judge(scene, probes, bake, quality):
    """(figures, dark, node, node's figures), and what is wrong."""
    all_of = Figures(probes, bake.values, range(len(probes)))
    dark, (node, by_node) = dark_share(probes, bake.values), worst_node(probes, bake.values)
    estimate = bake.report["error"]["estimate"]
    if all_of.error > MOST[quality] + all_of.blur:
        bake.wrong.append(f"off by {all_of.error:.2%}")
    if by_node and by_node.error > NODE_MOST[quality] + by_node.blur:
        bake.wrong.append(f"{node} by {by_node.error:.0%} (bias {by_node.bias:+.0%})")
    low, high = max(0.0, all_of.error - all_of.blur), all_of.error + all_of.blur
    bake.is_judged = all_of.error > ABOVE_NOISE * all_of.noise
    # Not known to be wrong, but more than the truth could hide.
    bake.is_doubtful = not bake.is_judged and estimate > FACTOR * ABOVE_NOISE * all_of.noise
    if bake.is_judged and not (low / FACTOR <= estimate <= high * FACTOR):
        bake.wrong.append(f"estimate {estimate:.2%}, {'below' if estimate < low else 'above'} by {max(low / max(estimate, 1e-9), estimate / max(high, 1e-9)):.1f}")
    if dark is not None and dark > DARK:
        bake.wrong.append(f"dark places have {dark:.2%} of the mean")
    return all_of, dark, node, by_node


def turns_of(scene):
    return [UPRIGHT if t.name == "rotated" and scene.options and scene.options[0] == "--sun" else t for t in TURNS]


def difference(a, b, probes):
    both = [i for i in a if i in b]
    power = sum(x * x for i in both for x in a[i])
    return math.sqrt(sum((x - y) ** 2 for i in both for x, y in zip(a[i], b[i])) / power) if power else 0.0


def turned(scene, probes, folder, road):
    """How far off the same scene is when scaled, rotated, shifted, at draft; the largest, and what is wrong."""
    def one(turn):
        matrix = turn.matrix() if turn else [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
        bake = Bake(under(scene, matrix), turn.options(scene.options) if turn else scene.options, folder, road, "draft")
        if bake.report:
            bake.ask(probes, folder, turn)
        return bake
    plain, worst, wrong = one(None), 0.0, []
    if any("node" in s for s in plain.wrong):
        return worst, plain.wrong
    for turn in turns_of(scene):
        bake = one(turn)
        off = difference(plain.values, bake.values, probes)
        worst = max(worst, off)
        wrong += [f"{turn.name}: {w}" for w in bake.wrong] + ([f"{turn.name}: differs by {off:.1%}"] if off > TURNED else [])
    return worst, wrong


def ask(name, road, asked, folder):
    """Prints a row; the bake, whose list of what is wrong is empty if it is right."""
    scene = CASES[name]()
    probes = truth.tell(scene, truth.place_probes(scene), folder)
    away = scene.away and [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *scene.away, 1]
    bake = Bake(under(scene, away) if away else scene.glb(), scene.options, folder, road, asked.quality)
    row = f"{name:36s} {road:8s}"
    if bake.report:
        if away:
            with open(bake.out, "rb") as f:
                data = root_at_origin(f.read())
            with open(bake.out, "wb") as f:
                f.write(data)
        bake.ask(probes, folder)
        whole, dark, node, by_node = judge(scene, probes, bake, asked.quality)
        row += (f" {whole.error:7.2%} {whole.noise:6.2%} {whole.bias:+7.2%} {bake.report['error']['estimate']:8.2%} "
                f"{node[:10]:10s} {by_node.error if by_node else 0:7.1%} {'-' if dark is None else f'{dark:.1e}':>8s} "
                f"{bake.report['scene']['elements']:8d} {bake.seconds:7.1f}")
    else:
        row += " " * 70
    if asked.turns and not away:
        off, wrong = turned(scene, probes, folder, road)
        row += f" {off:7.2%}"
        bake.wrong += wrong
    unjudged = "" if bake.is_judged else " (estimate above what the truth hides)" if bake.is_doubtful else " (estimate not judged)"
    print(row, ("right" if not bake.wrong else "WRONG: " + "; ".join(bake.wrong)) + unjudged, flush=True)
    return bake


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--quality", choices=tuple(MOST), default="high")
    parser.add_argument("--road", choices=(*ROADS, "both"), default="both")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--no-turns", dest="turns", action="store_false")
    parser.add_argument("names", nargs="*")
    asked = parser.parse_intermixed_args()
    unknown = sorted(set(asked.names) - set(CASES))
    if unknown:
        parser.error(f"no case {', '.join(unknown)}; there are {', '.join(CASES)}")
    if asked.quick:
        asked.names, asked.quality = asked.names or list(QUICK), "draft"
    return asked


def main():
    asked = arguments()
    if not os.access(truth.ORACLE, os.X_OK):
        print("skipped: there is no oracle (tests/oracle wants libembree-dev)")
        return 77
    names = asked.names or list(CASES)
    roads = list(ROADS) if asked.road == "both" else [asked.road]
    print(f"{'case at ' + asked.quality:36s} {'road':8s} {'error':>7s} {'noise':>6s} {'bias':>7s} {'estimate':>8s} {'worst node':10s} {'error':>7s} "
          f"{'dark':>8s} {'elements':>8s} {'cpu s':>7s}" + (f" {'turned':>7s}" if asked.turns else ""))
    bakes = {}
    for name in names:
        with tempfile.TemporaryDirectory(prefix="hemibake hard ") as folder:
            bakes[name] = [ask(name, road, asked, folder) for road in roads]
    for k, road in enumerate(roads):
        of_road = [b[k] for b in bakes.values()]
        print(f"{sum(not b.wrong for b in of_road)} of {len(of_road)} right by {road}; the estimate of {sum(not b.is_judged for b in of_road)} "
              f"is not judged, since the error is within twice the noise of the truth, and of {sum(b.is_doubtful for b in of_road)} of these "
              "it is more than twice that")
    right = sum(not any(b.wrong for b in by_road) for by_road in bakes.values())
    print(f"{right} of {len(bakes)} right on {'both roads' if len(roads) == 2 else 'its road'}")
    return 0 if right == len(bakes) else 1


if __name__ == "__main__":
    sys.exit(main())
