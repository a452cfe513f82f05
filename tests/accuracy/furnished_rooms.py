# SPDX-License-Identifier: MIT
"""Do rooms come out right that are furnished by chance, with things that nobody made for hemibake? The furniture is that of Sweet Home 3D
(Debian's sweethome3d-furniture: 800 models by many hands, with all that real models have: planes through each other, slivers, insides);
a seed decides on the room, its lamps or its window, and what stands where. Truth: tests/oracle/pathtrace.

    python3 tests/accuracy/furnished_rooms.py [--seeds 1,2,3] [--lit lamps,sky] [--quality draft] [--most 60000] [--paths 16384]
                                              [--furniture FOLDER] [--keep FOLDER] [BAKE OPTION ...]

Prints a table; probes are inside of the room alone, spread over it by area. --most: triangles of a thing.
"""

import argparse
import glob
import json
import os
import posixpath
import random
import resource
import struct
import subprocess
import sys
import tempfile
import time
import zipfile

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
BUILD = os.path.join(ROOT, "build", "release")
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(BUILD, "bin", "hemibake"))
PATHTRACE = os.path.join(BUILD, "tests", "oracle", "pathtrace")
WALL, PROBES, EMISSION = 0.15, 400, 12.0


def linear(colour):
    return tuple(x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in colour)


# ---- furniture -------------------------------------------------------------------------------------------------------


class Thing:
    """A model of a catalogue: its parts are (colour, corners[n][3][3], normals or None), as large as the catalogue says."""

    def __init__(self, archive, entry):
        self.archive, self.name, self.path = archive, entry["name"], entry["model"].lstrip("/")
        self.size = [float(entry[k]) / 100 for k in ("width", "height", "depth")]
        self.elevation = float(entry.get("elevation", 0)) / 100
        self.top = float(entry.get("dropOnTopElevation", entry["height"])) / 100

    def materials(self, name):
        found, current = {}, {}
        try:
            text = self.archive.read(posixpath.join(posixpath.dirname(self.path), name)).decode("latin1")
        except KeyError:
            return found
        for words in filter(None, map(str.split, text.splitlines())):
            if words[0] == "newmtl":
                current = found.setdefault(words[-1], {})
            elif words[0] == "Kd":
                current["colour"] = tuple(min(float(x), 0.95) for x in words[1:4])
            elif words[0] == "d":
                current["alpha"] = float(words[-1])
            elif words[0] == "map_Kd":
                current["colour"] = (0.5, 0.45, 0.4)
        return found

    def parts(self):
        places, normals, materials, faces, current = [], [], {}, {}, ""
        for words in filter(None, map(str.split, self.archive.read(self.path).decode("latin1").splitlines())):
            if words[0] in ("v", "vn"):
                (places if words[0] == "v" else normals).append([float(x) for x in words[1:4]])
            elif words[0] == "mtllib":
                materials.update(self.materials(words[1]))
            elif words[0] == "usemtl":
                current = words[-1]
            elif words[0] == "f":
                corners = [[int(x or 0) for x in (word + "//").split("/")[:3:2]] for word in words[1:]]
                faces.setdefault(current, []).extend((corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1))
        places, normals = numpy.array(places), numpy.array(normals).reshape(-1, 3)
        for name, triangles in faces.items():
            material, index = materials.get(name, {}), numpy.array(triangles)
            if material.get("alpha", 1.0) < 0.5:
                continue
            known = len(normals) > 0 and (index[..., 1] != 0).all()
            of = [index[..., k] - numpy.where(index[..., k] > 0, 1, -len(a)) for k, a in enumerate((places, normals))]
            yield linear(material.get("colour", (0.6, 0.6, 0.6))), places[of[0]], normals[of[1]] if known else None


def catalogue(folder):
    things = []
    for path in sorted(glob.glob(os.path.join(folder, "*.sh3f"))):
        archive, entries = zipfile.ZipFile(path), {}
        for line in archive.read("PluginFurnitureCatalog.properties").decode("latin1").splitlines():
            key, is_pair, value = line.partition("=")
            if is_pair and "#" in key:
                entries.setdefault(key.split("#")[1], {})[key.split("#")[0]] = value
        things += [Thing(archive, e) for e in entries.values()
                   if e.get("model", "").endswith(".obj") and "width" in e and e.get("doorOrWindow") != "true"]
    return things


