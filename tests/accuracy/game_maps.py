# SPDX-License-Identifier: MIT
"""Do halls come out right that were built for a game, by many hands, with hundreds of things that glow? Maps of OpenArena (Debian's
openarena-081-maps), whose polygons and curved patches become meshes of one material a texture; a material whose texture is named for
light glows, or the sky is open where the map has one. Truth: tests/oracle/pathtrace.

    python3 tests/accuracy/game_maps.py [--maps am_galmevish,ps37ctf,slimefac] [--lit glow,sky] [--quality draft] [--paths 16384]
                                        [--archive FILE.pk3] [--keep FOLDER] [BAKE OPTION ...]

Prints a table; probes are spread by area over all that does not glow. What faces the void round a map is in it, and where two faces of
a map lie in one place the truth is of either.
"""

import argparse
import hashlib
import os
import re
import struct
import sys
import tempfile
import zipfile

import numpy
from furnished_rooms import PATHTRACE, PROBES, Room, measure, print_head

ARCHIVE = "/usr/share/games/openarena/baseoa/pak1-maps.pk3"
UNIT = 1 / 40  # m
STEPS = 4  # of a curved patch, along either side
TEXTURES, MODELS, VERTICES, CORNERS, FACES = 1, 7, 10, 11, 13  # which lump
POLYGON, PATCH, MESH = 1, 2, 3  # kinds of faces
OPEN_OR_UNSEEN = 0x4 | 0x80  # flags of a texture: the sky, and what is never drawn
UNSEEN_NAMES, GLOWING_NAMES = "sky|clip|trigger|hint|caulk|nodraw", "light|lamp|glow|neon|lava|fire|flame"


class Map(Room):
    def __init__(self, archive, name, lit):
        self.content = zipfile.ZipFile(archive).read(f"maps/{name}.bsp")
        self.lit, self.single_sided, triangles, curved = lit, set(), {}, set()
        names = [self.content_of(TEXTURES)[i:i + 72] for i in range(0, len(self.content_of(TEXTURES)), 72)]
        self.textures = [(t[:64].split(b"\0")[0].decode("latin1"), struct.unpack_from("<i", t, 64)[0]) for t in names]
        vertices = numpy.frombuffer(self.content_of(VERTICES), [("place", "<f4", 3), ("uv", "<f4", 4), ("normal", "<f4", 3), ("rgba", "u1", 4)])
        self.places, self.normals = (vertices[k][:, [0, 2, 1]] * (1.0, 1.0, -1.0) for k in ("place", "normal"))
        self.corners = numpy.frombuffer(self.content_of(CORNERS), "<i4")
        of_world = numpy.frombuffer(self.content_of(MODELS), "<i4")[7]
        for face in numpy.frombuffer(self.content_of(FACES), "<i4").reshape(-1, 26)[:of_world]:
            texture, kind = face[0], face[2]
            if self.textures[texture][1] & OPEN_OR_UNSEEN or re.search(UNSEEN_NAMES, self.textures[texture][0]):
                continue
            found = self.flat(face) if kind in (POLYGON, MESH) else self.curved(face) if kind == PATCH else None
            if found is not None and len(found):
                triangles.setdefault(texture, []).append(found * UNIT)
                curved |= {texture} if kind == PATCH else set()
        self.parts = [self.part(t, numpy.concatenate(found)) for t, found in sorted(triangles.items())]
        self.single_sided = {self.textures[t][0] for t in triangles if t not in curved}

    def content_of(self, lump):
        begin, size = struct.unpack_from("<ii", self.content, 8 + 8 * lump)
        return self.content[begin:begin + size]

    def flat(self, face):
        index = face[3] + self.corners[face[5]:face[5] + face[6]].reshape(-1, 3)
        found = self.places[index]
        across = numpy.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])
        turned = (across * self.normals[index].mean(1)).sum(1) < 0
        found[turned] = found[turned][:, ::-1]
        return found

    def curved(self, face):
        """Quadratic Bezier patches of three by three corners that share their borders."""
        wide, high = face[24], face[25]
        grid, u = self.places[face[3]:face[3] + wide * high].reshape(high, wide, 3), numpy.linspace(0, 1, STEPS + 1)
        basis, found = numpy.stack([(1 - u) ** 2, 2 * u * (1 - u), u * u], 1), []
        for y in range(0, high - 2, 2):
            for x in range(0, wide - 2, 2):
                q = numpy.einsum("ai,bj,ijk->abk", basis, basis, grid[y:y + 3, x:x + 3])
                for corners in ((q[:-1, :-1], q[1:, :-1], q[:-1, 1:]), (q[:-1, 1:], q[1:, :-1], q[1:, 1:])):
                    found.append(numpy.stack(corners, 2).reshape(-1, 3, 3))
        found = numpy.concatenate(found)
        across = numpy.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])
        return found[numpy.linalg.norm(across, axis=1) > 1e-6]

    def part(self, texture, places):
        name = self.textures[texture][0]
        shade = hashlib.md5(name.encode()).digest()
        glows = self.lit == "glow" and re.search(GLOWING_NAMES, os.path.basename(name))
        return name, [0.25 + 0.5 * shade[k] / 255 for k in range(3)], 10.0 if glows else 0.0, places, None

    def probes(self, chance):
        return self.spread(PROBES, chance)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--maps", default="am_galmevish,ps37ctf,slimefac")
    parser.add_argument("--lit", default="glow,sky")
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--paths", type=int, default=16384)
    parser.add_argument("--archive", default=ARCHIVE)
    parser.add_argument("--keep", help="a folder that maps, truth and bakes stay in")
    asked, options = parser.parse_known_args()
    if not os.path.exists(asked.archive) or not os.path.exists(PATHTRACE):
        print("skipped: there is no pathtrace; tests are not built" if os.path.exists(asked.archive) else "skipped: Debian's openarena-081-maps is not installed")
        return 77
    print_head()
    with tempfile.TemporaryDirectory() as folder:
        for lit in asked.lit.split(","):
            for name in asked.maps.split(","):
                measure(Map(asked.archive, name, lit), f"{name}-{lit}", 1, asked, options, asked.keep or folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
