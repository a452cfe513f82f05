# SPDX-License-Identifier: MIT
"""What is true of a hard case? Probes uniform by area on what reflects, and their radiance by tests/oracle, kept in the build folder."""

import array
import hashlib
import math
import os
import random
import shutil
import struct
import subprocess

from shapes import gltf_file

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
ORACLE = os.environ.get("HEMIBAKE_ORACLE", os.path.join(ROOT, "build/release/tests/oracle/pathtrace"))
KEPT = os.environ.get("HEMIBAKE_HARD", os.path.join(ROOT, "build/hard_cases"))

PROBES = 600

# Paths a probe: at first, and at most where the noise of the truth is above what is wanted.
PATHS, PATHS_MOST, NOISE_WANTED = 256, 1 << 13, 0.005

# The same of a node by itself: a room that is lit through a slot is met by one path in ten thousand.
NODE_PATHS_MOST, NODE_NOISE_WANTED = 1 << 15, 0.1

PATIENCE_S = 1800


class Probe:
    def __init__(self, node, position, normal):
        self.node, self.position, self.normal, self.truth, self.noise = node, position, normal, None, None
        self.weight = 1.0  # the area that it stands for, but for a factor


def node_matrix(node):
    """Translation and scale, as rows of a function; the scenes turn nothing by a node."""
    s, t = node.get("scale", (1, 1, 1)), node.get("translation", (0, 0, 0))
    return lambda p: [a * b + c for a, b, c in zip(p, s, t)], s[0] * s[1] * s[2] < 0


def triangles(scene):
    """(node, corners, normal, area) of each front that reflects and does not shine; sheets of two fronts are there twice."""
    asset = gltf_file.Asset.__new__(gltf_file.Asset)
    asset.json, asset.bin = scene.json, bytes(scene.bin)
    for node in scene.json["nodes"]:
        if "mesh" not in node or scene.only and node["name"] not in scene.only:
            continue
        place, mirrored = node_matrix(node)
        for primitive in scene.json["meshes"][node["mesh"]]["primitives"]:
            material = scene.json["materials"][primitive["material"]]
            if any(material["emissiveFactor"]):
                continue
            corners = [place(p) for p in asset.values(primitive["attributes"]["POSITION"])]
            flat = [i[0] for i in asset.values(primitive["indices"])]
            for t in range(0, len(flat), 3):
                a, b, c = (corners[i] for i in flat[t:t + 3])
                u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
                n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
                length = math.sqrt(sum(x * x for x in n))
                if length == 0:
                    continue
                n = [(-x if mirrored else x) / length for x in n]
                yield node["name"], (a, b, c), n, length / 2
                if material.get("doubleSided"):
                    yield node["name"], (a, b, c), [-x for x in n], length / 2


def single(x):
    """As the file of probes will have it."""
    return array.array("f", [x])[0]


def cut(corners, k, bound, sign):
    """What of a convex polygon is on one side of a plane across axis k."""
    out = []
    for a, b in zip(corners, corners[1:] + corners[:1]):
        x, y = sign * (a[k] - bound), sign * (b[k] - bound)
        if x >= 0:
            out.append(a)
        if (x < 0) != (y < 0):
            out.append([p + x / (x - y) * (q - p) for p, q in zip(a, b)])
    return out


def area_of(a, b, c):
    u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
    return math.sqrt(sum((u[i] * v[j] - u[j] * v[i]) ** 2 for i, j in ((0, 1), (1, 2), (2, 0)))) / 2


def inside(fronts, low, high):
    """What of them is in a box, as triangles."""
    for name, corners, normal, _ in fronts:
        shape = list(corners)
        for k in range(3):
            shape = cut(cut(shape, k, low[k], 1), k, high[k], -1)
        for b, c in zip(shape[1:], shape[2:]):
            yield name, (shape[0], b, c), normal, area_of(shape[0], b, c)


def is_in(place, low, high):
    return all(a <= x <= b for a, x, b in zip(low, place, high))