# ---- a room ----------------------------------------------------------------------------------------------------------


class Room:
    single_sided = {"floor", "ceiling", "wall", "skirting", "frame", "lamp"}

    def __init__(self, seed, lit, things, most):
        self.chance = random.Random(seed)
        self.parts, self.standing, self.lit = [], [], lit
        self.long, self.wide, self.high = self.chance.uniform(3.5, 7), self.chance.uniform(3, 5.5), self.chance.uniform(2.4, 2.9)
        self.build()
        self.furnish(things, most)

    def box(self, low, high, name, colour, emission=0.0):
        corners = numpy.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)])
        quads = numpy.array([[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]])
        self.parts.append((name, colour, emission, corners[quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)], None))

    def build(self):
        uniform, x, y, z = self.chance.uniform, self.long, self.high, self.wide
        wall = linear([uniform(0.55, 0.92) for _ in range(3)])
        floor = linear((uniform(0.35, 0.7), uniform(0.3, 0.6), uniform(0.25, 0.5)))
        self.box((-WALL, -WALL, -WALL), (x + WALL, 0, z + WALL), "floor", floor)
        self.box((-WALL, y, -WALL), (x + WALL, y + WALL, z + WALL), "ceiling", linear((0.9, 0.9, 0.9)))
        for low, high in (((-WALL, 0, -WALL), (0, y, z + WALL)), ((0, 0, -WALL), (x, y, 0)), ((0, 0, z), (x, y, z + WALL))):
            self.box(low, high, "wall", wall)
        for low, high in (((0, 0, 0), (x, 0.08, 0.015)), ((0, 0, z - 0.015), (x, 0.08, z)), ((0, 0, 0.015), (0.015, 0.08, z - 0.015))):
            self.box(low, high, "skirting", (0.75, 0.75, 0.75))
        if self.lit == "lamps":
            self.box((x, 0, -WALL), (x + WALL, y, z + WALL), "wall", wall)
            self.hang_lamps()
            return
        low, high = (self.chance.choice((0, 0.9)), uniform(0.3, 0.4 * z)), (uniform(2, y - 0.15), uniform(0.6 * z, z - 0.3))
        for a, b in (((0, -WALL), (y, low[1])), ((0, high[1]), (y, z + WALL)), ((0, low[1]), (low[0], high[1])), ((high[0], low[1]), (y, high[1]))):
            if b[0] > a[0]:
                self.box((x, *a), (x + WALL, *b), "wall", wall)
        for a, b in ((low, (low[0] + 0.06, high[1])), ((high[0] - 0.06, low[1]), high)):
            self.box((x + 0.05, *a), (x + 0.1, *b), "frame", (0.8, 0.8, 0.8))

    def hang_lamps(self):
        """As flat ones do, 3 cm under the ceiling, all of them glowing, none into another."""
        lamps = []
        for _ in range(self.chance.randint(1, 3)):
            size = self.chance.uniform(0.25, 0.6)
            x, z = self.chance.uniform(0.3, self.long - 0.9), self.chance.uniform(0.3, self.wide - 0.9)
            if all(abs(x - a) > 0.7 or abs(z - b) > 0.7 for a, b in lamps):
                lamps.append((x, z))
                self.box((x, self.high - 0.06, z), (x + size, self.high - 0.03, z + size), "lamp", (0.5, 0.5, 0.5), EMISSION)

    def furnish(self, things, most):
        wanted, chance = self.chance.randint(8, 15), self.chance
        for _ in range(200):
            thing, turn = chance.choice(things), chance.randint(0, 3)
            wide, high, deep = thing.size
            across, along = (wide, deep) if turn % 2 == 0 else (deep, wide)
            if not 0.1 < min(wide, deep) <= max(wide, deep) < 2.6 or high > self.high - 0.1 or across > self.long - 0.2 or along > self.wide - 0.2:
                continue
            x, z = chance.uniform(across / 2, self.long - across / 2), chance.uniform(along / 2, self.wide - along / 2)
            foot = thing.elevation if thing.elevation + high <= self.high else 0.0
            tops = [s for s in self.standing if s[1] - s[0] > across and s[3] - s[2] > along and s[4] + high < self.high]
            if high < 0.35 and foot == 0.0 and tops:
                on = chance.choice(tops)
                x, z, foot = chance.uniform(on[0] + across / 2, on[1] - across / 2), chance.uniform(on[2] + along / 2, on[3] - along / 2), on[4]
            place = (x - across / 2, x + across / 2, z - along / 2, z + along / 2, foot + thing.top)
            if foot < 1 and any(place[0] < s[1] and place[1] > s[0] and place[2] < s[3] and place[3] > s[2] and s[4] != foot for s in self.standing):
                continue
            parts = list(thing.parts())
            if parts and sum(len(p) for _, p, _ in parts) <= most:
                self.stand(thing, parts, (x, foot, z), turn)
                self.standing.append(place)
            if len(self.standing) == wanted:
                return

    def stand(self, thing, parts, at, turn):
        everything = numpy.concatenate([p.reshape(-1, 3) for _, p, _ in parts])
        low, high = everything.min(0), everything.max(0)
        scale = numpy.array(thing.size) / numpy.maximum(high - low, 1e-6)
        cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]
        turned = numpy.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]], float)
        for colour, places, normals in parts:
            places = ((places - (low + high) / 2) * scale) @ turned.T + numpy.array(at) + (0, thing.size[1] / 2, 0)
            if normals is not None:
                normals = (normals / scale) @ turned.T
                normals /= numpy.maximum(numpy.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
            self.parts.append((thing.name, colour, 0.0, places, normals))

    def write(self, path):
        content, views, accessors, meshes, materials = b"", [], [], [], []

        def push(array, kind, extremes):
            nonlocal content
            views.append({"buffer": 0, "byteOffset": len(content), "byteLength": array.nbytes})
            content += array.tobytes()
            accessors.append({"bufferView": len(views) - 1, "componentType": 5126 if array.dtype == numpy.float32 else 5125,
                              "count": len(array), "type": kind, **extremes})
            return len(accessors) - 1

        for name, colour, emission, places, normals in self.parts:
            corners = places.reshape(-1, 3) if normals is None else numpy.concatenate([places.reshape(-1, 3), normals.reshape(-1, 3)], 1)
            vertices, index = numpy.unique(corners.astype("<f4"), axis=0, return_inverse=True)
            attributes = {}
            for k, attribute in enumerate(("POSITION", "NORMAL")[:vertices.shape[1] // 3]):
                values = numpy.ascontiguousarray(vertices[:, 3 * k:3 * k + 3])
                extremes = {"min": values.min(0).tolist(), "max": values.max(0).tolist()} if k == 0 else {}
                attributes[attribute] = push(values, "VEC3", extremes)
            material = {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": 1},
                        "doubleSided": name not in self.single_sided}
            if emission > 0:
                material.update(emissiveFactor=[1, 0.9, 0.75], extensions={"KHR_materials_emissive_strength": {"emissiveStrength": emission}})
            meshes.append({"name": name, "primitives": [{"attributes": attributes, "material": len(materials),
                                                         "indices": push(index.reshape(-1).astype("<u4"), "SCALAR", {})}]})
            materials.append(material)
        text = json.dumps({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_emissive_strength"], "scene": 0,
                           "scenes": [{"nodes": list(range(len(meshes)))}], "nodes": [{"mesh": i} for i in range(len(meshes))],
                           "meshes": meshes, "materials": materials, "accessors": accessors, "bufferViews": views,
                           "buffers": [{"byteLength": len(content)}]}).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as f:
            f.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(content), len(text), 0x4E4F534A) + text)
            f.write(struct.pack("<II", len(content), 0x004E4942) + content)

    def spread(self, count, chance):
        """Places, normals, and room for the truth, spread by area over all that does not glow."""
        places = numpy.concatenate([p for _, _, emission, p, _ in self.parts if emission == 0])
        crosses = numpy.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
        areas = numpy.linalg.norm(crosses, axis=1) / 2
        chosen, uv = chance.choice(len(places), count, p=areas / areas.sum()), chance.random((count, 2))
        uv = numpy.where(uv.sum(1, keepdims=True) > 1, 1 - uv, uv)
        at = places[chosen, 0] + sum(uv[:, k:k + 1] * (places[chosen, k + 1] - places[chosen, 0]) for k in range(2))
        return numpy.concatenate([at, crosses[chosen] / (2 * areas[chosen])[:, None], numpy.zeros((count, 4))], 1)

    def probes(self, chance):
        values = self.spread(20 * PROBES, chance)
        before = values[:, :3] + 1e-3 * values[:, 3:6]  # what faces the room is before its walls
        inside = ((before > 0) & (before < (self.long, self.high, self.wide))).all(1)
        return values[inside][:PROBES]

    def write_probes(self, path, seed):
        values = self.probes(numpy.random.default_rng(seed))
        with open(path, "wb") as f:
            f.write(b"HPRB" + struct.pack("<I", len(values)) + values.astype("<f4").tobytes())


# ---- the table -------------------------------------------------------------------------------------------------------


def print_head():
    print("| scene | triangles | method | error, % | noise of the truth, % | median of a probe, % | bias, % | estimate, % | elements | s | processor, s |")
    print("|---|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|")


def measure(room, name, seed, asked, options, folder):
    at = {kind: os.path.join(folder, f"{name}.{kind}") for kind in ("glb", "places", "hprb", "baked.glb", "json")}
    sky = ["--environment", "1,1,1"] if room.lit == "sky" else []
    room.write(at["glb"])
    room.write_probes(at["places"], seed)
    subprocess.run([PATHTRACE, at["glb"], at["places"], "--samples", str(asked.paths), *sky, "-o", at["hprb"]], check=True, stdout=subprocess.DEVNULL)
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([HEMIBAKE, "bake", at["glb"], "-o", at["baked.glb"], "--quality", asked.quality, "--scene-linear", "--no-draco", "--quiet",
                    "--report", at["json"], *sky, *options], check=True, stderr=subprocess.DEVNULL)
    seconds, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    judged = json.loads(subprocess.run([HEMIBAKE, "compare", at["baked.glb"], at["hprb"], "--json"], check=True, stdout=subprocess.PIPE).stdout)
    with open(at["json"], encoding="utf-8") as f:
        report = json.load(f)
    noise = judged["reference_noise"]
    error = max(judged["error"] ** 2 - noise ** 2, 0.0) ** 0.5
    print(f"| {name} | {sum(len(p[3]) for p in room.parts)} | {report['solver']['method']} | {100 * error:.2f} | {100 * noise:.2f} | "
          f"{100 * judged['probe_error_median']:.2f} | {100 * judged['bias']:+.2f} | {100 * report['error']['estimate']:.2f} | "
          f"{report['scene']['elements']} | {seconds:.1f} | {after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime:.1f} |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--lit", default="lamps,sky")
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--most", type=int, default=60000)
    parser.add_argument("--paths", type=int, default=16384)
    parser.add_argument("--furniture", default="/usr/share/sweethome3d/furniture")
    parser.add_argument("--keep", help="a folder that rooms, truth and bakes stay in")
    asked, options = parser.parse_known_args()
    things = catalogue(asked.furniture)
    if not things or not os.path.exists(PATHTRACE):
        print("skipped: Debian's sweethome3d-furniture is not installed" if not things else "skipped: there is no pathtrace; tests are not built")
        return 77
    print_head()
    with tempfile.TemporaryDirectory() as folder:
        for lit in asked.lit.split(","):
            for seed in map(int, asked.seeds.split(",")):
                measure(Room(seed, lit, things, asked.most), f"{lit}-{seed}", seed, asked, options, asked.keep or folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
