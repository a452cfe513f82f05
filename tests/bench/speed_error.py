# SPDX-License-Identifier: MIT
"""How much faster than Cycles at the same error? Both bake every scene that has probes, by turns, on one machine.

    python3 tests/bench/speed_error.py --grid full --out build/bench/speed_error      (speed_error.sh builds first)

hemibake: seconds of the whole process, start to exit, over its presets and the options between and beyond them. Cycles: seconds
of the bake alone, without Blender's start, import or the cutting of faces, over densities and samples; its lower envelope
counts (cycles_bake.py). One judge for both, `hemibake compare`; probe_error.py judges some of each again, and the run fails
where the two disagree. Prints tables, writes points.csv, ratios.csv, an SVG a scene and index.html.
"""

import argparse
import csv
import html
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from error_chart import chart
from error_curve import MONTE_CARLO_SLOPE, Point, envelope, falling_exponent, time_at
from probe_error import probe_error

FOLDER = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(FOLDER))
TARGETS = (0.05, 0.03, 0.02, 0.015, 0.01)

# Both programs take a probe's triangle by a tolerance of their own, so a probe on an edge may take either neighbour.
JUDGES_AGREE = 0.01

# A bake that would take longer than this is left to the extrapolation.
CYCLES_LIMIT_S = 600
HEMIBAKE_LIMIT_S = 600

# A bake longer than this is not repeated: what disturbs a machine averages out within it.
LONG_S = 60

GRIDS = {
    "tiny": {"hemibake": ("draft", "draft --error 0.05"), "vertices": (3000,), "samples": (4, 16, 64), "scenes": ("cornell-box",)},
    "short": {"hemibake": ("draft", "medium", "--error 0.03", "--error 0.02"), "vertices": (3000, 8000), "samples": (4, 16, 64),
              "scenes": ("pillar-room", "cornell-box")},
    "middle": {"hemibake": ("draft", "medium", "high", "--error 0.05", "--error 0.03", "--error 0.015", "--error 0.01"),
               "vertices": (2000, 8000, 30000), "samples": (4, 16, 64, 256), "scenes": ("pillar-room", "cornell-box")},
    "full": {"hemibake": ("draft", "medium", "high", "reference", "--error 0.05", "--error 0.03", "--error 0.02", "--error 0.015",
                          "--error 0.01"),
             "vertices": (2000, 4000, 8000, 15000, 30000, 60000), "samples": (4, 16, 64, 256, 1024),
             "scenes": ("pillar-room", "cornell-box")},
}