def place_probes(scene, count=PROBES):
    """Even ones; half of them where most of the light is, if that is said: what is bright on a few square decimetres would have one or two,
    and the error be judged by what there is none of."""
    fronts = list(triangles(scene))
    if not scene.bright:
        return place_on(fronts, count, scene)
    near = [t for t in inside(fronts, *scene.bright) if t[3] > 0]
    all_area, near_area = (sum(t[3] for t in part) for part in (fronts, near))
    far = [p for p in place_on(fronts, count // 2, scene) if not is_in(p.position, *scene.bright)]
    near = place_on(near, count // 2, scene)
    for some, area in ((near, near_area), (far, all_area - near_area)):
        for p in some:
            p.weight = area / len(some)
    return near + far


def place_on(fronts, count, scene):
    """One in each of so many equal parts of the area: even, and the same on every run. A holed texture has none in its holes here, so
    none is put on what is masked."""
    dice, out = random.Random(1989), []
    total, before, at = sum(t[3] for t in fronts), 0.0, 0
    for i in range(count):
        target = (i + dice.random()) / count * total
        while at < len(fronts) - 1 and before + fronts[at][3] < target:
            before += fronts[at][3]
            at += 1
        name, (a, b, c), normal, _ = fronts[at]
        u, v = dice.random(), dice.random()
        if u + v > 1:
            u, v = 1 - u, 1 - v
        place = [single(x + u * (y - x) + v * (z - x)) for x, y, z in zip(a, b, c)]
        if not (scene.leave_out and is_in(place, *scene.leave_out)):
            out.append(Probe(name, place, normal))
    return out


def write(path, probes):
    with open(path, "wb") as f:
        f.write(b"HPRB" + struct.pack("<I", len(probes)))
        for p in probes:
            f.write(struct.pack("<10f", *p.position, *p.normal, *(p.truth or (0, 0, 0)), p.noise or 0))


def noise(probes):
    power = sum(p.weight * x * x for p in probes for x in p.truth)
    return math.sqrt(3 * sum(p.weight * p.noise ** 2 for p in probes) / power) if power > 0 else 0.0


def trace(glb, probes, paths, options, folder):
    """The probes, with the truth that so many paths tell."""
    before, after = (os.path.join(folder, name) for name in ("places.hprb", "truth.hprb"))
    write(before, [Probe(p.node, p.position, p.normal) for p in probes])
    subprocess.run([ORACLE, glb, before, "--samples", str(paths), "-o", after, *options], check=True, stdout=subprocess.DEVNULL,
                   timeout=PATIENCE_S)
    read(after, probes)
    return [p for p in probes if p.truth is not None]


def trace_until(glb, probes, paths, most, wanted, options, folder):
    """Until their noise is what is wanted."""
    while probes:
        probes = trace(glb, probes, paths, options, folder)
        there = noise(probes)
        if there <= wanted or paths >= most:
            break
        paths = min(most, 2 ** math.ceil(math.log2(paths * max(2, (there / wanted) ** 2))))
    return paths


def trace_all(glb, probes, options, folder):
    paths = trace_until(glb, probes, PATHS, PATHS_MOST, NOISE_WANTED, options, folder)
    for node in sorted({p.node for p in probes}):
        of_node = [p for p in probes if p.node == node and p.truth is not None]
        if noise(of_node) > NODE_NOISE_WANTED:
            trace_until(glb, of_node, paths, NODE_PATHS_MOST, NODE_NOISE_WANTED, options, folder)


def tell(scene, probes, folder):
    """Sets the truth of the probes."""
    traced = scene.truth or scene
    glb, told = os.path.join(folder, "truth.glb"), os.path.join(folder, "told.hprb")
    data, options = traced.glb(), traced.options
    with open(glb, "wb") as f:
        f.write(data)
    write(told, probes)
    with open(told, "rb") as f:
        wanted = options, PATHS, PATHS_MOST, NOISE_WANTED, NODE_PATHS_MOST, NODE_NOISE_WANTED
        key = hashlib.sha256(data + f.read() + repr(wanted).encode()).hexdigest()[:32]
    kept = os.path.join(KEPT, key + ".hprb")
    if not os.path.exists(kept):
        trace_all(glb, probes, options, folder)
        write(told, [p for p in probes if p.truth is not None])
        os.makedirs(KEPT, exist_ok=True)
        shutil.move(told, kept)
    read(kept, probes)
    return [p for p in probes if p.truth is not None]


def read(path, probes):
    """Those that the oracle finds no surface for are left out of its file, and stay without a truth."""
    at = {tuple(p.position): p for p in probes}
    for p in probes:
        p.truth = None
    with open(path, "rb") as f:
        data = f.read()
    for i in range(struct.unpack_from("<I", data, 4)[0]):
        row = struct.unpack_from("<10f", data, 8 + 40 * i)
        p = at.get(row[:3])
        if p:
            p.truth, p.noise = row[6:9], row[9]
    for p in probes:
        if p.truth is None:
            p.truth, p.noise = None, None
