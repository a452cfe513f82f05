# SPDX-License-Identifier: MIT
"""How is a hard case built? Materials, squares, boxes, rooms and lamps on top of tests/cli/gltf_file.py; metres, y up."""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "cli"))
import gltf_file  # noqa: E402
from gltf_file import box, sphere  # noqa: E402,F401

WHITE, RED, GREEN, GREY = (0.7, 0.7, 0.7), (0.6, 0.1, 0.1), (0.1, 0.5, 0.1), (0.4, 0.4, 0.4)


def quad(a, b, c, d):
    """A flat sheet; its front is where its corners run counter-clockwise."""
    return [list(p) for p in (a, b, c, d)], [(0, 1, 2), (0, 2, 3)]


def floor(x0, z0, x1, z1, y=0.0):
    """A rectangle that looks up."""
    return quad((x0, y, z0), (x0, y, z1), (x1, y, z1), (x1, y, z0))


def ceiling(x0, z0, x1, z1, y):
    """A rectangle that looks down."""
    return quad((x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1))


def joined(*meshes):
    """One mesh of several without normals."""
    positions, triangles = [], []
    for mesh in meshes:
        triangles += [tuple(i + len(positions) for i in t) for t in mesh[1]]
        positions += [list(p) for p in mesh[0]]
    return positions, triangles


def moved(mesh, place, about=None, angle=0.0):
    """A mesh turned by an angle about a unit axis, then shifted."""
    from turned import rotation, times
    turn = rotation(about or (0, 1, 0), angle)
    return ([[x + s for x, s in zip(times(turn, p), place)] for p in mesh[0]], mesh[1],
            *([[times(turn, n) for n in mesh[2]]] if len(mesh) > 2 else []))


class Hard(gltf_file.Scene):
    """A scene whose meshes are named, with materials by what they are."""

    def __init__(self, *options):
        super().__init__()
        self.options = list(options)  # of the bake and of the oracle alike
        self.truth = None             # another scene with the same light, where the oracle cannot trace this one
        self.only = None              # nodes whose radiance counts; None: all that does not emit
        self.leave_out = None         # a box (low, high) in which nobody sees anything: no probes
        self.bright = None            # a box (low, high) that most of the light is in: half of the probes are there
        self.away = None              # where the root node puts the scene

    def material(self, rho=WHITE, emission=(0, 0, 0), double=False, **more):
        index = self.add_material(f"m{len(self.json['materials'])}", rho, emission)
        if double:
            self.json["materials"][index]["doubleSided"] = True
        self.json["materials"][index].update(more)
        return index

    def put(self, name, mesh, rho=WHITE, double=False):
        self.add_mesh(name, mesh, self.material(rho, double=double))
        return self

    def lamp(self, mesh, radiance=10.0, name="lamp"):
        self.add_mesh(name, mesh, self.material((0, 0, 0), (radiance,) * 3 if isinstance(radiance, (int, float)) else radiance))
        return self

    def room(self, low, high, rho=WHITE, name="room"):
        return self.put(name, box(low, high, inward=True), rho)

    def ceiling_lamp(self, x, y, z, half=0.3, radiance=10.0, name="lamp"):
        return self.lamp(ceiling(x - half, z - half, x + half, z + half, y), radiance, name)

    def light(self, place, light, rotation=(0, 0, 0, 1)):
        """A light without size; glTF's terms."""
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(light)
        self.json["nodes"].append({"translation": list(place), "rotation": list(rotation),
                                   "extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}})
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)
        self.json["extensionsUsed"] = sorted({*self.json.get("extensionsUsed", ()), "KHR_lights_punctual"})
        return self

    def attribute(self, name, values, kind):
        """Of the mesh that was put last."""
        self.json["meshes"][-1]["primitives"][0]["attributes"][name] = self._add_accessor(values, kind, gltf_file.FLOAT)
        return self
