# SPDX-License-Identifier: MIT
"""How much faster than a path tracer at the same error? Bakes every shared scene by turns with hemibake, with the path tracer of
tests/oracle in two ways, and with Cycles where Blender is.

    python3 tests/bench/peers/peers.py [--grid full|short|tiny] [--scenes a,b] [--runs 3] [--limit 60] [--no-cycles]

    vertices   paths from the vertices of a uniform tessellation, interpolated as a viewer does; the best of several edges
    fitted     paths spread over the triangles of our own output (given to it, not counted) or of such a tessellation, fitted by
               least squares; the best of several meshes and smoothnesses
    cycles     Cycles bakes to vertices, the best of several densities; not where materials are double-sided

Seconds: of hemibake the whole process, writing included; of vertices and fitted reading, building, tracing and fitting; of
Cycles the bake alone. Error at the probes [Baum89, eq. 12]. Prints tables, writes points.csv, crossings.csv and an SVG a scene.
"""

import argparse
import csv
import json
import math
import os
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import time

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(FOLDER))
from error_chart import chart  # noqa: E402
from error_curve import MONTE_CARLO_SLOPE, Crossing, Point, envelope, falling_exponent, time_at  # noqa: E402
from speed_error import by_turns, machine, shown  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(FOLDER)))
TARGETS = (0.05, 0.03, 0.02, 0.01)
PEERS = ("vertices", "fitted", "cycles")
FURTHEST = 10  # times the slowest bake of a peer: where extrapolating ends

SKY = ("--environment", "1,1,1")
# Name: the file's name, what gives light beside the file's own emitters. Those that have no probes get them made, see made_truth.
SCENES = {
    "pillar-room": ("pillar-room", ()), "cornell-box": ("cornell-box", ()), "slot": ("slot", ()), "office": ("office", ()),
    "living-room-lamps": ("living-room-lamps", ()), "living-room": ("living-room", SKY), "bedroom": ("bedroom", SKY),
    "living-room-sun": ("living-room", (*SKY, "--sun", "150,40,20")),
    "garage": ("garage", SKY), "zdm2": ("zdm2", SKY), "apartment": ("apartment", SKY),
}
MADE = {"living-room-sun": "living-room"}  # whose probes' places are taken

GRIDS = {  # options of hemibake; vertices of a tessellation; meshes to fit; (vertices, samples) of Cycles
    "tiny": (("--quality draft",), (3000,), ("--quality draft", 3000), ()),
    "short": (("--error 5%", "--quality draft", "--quality medium", "--time 2", "--time 5"), (4000, 16000, 60000),
              ("--quality draft", 16000), ((8000, 64),)),
    "full": (("--error 5%", "--error 3%", "--error 2%", "--quality draft", "--quality medium", "--time 1", "--time 2", "--time 5", "--time 10",
              "--time 20"), (2000, 8000, 30000, 120000), ("--quality draft", "--quality medium", 8000, 30000),
             ((8000, 16), (8000, 64), (8000, 256), (30000, 64))),
}


