# SPDX-License-Identifier: MIT
"""What did one bake of a case say and leave? Its radiance by node and by point, its report, its lines, its picture. Standard library only.

Radiances are those of --scene-linear: the attribute _RADIOSITY, linear Rec.709, unclamped.
"""

import itertools
import json
import math
import os
import resource
import struct
import subprocess
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from gltf_file import Asset, glb  # noqa: E402

# A hang is a failure; what waits for other programs is none. The slowest right cases at high take minutes on two busy cores.
PATIENCE_S = 900

# How far a point may lie off the triangle that is asked for its light.
NEAR_M = 1e-3

IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def matrix(node):
    """Of a node, column-major as in the file."""
    if "matrix" in node:
        return node["matrix"]
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    s, t = node.get("scale", [1, 1, 1]), node.get("translation", [0, 0, 0])
    columns = [[1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
               [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
               [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]]
    return [v * s[k] for k in range(3) for v in columns[k] + [0]][:12] + [*t, 1]


def times(a, b):
    return [sum(a[k * 4 + row] * b[column * 4 + k] for k in range(4)) for column in range(4) for row in range(4)]


def moved(m, p):
    return [m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row] for row in range(3)]


class Triangle:
    """Three corners with a radiance each; twice its area and its normal from the winding."""

    def __init__(self, corners, colors):
        self.corners, self.colors = corners, colors
        n = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
        self.twice_area = math.sqrt(dot(n, n))
        self.normal = [x / (self.twice_area or 1) for x in n]

    def mean(self, band=None):
        return sum(sum(c) / 3 if band is None else c[band] for c in self.colors) / 3

    def at(self, point):
        """(how far the point lies off the triangle, radiance there), by barycentric weights."""
        a, b, c = self.corners
        e, f, p = minus(b, a), minus(c, a), minus(point, a)
        ee, ef, ff, pe, pf = dot(e, e), dot(e, f), dot(f, f), dot(p, e), dot(p, f)
        area = ee * ff - ef * ef
        if area <= 0:
            return math.inf, None
        v, w = (ff * pe - ef * pf) / area, (ee * pf - ef * pe) / area
        outside = max(0, -v, -w, v + w - 1) * math.sqrt(max(ee, ff))
        return abs(dot(p, self.normal)) + outside, [
            x * (1 - v - w) + y * v + z * w for x, y, z in zip(*self.colors)]


class Grid:
    """Triangles by the cells that their boxes meet, in three hundredths of the whole along each axis: a look at all of tens of thousands
    for each of hundreds of points takes minutes."""

    def __init__(self, triangles):
        points = [c for t in triangles for c in t.corners]
        self.low = [min((p[k] for p in points), default=0) for k in range(3)]
        self.step = [max(max((p[k] for p in points), default=0) - self.low[k], NEAR_M) * 0.03 for k in range(3)]
        self.cells = {}
        for t in triangles:
            first = self.cell([min(c[k] for c in t.corners) - NEAR_M for k in range(3)])
            last = self.cell([max(c[k] for c in t.corners) + NEAR_M for k in range(3)])
            for at in itertools.product(*(range(a, b + 1) for a, b in zip(first, last))):
                self.cells.setdefault(at, []).append(t)

    def cell(self, point):
        return tuple(math.floor((point[k] - self.low[k]) / self.step[k]) for k in range(3))

    def around(self, point):
        return self.cells.get(self.cell(point), [])


class Baked:
    def __init__(self, out, ran, processor_s):
        self.out, self.code, self.text, self.processor_s = out, ran.returncode, ran.stdout + ran.stderr, processor_s
        self.asset = Asset(out) if self.code in (0, 4) and os.path.exists(out) else None
        self.report = {}
        if os.path.exists(out + ".json"):
            with open(out + ".json") as f:
                self.report = json.load(f)
        self._nodes, self._grids = None, {}

    def nodes(self):
        """Triangles of each node that the scene shows, by the node's name; copies of a node count with it."""
        if self._nodes is None:
            self._nodes = {}
            tree = self.asset.json
            for root in tree["scenes"][tree.get("scene", 0)]["nodes"]:
                self._walk(root, IDENTITY)
        return self._nodes

    def _walk(self, index, outer):
        node = self.asset.json["nodes"][index]
        m = times(outer, matrix(node))
        if "mesh" in node:
            self._nodes.setdefault(node.get("name"), []).extend(self.mesh_triangles(node["mesh"], m))
        for child in node.get("children", []):
            self._walk(child, m)

    def mesh_triangles(self, mesh, m=IDENTITY):
        for primitive in self.asset.json["meshes"][mesh]["primitives"]:
            attributes = primitive["attributes"]
            if "_RADIOSITY" not in attributes:
                continue
            points = [moved(m, p) for p in self.asset.values(attributes["POSITION"])]
            colors = [c[:3] for c in self.asset.values(attributes["_RADIOSITY"])]
            rows = [i for i, in self.asset.values(primitive["indices"])] if "indices" in primitive else range(len(points))
            for k in range(0, len(rows), 3):
                corners = rows[k:k + 3]
                yield Triangle([points[i] for i in corners], [colors[i] for i in corners])

    def mean(self, node, where=lambda triangle: True, band=None):
        """Mean radiance over area, and over bands unless one is named; None where the node has no light at all."""
        chosen = [t for t in self.nodes().get(node, []) if where(t)]
        area = sum(t.twice_area for t in chosen)
        return sum(t.mean(band) * t.twice_area for t in chosen) / area if area else None

    def at(self, node, point, normal=None):
        """Radiance of a node at a point that lies on it."""
        chosen = [t for t in self.near(node, point) if normal is None or dot(t.normal, normal) > 0.5]
        off, color = min((t.at(point) for t in chosen), key=lambda found: found[0], default=(math.inf, None))
        return color if off < NEAR_M else None

    def near(self, node, point):
        """The triangles of a node around a point, and others: those whose boxes meet its cell of a grid."""
        if node not in self._grids:
            self._grids[node] = Grid(self.nodes().get(node, []))
        return self._grids[node].around(point)

    def line(self, *words):
        """The first line of the output that has all the words, whatever their case."""
        return next((line for line in self.text.splitlines() if all(w.lower() in line.lower() for w in words)), None)


class Bench:
    """Bakes cases of a folder in another, each once."""

    def __init__(self, hemibake, cases, folder, quality):
        self.hemibake, self.cases, self.folder, self.quality, self.done = hemibake, cases, folder, quality, {}

    def bake(self, name, *options, quality=None, linear=True):
        """name: a file of the case folder, or a path of a made one."""
        key = (name, options, quality, linear)
        if key not in self.done:
            out = os.path.join(self.folder, f"{len(self.done)}.glb")
            self.done[key] = self.run(os.path.join(self.cases, name), out, options, quality, linear)
        return self.done[key]

    def run(self, path, out, options, quality, linear):
        command = [self.hemibake, "bake", path, "-o", out, "--no-draco", "--report", out + ".json",
                   "--quality", quality or self.quality, *(["--scene-linear"] if linear else []), *options]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            ran = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                                 timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            ran = subprocess.CompletedProcess(command, -9, "", f"not done after {PATIENCE_S} s")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return Baked(out, ran, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)

    def pack(self, name, out):
        """A Draco file with the case's materials, as our own writer leaves it."""
        subprocess.run([self.hemibake, "bake", os.path.join(self.cases, name), "-o", out, "--keep-pbr", "--quality", "draft"],
                       stdin=subprocess.DEVNULL, capture_output=True, timeout=PATIENCE_S)

    def made(self, name, source, change):
        """A copy of a case whose JSON is changed; its path, for bake()."""
        path = os.path.join(self.folder, name)
        asset = Asset(os.path.join(self.cases, source))
        change(asset.json)
        with open(path, "wb") as f:
            f.write(glb(asset.json, asset.bin[:asset.json["buffers"][0]["byteLength"]]))
        return path


def unfilter(kind, line, above, step):
    """Undoes one of PNG's five row filters in place."""
    for i in range(len(line)):
        left, up, corner = line[i - step] if i >= step else 0, above[i], above[i - step] if i >= step else 0
        if kind == 4:
            guess = left + up - corner
            best = min((left, up, corner), key=lambda x: abs(guess - x))
        else:
            best = (0, left, up, (left + up) // 2)[kind]
        line[i] = (line[i] + best) & 255


def pixels(path):
    """(width, height, rows of 8-bit rgb(a) bytes, bytes a pixel) of a PNG without interlace."""
    with open(path, "rb") as f:
        data = f.read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, _, color = struct.unpack_from(">IIBB", body)
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    step, raw, rows = {0: 1, 2: 3, 6: 4}[color], zlib.decompress(packed), []
    above = bytearray(width * step)
    for y in range(height):
        start = y * (width * step + 1)
        line = bytearray(raw[start + 1:start + 1 + width * step])
        unfilter(raw[start], line, above, step)
        rows.append(line)
        above = line
    return width, height, rows, step