class Bench:
    def __init__(self, arguments, folder):
        self.a, self.folder, self.judged, self.samples_a_second = arguments, folder, [], None

    def probes(self, scene):
        return os.path.join(self.a.truth, f"{scene}.hprb")

    def judge(self, baked, scene):
        text = subprocess.run([self.a.hemibake, "compare", baked, self.probes(scene), "--json"], check=True, timeout=300,
                              stdout=subprocess.PIPE).stdout
        found = json.loads(text)
        if found["unmatched"] or not found["matched"]:
            sys.exit(f"speed_error: {found['unmatched']} probes of {scene} lie on no triangle of {baked}")
        return found["error"]

    def check_judge(self, tool, baked, scene, error):
        """The other program's word on a bake; once a tool and scene."""
        if (tool, scene) in {entry[:2] for entry in self.judged}:
            return
        other, lost = probe_error(baked, self.probes(scene))
        self.judged.append((tool, scene, error, other, lost))
        if lost or abs(other - error) > JUDGES_AGREE * error:
            sys.exit(f"speed_error: hemibake compare says {error:.4%} of {tool} on {scene}, probe_error.py {other:.4%}, "
                     f"{lost} probes lost")

    def hemibake(self, scene, options):
        """One bake: seconds and error; None past the limit."""
        baked = os.path.join(self.folder, "hemibake.glb")
        words = options.split()
        words = words if words[0].startswith("-") else ["--quality", *words]
        command = [self.a.hemibake, "bake", os.path.join(self.a.truth, f"{scene}.glb"), "-o", baked, "--scene-linear", "--no-draco",
                   "--quiet", "--threads", str(self.a.threads), *words]
        begin = time.perf_counter()
        try:
            status = subprocess.run(command, timeout=HEMIBAKE_LIMIT_S).returncode
        except subprocess.TimeoutExpired:
            print(f"  hemibake {options} on {scene}: stopped after {HEMIBAKE_LIMIT_S} s, no point", flush=True)
            return None
        seconds = time.perf_counter() - begin
        if status not in (0, 4):  # 4: the goal of --error was not met, and what came of it is a point all the same
            sys.exit(f"speed_error: hemibake {options} on {scene} ended with {status}")
        error = self.judge(baked, scene)
        self.check_judge("hemibake", baked, scene, error)
        return seconds, error

    def cycles(self, scene, vertices, samples):
        """One bake: seconds and error; None where it would take longer than the limit."""
        predicted = vertices * samples / self.samples_a_second if self.samples_a_second else 0.0
        if predicted > CYCLES_LIMIT_S:
            print(f"  cycles {vertices} vertices x {samples} on {scene}: about {predicted:.0f} s, left out", flush=True)
            return None
        baked, facts = os.path.join(self.folder, "cycles.glb"), os.path.join(self.folder, "cycles.json")
        command = ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-t", str(self.a.threads), "-P",
                   os.path.join(FOLDER, "cycles_bake.py"), "--", os.path.join(self.a.truth, f"{scene}.glb"), baked, facts,
                   str(vertices), str(samples), str(self.a.threads)]
        # Blender's Python takes its modules from where the first python3 on PATH is: from beside Blender, not from an environment.
        path = os.path.dirname(os.path.realpath(shutil.which("blender"))) + os.pathsep + os.environ["PATH"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              env=dict(os.environ, PATH=path), timeout=3 * CYCLES_LIMIT_S)
        if done.returncode:
            sys.exit(f"speed_error: Blender failed:\n{done.stdout[-2000:]}")
        with open(facts, encoding="utf-8") as f:
            found = json.load(f)
        if vertices * samples > 50000:  # smaller ones measure the start
            self.samples_a_second = vertices * samples / found["seconds"]
        error = self.judge(baked, scene)
        self.check_judge("cycles", baked, scene, error)
        return found["seconds"], error

    def measure(self, scene, grid):
        """Points of both, by turns: a busy or throttled machine then slows both. Median seconds of the runs."""
        ours = [(f"hemibake {o}", lambda o=o: self.hemibake(scene, o)) for o in grid["hemibake"]]
        theirs = [(f"cycles {v} vertices x {s}", lambda v=v, s=s: self.cycles(scene, v, s))
                  for s in grid["samples"] for v in grid["vertices"]]
        found = {}
        for run in range(self.a.runs):
            for label, bake in by_turns(ours, theirs if run < self.a.cycles_runs else []):
                if found.get(label, [(0, 0)])[0][0] > LONG_S:
                    continue
                point = bake()
                if point:
                    found.setdefault(label, []).append(point)
                    print(f"  {scene:12} {label:44} {point[0]:9.2f} s {point[1]:8.3%}", flush=True)
        return [Point(statistics.median(s for s, _ in points), points[0][1], label) for label, points in found.items()]


def by_turns(first, second):
    """Both lists as one, each spread evenly."""
    merged = [((k + 0.5) / len(each), task) for each in (first, second) for k, task in enumerate(each)]
    return [task for _, task in sorted(merged, key=lambda entry: entry[0])]


def ratios(ours, theirs):
    """A row each target: error, our crossing, theirs, theirs at the best slope."""
    slope = min(falling_exponent(theirs), MONTE_CARLO_SLOPE) if len(theirs) >= 3 else None
    rows = []
    for target in TARGETS:
        rows.append((target, time_at(ours, target), time_at(theirs, target, slope), time_at(theirs, target, MONTE_CARLO_SLOPE)))
    return slope, rows


def shown(crossing):
    if crossing is None:
        return "not reached"
    return {"measured": "", "at most": "<= ", "extrapolated": "~ "}[crossing.kind] + f"{crossing.seconds:.2f}"


def ratio(ours, theirs):
    """Past the fastest point of an envelope the time is an upper bound: of ours the ratio is then a lower bound."""
    if ours is None or theirs is None:
        return "-"
    if theirs.kind == "at most":
        return f"<= {theirs.seconds / ours.seconds:.1f}" if ours.kind == "measured" else "-"
    sign = ("~ " if theirs.kind == "extrapolated" else "") + (">= " if ours.kind == "at most" else "")
    return f"{sign}{theirs.seconds / ours.seconds:.1f}"


HEADER = ("scene", "error", "hemibake, s", "Cycles, s", "ratio", "Cycles at slope 1/2, s", "ratio at slope 1/2")


def table_rows(scene, rows):
    return [(scene, f"{target:.1%}", shown(o), shown(t), ratio(o, t), shown(h), ratio(o, h)) for target, o, t, h in rows]