class Bench:
    def __init__(self, arguments, folder):
        self.a, self.folder, self.meshes = arguments, folder, {}

    def find(self, name):
        for folder in (os.path.join(self.a.shared, "scenes"), os.path.join(self.a.shared, "truth"),
                       os.path.join(ROOT, "tests", "accuracy", "truth")):
            if os.path.exists(os.path.join(folder, name)):
                return os.path.join(folder, name)
        return None

    def open(self, scene):
        """Finds the files of a scene; why it cannot be measured, or None."""
        name, self.light = SCENES[scene]
        self.scene, self.asset = scene, self.find(f"{name}.glb")
        self.probes = self.find(f"{MADE.get(scene, scene)}.hprb")
        if not self.asset or not self.probes:
            return f"{name}.glb or its probes are not in {self.a.shared}"
        if scene in MADE:
            self.probes = self.made_truth()
        self.area = float(self.output(self.a.path_bake, "area", self.asset))
        self.meshes.clear()
        return None

    def made_truth(self):
        """Probes for a light that no file has a truth of: the oracle's own, at the places of another's."""
        made = os.path.join(self.folder, f"{self.scene}.hprb")
        last = self.output(self.a.pathtrace, self.asset, self.probes, *self.light, "--seconds", str(self.a.truth_seconds), "--limit",
                           "2000", "--seed", "77", "-o", made).splitlines()[-1]
        print(f"  {self.scene}: truth made with {last.split()[0]} paths a probe", flush=True)
        return made

    def output(self, *command):
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout

    def judge(self, baked):
        return json.loads(self.output(self.a.hemibake, "compare", baked, self.probes, "--json"))

    # Each gives a list of (label, seconds, error).

    def hemibake(self, options):
        baked = os.path.join(self.folder, f"{self.scene}{options.replace(' ', '')}.glb")
        command = [self.a.hemibake, "bake", self.asset, "-o", baked, "--scene-linear", "--no-draco", "--quiet", "--threads",
                   str(self.a.threads), *self.light, *options.split()]
        begin = time.perf_counter()
        try:
            status = subprocess.run(command, timeout=self.a.limit).returncode
        except subprocess.TimeoutExpired:
            print(f"  hemibake {options} on {self.scene}: not done in {self.a.limit} s", flush=True)
            return []
        seconds = time.perf_counter() - begin
        if status not in (0, 4):  # 4: stopped by --time
            print(f"  hemibake {options} on {self.scene}: ended with {status}", flush=True)
            return []
        self.meshes[options] = baked
        return [(f"hemibake {options}", seconds, self.judge(baked)["error"])]

    def rungs(self, label, *arguments):
        text = self.output(self.a.path_bake, *arguments, *self.light, "--threads", str(self.a.threads), "--seconds",
                           str(self.a.peer_seconds))
        found = []
        for line in map(json.loads, text.splitlines()):
            smooth = f", smoothness {line['smoothness']:g}" if line["smoothness"] else ""
            found.append((f"{label}, {line['vertices']} x {line['samples']}{smooth}", line["seconds"], line["error"]))
        return found

    def tessellated(self, way, count):
        # A right triangle of legs h has one vertex per h^2; its longest edge, halved until none is longer, is at most 1.8 h.
        edge = 1.8 * math.sqrt(self.area / count)
        return self.rungs(f"{way}, edge {edge:.3g} m", way, self.asset, self.probes, "--edge", f"{edge:.6g}")

    def fitted(self, mesh):
        """To one of our own outputs, or to a tessellation of about so many vertices."""
        if isinstance(mesh, int):
            return self.tessellated("fitted", mesh)
        if mesh not in self.meshes:
            return []
        return self.rungs(f"fitted to {mesh.split()[-1]}", "fitted", self.asset, self.probes, self.meshes[mesh])

    def cycles(self, vertices, samples):
        baked, facts = os.path.join(self.folder, "cycles.glb"), os.path.join(self.folder, "cycles.json")
        command = ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-t", str(self.a.threads), "-P",
                   os.path.join(os.path.dirname(FOLDER), "cycles_bake.py"), "--", self.asset, baked, facts, str(vertices),
                   str(samples), str(self.a.threads), *self.light[1:2]]
        path = os.path.dirname(os.path.realpath(shutil.which("blender"))) + os.pathsep + os.environ["PATH"]  # as speed_error.py
        try:
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                  env=dict(os.environ, PATH=path), timeout=3 * self.a.limit)
        except subprocess.TimeoutExpired:
            print(f"  cycles {vertices} x {samples} on {self.scene}: not done in {3 * self.a.limit} s", flush=True)
            return []
        if done.returncode:
            print(f"  cycles on {self.scene}: Blender failed: {done.stdout.strip().splitlines()[-1]}", flush=True)
            return []
        with open(facts, encoding="utf-8") as f:
            found = json.load(f)
        return [(f"cycles, {found['vertices']} x {samples}", found["seconds"], self.judge(baked)["error"])]

    def why_not_cycles(self):
        if self.a.no_cycles:
            return "not asked for"
        if not shutil.which("blender"):
            return "there is no Blender"
        if "--sun" in self.light:
            return "its bake knows no sun"
        with open(self.asset, "rb") as f:
            content = f.read()
        length = struct.unpack_from("<I", content, 12)[0]
        materials = json.loads(content[20:20 + length]).get("materials", [])
        return "materials are double-sided" if any(m.get("doubleSided") for m in materials) else None

    def measure(self, grid):
        """Points of all, by turns: a busy or throttled machine then slows all. Median seconds of the runs."""
        ours, counts, meshes, cycles = GRIDS[grid]
        reason = self.why_not_cycles()
        if reason and cycles:
            print(f"  cycles on {self.scene}: skipped: {reason}", flush=True)
        tasks = by_turns([lambda o=o: self.hemibake(o) for o in ours], [lambda n=n: self.tessellated("vertices", n) for n in counts])
        tasks += [lambda m=m: self.fitted(m) for m in meshes]
        theirs = [] if reason else [lambda v=v, s=s: self.cycles(v, s) for v, s in cycles]
        found, late = {}, set()
        for turn in range(self.a.runs):
            for number, task in enumerate(tasks + (theirs if turn < self.a.cycles_runs else [])):
                points = [] if number in late else task()
                late.update([number] if not points else [])  # no second try at what is not done in time
                for label, seconds, error in points:
                    found.setdefault(label, []).append((seconds, error))
        return [Point(statistics.median(s for s, _ in points), points[0][1], label) for label, points in found.items()]


def crossings(tools, target):
    """When each gets there; a peer past its slowest bake by the slope of its envelope, at best 1/2, and ten times as long at most."""
    row = {}
    for tool, _, edge in tools:
        peer = tool != "hemibake"
        slope = min(falling_exponent(edge), MONTE_CARLO_SLOPE) if peer and len(edge) >= 3 else None
        found, most = time_at(edge, target, slope), FURTHEST * edge[-1].seconds
        row[tool] = Crossing(most, "beyond") if peer and (found is None or found.seconds > most) else found
    return row


def time_shown(crossing):
    return f"> {crossing.seconds:.0f}" if crossing and crossing.kind == "beyond" else shown(crossing)


