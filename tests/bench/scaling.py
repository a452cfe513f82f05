# SPDX-License-Identifier: MIT
"""How do time and memory grow with elements, input triangles, tessellation, patches, lamps and threads? One of them at a time, the rest fixed.

    python3 tests/bench/scaling.py [--grid full|short|tiny] [--only SERIES ...]      (scaling.sh builds first)

Scenes are those of small_room.py, grown: a room with a box, its floor waved and cut finely (triangles), all of its faces cut into
squares and these into triangles, which show the same (tessellation), its lamp cut into many that stand apart (lamps). Seconds are of the whole process, memory its peak; both in CSV too. The exponent is the least-squares
slope of logarithms, of memory above what a bake of a handful of elements takes. A bake past the limit is said and ends a series.
"""

import argparse
import collections
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import threading
import time

import numpy

from error_curve import exponent
from radiance_glb import write_scene
from small_room import MATERIALS, box, joined, quad, small_room
from speed_error import machine

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
Row = collections.namedtuple("Row", "x seconds cpu_s peak elements patches hemicubes error solve_s")

# How many of each, by grid. Elements and patches are asked for by their size, so what there is differs from what is wanted.
GRIDS = {
    "tiny": {"elements": (1e4, 2e4), "triangles": (1e3, 2e3), "tessellation": (1e3, 3e3), "patches": (100, 200), "lamps": (1, 4), "threads": (1, 2)},
    "short": {"elements": (1e4, 3e4, 1e5), "triangles": (1e3, 1e4, 3e4), "tessellation": (1e4, 1e5),
              "patches": (100, 300, 1000), "lamps": (1, 4, 16), "threads": (1, 2)},
    "full": {"elements": (1e4, 3e4, 1e5, 3e5, 1e6), "triangles": (1e3, 1e4, 1e5, 1e6),
             "tessellation": (1e4, 1e5, 1e6), "patches": (100, 300, 1000, 3000), "lamps": (1, 3, 10, 30, 100), "threads": (1, 2)},
}

ROOM_AREA = 2 * (4 * 3 + 4 * 3 + 3 * 3) + 5.4  # of small_room.py, with its box and lamp


def waved_floor_room(path, triangles):
    """The small room on a floor of so many triangles, which waves enough that none are one plane."""
    side = max(2, round(math.sqrt(triangles / 2)))
    x, z = numpy.meshgrid(numpy.linspace(0, 4, side + 1), numpy.linspace(0, 3, side + 1))
    floor = numpy.stack([x, 0.05 + 0.05 * numpy.sin(7 * x) * numpy.cos(5 * z), z], axis=2).reshape(-1, 3)
    corner = (numpy.arange(side)[:, None] * (side + 1) + numpy.arange(side)).reshape(-1)
    a, b, c, d = corner, corner + side + 1, corner + side + 2, corner + 1
    faces = numpy.concatenate([numpy.stack([a, b, c], axis=1), numpy.stack([a, c, d], axis=1)])
    walls = [quad((0, 3, 0), (4, 0, 0), (0, 0, 3)), quad((0, 0, 0), (4, 0, 0), (0, 3, 0)), quad((4, 0, 0), (0, 0, 3), (0, 3, 0)),
             quad((4, 0, 3), (-4, 0, 0), (0, 3, 0)), quad((0, 0, 3), (0, 0, -3), (0, 3, 0))]
    lamp = quad((1.5, 2.95, 1), (1, 0, 0), (0, 0, 1))
    write_scene(path, [(floor, faces, 1), joined(walls, 0), joined([lamp], 2)], MATERIALS)