def markdown(rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [HEADER, ("---", *["---:"] * (len(HEADER) - 1)), *rows])


def machine():
    def first_line(*command):
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        return done.stdout.strip().splitlines()[0] if done.stdout.strip() else "unknown"
    dirty = " with changes" if first_line("git", "status", "--porcelain", "--untracked-files=no") != "unknown" else ""
    processor = first_line("sed", "-n", "s/^model name[^:]*: //p", "/proc/cpuinfo")
    return (f"commit {first_line('git', 'rev-parse', '--short', 'HEAD')}{dirty}; {first_line('blender', '--version')}; {processor}, "
            f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} at the start")


def write_page(out, title, note, rows, charts):
    cells = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>" for row in rows)
    heads = "".join(f"<th>{html.escape(h)}</th>" for h in HEADER)
    with open(os.path.join(out, "index.html"), "w", encoding="utf-8") as f:
        f.write(f"<!doctype html><meta charset=utf-8><title>{html.escape(title)}</title><style>body{{font:15px sans-serif;margin:2em;"
                "max-width:60em}td,th{padding:.2em .8em;text-align:right;border-bottom:1px solid #ddd}</style>"
                f"<h1>{html.escape(title)}</h1><p>{html.escape(note)}</p><table><tr>{heads}</tr>{cells}</table>"
                f"<p>{html.escape(LEGEND)}</p>{''.join(charts)}\n")


LEGEND = ("~ extrapolated past the slowest Cycles bake by the slope fitted to its envelope, or by 1/2, the best a Monte Carlo method "
          "can do; <= and >= where the fastest bake is already better.")


def write_points(out, scene, tools):
    with open(os.path.join(out, "points.csv"), "a", newline="", encoding="utf-8") as f:
        writer = csv.writer(f)
        for tool, points, edge in tools:
            for p in points:
                writer.writerow((scene, tool, p.label, f"{p.seconds:.4f}", f"{p.error:.6f}", int(p in edge)))


def run(a, folder):
    grid, bench, rows, charts, begin = GRIDS[a.grid], Bench(a, folder), [], [], time.perf_counter()
    os.makedirs(a.out, exist_ok=True)
    note = machine()
    print(note, flush=True)
    with open(os.path.join(a.out, "points.csv"), "w", encoding="utf-8") as f:
        f.write("scene,tool,point,seconds,error,on_envelope\n")
    for scene in grid["scenes"]:
        points = bench.measure(scene, grid)
        tools = [(tool, mine, envelope(mine)) for tool in ("hemibake", "cycles")
                 for mine in [[p for p in points if p.label.startswith(tool)]]]
        write_points(a.out, scene, tools)
        slope, found = ratios(tools[0][2], tools[1][2])
        rows += table_rows(scene, found)
        print(f"  {scene}: the error of Cycles falls as seconds^-{slope:.2f}" if slope else f"  {scene}: too few points for a slope")
        picture = chart(f"{scene}, {a.threads} threads", tools)
        charts.append(picture)
        with open(os.path.join(a.out, f"{scene}.svg"), "w", encoding="utf-8") as f:
            f.write(picture)
    for tool, scene, error, other, _ in bench.judged:
        print(f"judges on {scene}, {tool}: hemibake compare {error:.4%}, probe_error.py {other:.4%}")
    print("\n" + markdown(rows) + "\n\n" + LEGEND)
    with open(os.path.join(a.out, "ratios.csv"), "w", newline="", encoding="utf-8") as f:
        csv.writer(f).writerows([HEADER, *rows])
    write_page(a.out, "Error against seconds: hemibake and Cycles", note, rows, charts)
    print(f"{a.grid} grid, {time.perf_counter() - begin:.0f} s in all; {a.out}/index.html, points.csv, ratios.csv")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--grid", choices=GRIDS, default="full", help="full, middle (a quarter of an hour), short (minutes), tiny (half a minute: does it work?)")
    parser.add_argument("--hemibake", default=os.path.join(ROOT, "build/release/bin/hemibake"))
    parser.add_argument("--truth", default=os.path.join(ROOT, "tests", "accuracy", "truth"))
    parser.add_argument("--out", default=os.path.join(ROOT, "build/bench/speed_error"))
    parser.add_argument("--runs", type=int, default=3, help="bakes of each point of hemibake; the median counts")
    parser.add_argument("--cycles-runs", type=int, default=1)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    with tempfile.TemporaryDirectory() as folder:
        run(parser.parse_args(), folder)


if __name__ == "__main__":
    main()