def times_slower(ours, theirs):
    """How many times as long a peer takes: a bound where either is one."""
    if theirs is None:
        return "-"
    if ours is None:
        return "-" if theirs.kind == "beyond" else "lost"
    least, most = theirs.kind == "beyond" or ours.kind == "at most", theirs.kind == "at most"
    if least and most:
        return "-"
    sign = ("~ " if theirs.kind == "extrapolated" else "") + (">= " if least else "<= " if most else "")
    times = theirs.seconds / ours.seconds
    return f"{sign}{times:.0f}" if times >= 10 else f"{sign}{times:.2g}"


HEADER = ("scene", "error", "hemibake, s", *(f"{p}, s" for p in PEERS), *(f"{p} / hemibake" for p in PEERS))


def table_rows(scene, tools):
    rows = []
    for target in TARGETS:
        row = crossings(tools, target)
        ours = row.get("hemibake")
        cells = [time_shown(row[p]) if p in row else "-" for p in PEERS]
        rows.append((scene, f"{target:.0%}", time_shown(ours), *cells, *(times_slower(ours, row.get(p)) for p in PEERS)))
    return rows


def best_rows(scene, tools):
    """The least error of each, and the first that is nearly as good."""
    return [(scene, tool, f"{edge[-1].error:.2%}", f"{edge[-1].seconds:.2f}", edge[-1].label) for tool, _, edge in tools]


def markdown(header, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, ("---",) * len(header), *rows])


LEGEND = ("~ extrapolated past the slowest bake of a peer by the slope of its envelope, at best 1/2, and > where that takes more than ten "
          "times as long; <= and >= where the fastest bake is already better; lost: a peer gets there and hemibake did not.")


def write_points(out, scene, tools):
    with open(os.path.join(out, "points.csv"), "a", newline="", encoding="utf-8") as f:
        for tool, points, edge in tools:
            csv.writer(f).writerows((scene, tool, p.label, f"{p.seconds:.4f}", f"{p.error:.6f}", int(p in edge)) for p in points)


def run(a, folder):
    bench, rows, best, begin = Bench(a, folder), [], [], time.perf_counter()
    os.makedirs(a.out, exist_ok=True)
    print(machine(), flush=True)
    with open(os.path.join(a.out, "points.csv"), "w", encoding="utf-8") as f:
        f.write("scene,tool,point,seconds,error,on_envelope\n")
    for scene in a.scenes.split(",") if a.scenes else SCENES:
        reason = bench.open(scene)
        if reason:
            print(f"  {scene}: skipped: {reason}", flush=True)
            continue
        points = bench.measure(a.grid)
        tools = [(tool, mine, envelope(mine)) for tool in ("hemibake", *PEERS)
                 for mine in [[p for p in points if p.label.startswith(tool)]] if mine]
        write_points(a.out, scene, tools)
        rows += table_rows(scene, tools)
        best += best_rows(scene, tools)
        print(f"  {scene}: {len(points)} points, {time.perf_counter() - begin:.0f} s so far", flush=True)
        with open(os.path.join(a.out, f"{scene}.svg"), "w", encoding="utf-8") as f:
            f.write(chart(f"{scene}, {a.threads} threads", tools))
    print("\n" + markdown(HEADER, rows) + "\n\n" + LEGEND + "\n")
    print(markdown(("scene", "tool", "least error", "s", "bake"), best))
    with open(os.path.join(a.out, "crossings.csv"), "w", newline="", encoding="utf-8") as f:
        csv.writer(f).writerows([HEADER, *rows])
    print(f"\n{a.grid} grid, {a.runs} runs, {time.perf_counter() - begin:.0f} s in all; {a.out}/*.svg, points.csv, crossings.csv")
    return 0 if rows else 77


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--grid", choices=GRIDS, default="full")
    parser.add_argument("--scenes", help="some of " + ",".join(SCENES))
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"))
    parser.add_argument("--hemibake", help="another command than the build's")
    parser.add_argument("--shared", default=os.path.join(os.path.dirname(ROOT), "shared"))
    parser.add_argument("--out", default=os.path.join(ROOT, "build", "bench", "peers"))
    parser.add_argument("--runs", type=int, default=3, help="of each point; the median counts")
    parser.add_argument("--cycles-runs", type=int, default=1)
    parser.add_argument("--limit", type=float, default=60, help="seconds of a bake of hemibake; three times that of Cycles")
    parser.add_argument("--peer-seconds", type=float, default=20, help="of each ladder of paths")
    parser.add_argument("--truth-seconds", type=float, default=60, help="for a truth that has to be made")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--no-cycles", action="store_true")
    a = parser.parse_args()
    a.path_bake = os.path.join(a.build, "tests", "bench", "path_bake")
    a.pathtrace = os.path.join(a.build, "tests", "oracle", "pathtrace")
    a.hemibake = a.hemibake or os.path.join(a.build, "bin", "hemibake")
    if not os.path.exists(a.path_bake):
        print("skipped: there is no path_bake, since Embree 3 (libembree-dev) was not found, or the tests are not built")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        return run(a, folder)


if __name__ == "__main__":
    sys.exit(main())