def grid_of(face, edge):
    """A face cut into squares of about that edge, and these into triangles: corners and triangles."""
    right, up = face[1] - face[0], face[3] - face[0]
    across, along = (max(1, round(numpy.linalg.norm(v) / edge)) for v in (right, up))
    u, v = numpy.meshgrid(numpy.linspace(0, 1, across + 1), numpy.linspace(0, 1, along + 1))
    corners = face[0] + u.reshape(-1, 1) * right + v.reshape(-1, 1) * up
    a = (numpy.arange(along)[:, None] * (across + 1) + numpy.arange(across)).reshape(-1)
    b, c, d = a + 1, a + across + 2, a + across + 1
    return corners, numpy.concatenate([numpy.stack([a, b, c], axis=1), numpy.stack([a, c, d], axis=1)])


def tessellated_room(path, triangles):
    """The small room, of so many triangles."""
    edge = math.sqrt(2 * ROOM_AREA / triangles)
    crate = [face for face in box((1, 0, 1), (1, 1.2, 0.8), False) if any(corner[1] > 0 for corner in face)]
    parts = [(*grid_of(face, edge), material) for faces, material in ((box((0, 0, 0), (4, 3, 3), True), 0), (crate, 1)) for face in faces]
    write_scene(path, parts + [joined([quad((1.5, 2.95, 1), (1, 0, 0), (0, 0, 1))], 2)], MATERIALS)


def lamps_room(path, count):
    """The room under so many lamps, which have 1 m2 together."""
    walls = [quad((0, 0, 0), (0, 0, 3), (4, 0, 0)), quad((0, 3, 0), (4, 0, 0), (0, 0, 3)), quad((0, 0, 0), (4, 0, 0), (0, 3, 0)),
             quad((4, 0, 0), (0, 0, 3), (0, 3, 0)), quad((4, 0, 3), (-4, 0, 0), (0, 3, 0)), quad((0, 0, 3), (0, 0, -3), (0, 3, 0))]
    columns = math.ceil(math.sqrt(count))
    rows, edge = math.ceil(count / columns), math.sqrt(1 / count)
    lamps = [quad((4 * (i % columns + 0.5) / columns - edge / 2, 2.95, 3 * (i // columns + 0.5) / rows - edge / 2), (edge, 0, 0),
                  (0, 0, edge)) for i in range(count)]
    write_scene(path, [joined(walls, 0), joined(lamps, 2)], MATERIALS)


class Bench:
    def __init__(self, arguments, folder):
        self.a, self.folder = arguments, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def bake(self, x, scene, *options):
        """One bake as a row; None past the limit."""
        command = [self.a.hemibake, "bake", scene, "-o", self.path("out.glb"), "--report", self.path("report.json"), "--quiet",
                   "--no-draco", *(str(o) for o in options)]
        if "--threads" not in options:
            command += ["--threads", str(self.a.threads)]
        begin = time.perf_counter()
        process = subprocess.Popen(command)
        killer = threading.Timer(self.a.limit, process.kill)
        killer.start()
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - begin
        killer.cancel()
        process.returncode = status
        if os.WIFSIGNALED(status):
            print(f"  {x:g}: more than {self.a.limit:g} s, stopped", flush=True)
            return None
        if os.WEXITSTATUS(status) not in (0, 4):
            sys.exit(f"scaling: exit status {os.WEXITSTATUS(status)} of {' '.join(command)}")
        with open(self.path("report.json"), encoding="utf-8") as f:
            r = json.load(f)
        return Row(x, seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, r["scene"]["elements"],
                   r["scene"]["patches"], r["solver"]["hemicubes"], r["error"]["estimate"],
                   r["time"]["factors_s"] + r["time"]["solve_s"])

    def elements(self, wanted):
        return self.bake(wanted, self.path("room.glb"), "--patch-size", 0.6, "--element-size", math.sqrt(ROOM_AREA / wanted))

    def triangles(self, wanted):
        waved_floor_room(self.path("waves.glb"), wanted)
        return self.bake(wanted, self.path("waves.glb"), "--quality", "draft")

    def tessellation(self, wanted):
        tessellated_room(self.path("fine.glb"), wanted)
        return self.bake(wanted, self.path("fine.glb"), "--quality", "draft")

    def patches(self, wanted):
        return self.bake(wanted, self.path("room.glb"), "--element-size", 0.04, "--patch-size", math.sqrt(ROOM_AREA / wanted))

    def lamps(self, wanted):
        lamps_room(self.path("lamps.glb"), int(wanted))
        return self.bake(wanted, self.path("lamps.glb"))

    def threads(self, wanted):
        edge = 0.06 if self.a.grid == "tiny" else 0.03
        return self.bake(wanted, self.path("room.glb"), "--element-size", edge, "--threads", int(wanted))

    # What a series grows in: the number that the bake really had, by which exponents are fitted.
    grows = {"elements": lambda r: r.elements, "patches": lambda r: r.patches, "triangles": lambda r: r.x,
             "tessellation": lambda r: r.x, "lamps": lambda r: r.x, "threads": lambda r: r.x}

    def series(self, name, values, base):
        print(f"\n{name}\n  {'wanted':>9} {'elements':>9} {'patches':>8} {'hemi-cubes':>10} {'estimate':>9} {'seconds':>8} {'cpu s':>8} "
              f"{'MiB':>7} {'bytes an element':>17}")
        rows = []
        for value in values:
            row = getattr(self, name)(value)
            if row is None:
                break
            rows.append(row)
            print(f"  {row.x:9.0f} {row.elements:9} {row.patches:8} {row.hemicubes:10} {row.error:9.2%} {row.seconds:8.2f} "
                  f"{row.cpu_s:8.2f} {row.peak / 2**20:7.0f} {(row.peak - base) / row.elements:17.0f}", flush=True)
        if name == "threads" and len(rows) > 1:
            print(f"  solving alone: {rows[0].solve_s / rows[-1].solve_s:.2f} times as fast with {rows[-1].x:.0f} threads")
        elif name == "tessellation" and len(rows) > 1:
            decades = math.log10(rows[-1].x / rows[0].x)
            print(f"  a decade of triangles: {(rows[-1].seconds / rows[0].seconds) ** (1 / decades):.2f} times the seconds, "
                  f"{(rows[-1].cpu_s / rows[0].cpu_s) ** (1 / decades):.2f} times those of processor")
        elif len(rows) > 1:
            x = [self.grows[name](r) for r in rows]
            print(f"  exponent of seconds {exponent(x, [r.seconds for r in rows]):.2f}, of seconds of processor "
                  f"{exponent(x, [r.cpu_s for r in rows]):.2f}, of memory "
                  f"{exponent(x, [max(r.peak - base, 1) for r in rows]):.2f}")
        return rows


def run(a, folder):
    bench = Bench(a, folder)
    print(machine())
    small_room(bench.path("room.glb"))
    first = bench.bake(0, bench.path("room.glb"), "--element-size", 1, "--patch-size", 2)
    if first is None:
        sys.exit("scaling: a dozen elements take longer than the limit")
    print(f"{first.elements} elements: {first.seconds:.2f} s, {first.peak / 2**20:.0f} MiB, from which memory counts")
    with open(a.csv, "w", newline="", encoding="utf-8") as f:
        writer = csv.writer(f)
        writer.writerow(("series", *Row._fields))
        for name in a.only or GRIDS[a.grid]:
            for row in bench.series(name, GRIDS[a.grid][name], first.peak):
                writer.writerow((name, *row))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--grid", choices=GRIDS, default="full")
    parser.add_argument("--only", nargs="*", choices=list(GRIDS["full"]))
    parser.add_argument("--hemibake", default=os.path.join(ROOT, "build/release/bin/hemibake"))
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=600, help="seconds that a bake may take")
    parser.add_argument("--csv", default=os.path.join(ROOT, "build/scaling.csv"))
    with tempfile.TemporaryDirectory() as folder:
        run(parser.parse_args(), folder)


if __name__ == "__main__":
    main()
