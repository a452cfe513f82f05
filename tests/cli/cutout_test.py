# SPDX-License-Identifier: MIT
"""Does light pass through what alphaMode MASK cuts out, and only there? And is what is left as large as it looks?"""

import json
import math

from command import CommandCase, main
from gltf_file import FLOAT, Asset, Scene, box, png, room

UV = ((0, 0), (1, 0), (1, 1), (0, 1))


def square(z, half, turned=False, y=0.0):
    """Upright and facing +z, or -z if turned; texture coordinates UV at its corners."""
    corners = [[-half, y - half, z], [half, y - half, z], [half, y + half, z], [-half, y + half, z]]
    return corners, [(0, 2, 1), (0, 3, 2)] if turned else [(0, 1, 2), (0, 2, 3)]


def masked(name="fence", rho=(0, 0, 0), alpha=1, **more):
    return {"name": name, "alphaMode": "MASK", "doubleSided": True,
            "pbrMetallicRoughness": {"baseColorFactor": [*rho, alpha], "metallicFactor": 0, **more}}


class Yard(Scene):
    """A lamp at z = -2, a wall at z = 0 that hardly reflects, both 2 m wide; a fence of 8 m at z = -1 if asked for."""

    def __init__(self, fence=None, uv=UV, scale=1.0, half=4.0, colors=None):
        super().__init__()
        self.add_mesh("lamp", square(-2, 0.25), self.add_material("lamp", (0, 0, 0), (5, 5, 5)))
        self.add_mesh("wall", square(0, 1, turned=True), self.add_material("wall", (0.05, 0.05, 0.05)))
        if fence is None:
            return
        self.json["materials"].append(fence)
        self.add_mesh("fence", square(-1, half), len(self.json["materials"]) - 1)
        attributes = self.json["meshes"][-1]["primitives"][0]["attributes"]
        if uv:
            attributes["TEXCOORD_0"] = self._add_accessor([[scale * u, scale * v] for u, v in uv], "VEC2", FLOAT)
        if colors:
            attributes["COLOR_0"] = self._add_accessor(colors, "VEC4", FLOAT)


def picture(alpha, side=16):
    """White texels; alpha(row, column)."""
    return png(side, side, lambda y, x: (255, 255, 255, alpha(y, x)), channels=4)


def checker(y, x):
    return 255 * ((y // 8 + x // 8) & 1)


TEXTURED = {"baseColorTexture": {"index": 0}}


class Cutout(CommandCase):
    def wall(self, scene, *options, quality="draft"):
        """Mean radiance of the wall over its area."""
        self.write("in.glb", scene.glb())
        self.ran = self.bake("in.glb", "out.glb", "--no-draco", "--scene-linear", "--quality", quality,
                             "--report", "report.json", *options)
        with open(self.path("report.json")) as f:
            self.report = json.load(f)
        self.out = Asset(self.path("out.glb"))
        primitive = self.out.json["meshes"][1]["primitives"][0]
        self.places = self.out.values(primitive["attributes"]["POSITION"])
        self.values = [v[0] for v in self.out.values(primitive["attributes"]["_RADIOSITY"])]
        corners = [i for i, in self.out.values(primitive["indices"])]
        whole = area = 0.0
        for a, b, c in zip(corners[0::3], corners[1::3], corners[2::3]):
            (ax, ay, _), (bx, by, _), (cx, cy, _) = (self.places[i] for i in (a, b, c))
            part = abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2
            area += part
            whole += part * (self.values[a] + self.values[b] + self.values[c]) / 3
        return whole / area

    def test_half_the_light_passes_a_fence_that_is_half_cut_out(self):
        free = self.wall(Yard())
        for scale in (16, 40, 97.3):  # cells of 25 cm, 10 cm, 4 cm: some larger, some smaller than pixels
            scene = Yard(masked(**TEXTURED), scale=scale).add_image(picture(checker))
            # The wall is sampled at some thousand points from some hundred of the lamp: 2 % are the chance of that.
            share = self.wall(scene) / free
            print(f"fence of {scale} repeats: {100 * share:.2f} % of the light passes")
            self.assertAlmostEqual(share, 0.5, delta=0.02, msg=scale)

    def test_every_method_sees_the_holes(self):
        for method in ("analytic", "pr", "fm"):
            free = self.wall(Yard(), "--method", method)
            scene = Yard(masked(**TEXTURED), scale=16).add_image(picture(checker))
            # Pixels of one hemi-cube a patch: coarser than the hybrid.
            self.assertAlmostEqual(self.wall(scene, "--method", method) / free, 0.5, delta=0.06, msg=method)

    def test_refined_elements_see_what_is_left(self):
        """A floor beside a bright fence whose foot stands on it: as with small elements of one size."""
        scene = Yard()
        scene.add_mesh("floor", ([[-1, 0, -1.02], [1, 0, -1.02], [1, 0, 1], [-1, 0, 1]], [(0, 2, 1), (0, 3, 2)]),
                       scene.add_material("floor", (0.5, 0.5, 0.5)))
        scene.add_mesh("above", ([[-0.25, 1.5, -0.5], [0.25, 1.5, -0.5], [0.25, 1.5, 0], [-0.25, 1.5, 0]],
                                 [(0, 1, 2), (0, 2, 3)]), scene.add_material("above", (0, 0, 0), (8, 8, 8)))
        scene.json["materials"].append(masked(rho=(0.9, 0.9, 0.9), **TEXTURED))
        scene.add_mesh("fence", ([[-1, 0, -1], [1, 0, -1], [1, 1, -1], [-1, 1, -1]], [(0, 1, 2), (0, 2, 3)]),
                       len(scene.json["materials"]) - 1)
        scene.json["meshes"][-1]["primitives"][0]["attributes"]["TEXCOORD_0"] = scene._add_accessor(
            [[40 * u, 20 * v] for u, v in UV], "VEC2", FLOAT)
        scene.json["scenes"][0]["nodes"] = [2, 3, 4]
        self.write("in.glb", scene.add_image(picture(checker)).glb())
        beside = []
        for options in (("draft",), ("medium", "--uniform", "--element-size", 0.03)):
            # All triangles, because which of them lie in a strip is asked of their centres.
            self.bake("in.glb", "out.glb", "--no-draco", "--scene-linear", "--merge-error", "0", "--report", "report.json",
                      "--quality", *options)
            beside.append(self.beside(Asset(self.path("out.glb"))))
            with open(self.path("report.json")) as f:
                counts = json.load(f)["scene"]
            self.assertEqual(counts["elements"] > counts["coarse_elements"], len(beside) == 1, options)
        print(f"floor beside a fence: {beside[0]:.4f} refined, {beside[1]:.4f} uniformly fine")
        # 1 % is what draft's elements of 5 cm leave out there; a fence without holes is 12 % off.
        self.assertAlmostEqual(beside[0] / beside[1], 1, delta=0.01)

    @staticmethod
    def beside(out):
        """Mean radiance of the floor from 10 to 30 cm beside the fence, by area."""
        primitive, = out.primitives("floor")
        places, values = (out.values(primitive["attributes"][name]) for name in ("POSITION", "_RADIOSITY"))
        corners = [i for i, in out.values(primitive["indices"])]
        whole = area = 0.0
        for t in zip(corners[0::3], corners[1::3], corners[2::3]):
            (ax, _, az), (bx, _, bz), (cx, _, cz) = (places[i] for i in t)
            if -0.9 <= (az + bz + cz) / 3 < -0.7:
                part = abs((bx - ax) * (cz - az) - (cx - ax) * (bz - az)) / 2
                area += part
                whole += part * sum(values[i][0] for i in t) / 3
        return whole / area

    def test_the_sky_and_the_sun_pass_too(self):
        for light in (("--environment", "1,1,1"), ("--sun", "0,20,1000,2")):
            # North is -z: the sun stands behind the fence.
            def share(alpha):
                scene = Yard(masked(**TEXTURED), scale=24, half=6).add_image(picture(alpha))
                scene.json["scenes"][0]["nodes"].remove(0)
                return self.wall(scene, *light)
            none, half, all_of_it = share(lambda y, x: 255), share(checker), share(lambda y, x: 0)
            print(f"{light[0]}: {none:.4f} {half:.4f} {all_of_it:.4f}")
            self.assertAlmostEqual((half - none) / (all_of_it - none), 0.5, delta=0.03, msg=light)

    def test_what_is_cut_out_is_not_there(self):
        """Neither its area nor its colour: a lamp that is half cut out emits half; black texels in holes do not count."""
        lamp = masked("lamp", **TEXTURED)
        lamp["emissiveFactor"] = [1, 1, 1]
        emitted = []
        for alpha in (lambda y, x: 255, checker, lambda y, x: 0):
            self.wall(Yard(lamp, scale=3.3, half=0.5).add_image(picture(alpha)))
            emitted.append(self.report["energy"]["emitted"])
        # 0.25 m2 of radiance 5 in three bands, and twice 1 m2 of radiance 1, since it has two sides.
        bare = 3 * math.pi * 0.25 * 5
        self.assertAlmostEqual(emitted[0], bare + 3 * math.pi * 2, delta=1e-3)
        self.assertAlmostEqual(emitted[1], bare + 3 * math.pi, delta=0.01 * 3 * math.pi)
        self.assertAlmostEqual(emitted[2], bare, delta=1e-3)

        def texel(y, x):
            return (255, 255, 255, 255) if checker(y, x) else (0, 0, 0, 0)
        leaf = masked("leaf", rho=(0.5, 0.5, 0.5), **TEXTURED)
        scene = Yard(leaf, scale=3.3, half=0.5).add_image(png(16, 16, texel, channels=4))
        scene.json["scenes"][0]["nodes"] = [2]
        self.write("leaf.glb", scene.glb())
        self.bake("leaf.glb", "leaf.out.glb", "--no-draco", "--scene-linear", "--quality", "draft",
                  "--environment", "1,1,1")
        out = Asset(self.path("leaf.out.glb"))
        for value in out.values(out.json["meshes"][2]["primitives"][0]["attributes"]["_RADIOSITY"]):
            self.assertAlmostEqual(value[0], 0.5, delta=5e-3)

    def test_a_furnace_with_a_card_that_is_half_cut_out_settles(self):
        """Everything emits 1 and reflects half: 2 everywhere, whatever stands in it, and the books close."""
        scene = room()
        scene.json["scenes"][0]["nodes"] = [0]  # without the lamp, whose back absorbs, and a box that hides the floor
        scene.json["materials"] = [masked("leaf", rho=(0.5, 0.5, 0.5), **TEXTURED)]
        scene.json["materials"][0]["emissiveFactor"] = [1, 1, 1]
        wall = scene.add_material("wall", (0.5, 0.5, 0.5), (1, 1, 1))
        for mesh in scene.json["meshes"]:
            mesh["primitives"][0]["material"] = wall
        scene.add_mesh("card", square(0.5, 0.3, y=0.5), 0)
        attributes = scene.json["meshes"][-1]["primitives"][0]["attributes"]
        attributes["TEXCOORD_0"] = scene._add_accessor([[5.3 * u, 5.3 * v] for u, v in UV], "VEC2", FLOAT)
        self.write("in.glb", scene.add_image(picture(checker)).glb())
        self.bake("in.glb", "out.glb", "--no-draco", "--scene-linear", "--quality", "draft", "--report", "report.json")
        with open(self.path("report.json")) as f:
            report = json.load(f)
        out = Asset(self.path("out.glb"))
        self.assertLess(report["energy"]["residual_fraction"], 1e-12)
        for mesh in (mesh for mesh in out.json["meshes"] if mesh["name"] in ("room", "card")):
            for value in out.values(mesh["primitives"][0]["attributes"]["_RADIOSITY"]):
                # Draft leaves 1 % of the power unshot, which is not spread evenly: up to twice that in a place.
                self.assertAlmostEqual(value[0], 2, delta=2 * 0.02, msg=mesh["name"])

    def test_a_card_of_nothing_but_holes_changes_nothing_in_a_room(self):
        """Columns are made to add up in a closed room, for which nearly all shooters have to be known: holes are none."""
        tops = []
        for card in (False, True):
            scene = room()
            if card:
                scene.json["materials"].append(masked(rho=(0.5, 0.5, 0.5), alpha=0.4))
                scene.add_mesh("card", box((-0.99, 1, -0.99), (0.99, 1.001, 0.99)), len(scene.json["materials"]) - 1)
            self.write("in.glb", scene.glb())
            self.bake("in.glb", "out.glb", "--no-draco", "--scene-linear", "--quality", "draft", "--method", "hybrid",
                      "--report", "report.json")
            with open(self.path("report.json")) as f:
                self.assertTrue(json.load(f)["solver"]["rows_closed"])
            out = Asset(self.path("out.glb"))
            primitive = out.json["meshes"][1]["primitives"][0]
            places, values = (out.values(primitive["attributes"][name]) for name in ("POSITION", "_RADIOSITY"))
            corners = [i[0] for i in out.values(primitive["indices"])]
            area = light = 0.0
            for t in zip(corners[::3], corners[1::3], corners[2::3]):
                if min(places[i][1] for i in t) > 0.499:
                    (ax, _, az), (bx, _, bz), (cx, _, cz) = (places[i] for i in t)
                    size = abs((bx - ax) * (cz - az) - (bz - az) * (cx - ax))
                    area, light = area + size, light + size * sum(values[i][0] for i in t) / 3
            tops.append(light / area)
        print(f"top of the box, with a card of holes: {tops[1] / tops[0]:.4f} of without")
        self.assertAlmostEqual(tops[1] / tops[0], 1, delta=0.01)

    def test_factor_cutoff_transform_and_vertex_alpha_decide_too(self):
        free = self.wall(Yard())
        half = picture(lambda y, x: 255 if x < 8 else 100)
        for material, share in ((masked(**TEXTURED), 0.5), (dict(masked(**TEXTURED), alphaCutoff=0.3), 0),
                                (masked(alpha=0.4, **TEXTURED), 1), (dict(masked(), alphaCutoff=1.1), 1), (masked(), 0),
                                (masked(alpha=0.4), 1)):
            self.assertAlmostEqual(self.wall(Yard(material, scale=1).add_image(half)) / free, share, delta=0.02,
                                   msg=material)
        wide = {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}}}
        left = self.wall(Yard(masked(**TEXTURED), uv=((0, 0), (1, 0), (1, 1), (0, 1))).add_image(half))
        sides = self.sides()
        moved = self.wall(Yard(masked(**wide)).add_image(half))
        self.assertAlmostEqual(left, moved, delta=0.02 * free)
        self.assertGreater(sides[1], 3 * sides[0])
        self.assertGreater(self.sides()[0], 3 * self.sides()[1])
        fading = Yard(masked(), colors=[[1, 1, 1, 0], [1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 0]])
        self.assertAlmostEqual(self.wall(fading), left, delta=0.02 * free)
        self.assertGreater(self.sides()[0], 3 * self.sides()[1])
        # And they go on deciding in what is written.
        attributes = self.out.json["meshes"][2]["primitives"][0]["attributes"]
        places, colors = (self.out.values(attributes[name]) for name in ("POSITION", "COLOR_0"))
        for (x, _, _), color in zip(places, colors):
            self.assertAlmostEqual(color[3], (x + 4) / 8, delta=1e-4)

    def sides(self):
        """Mean radiance of the wall's vertices left and right of the middle."""
        both = [[v for (x, _, _), v in zip(self.places, self.values) if sign * x > 0.1] for sign in (-1, 1)]
        return [sum(values) / len(values) for values in both]

    def test_without_coordinates_or_picture_texels_count_as_opaque(self):
        free = self.wall(Yard())
        holes = picture(lambda y, x: 0)
        for scene in (Yard(masked(**TEXTURED), uv=None).add_image(holes), Yard(masked(), uv=UV),
                      Yard(masked(**TEXTURED)).add_image(b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(64))):
            self.assertLess(self.wall(scene) / free, 0.02)
        self.assertIn("images[0] cannot be read", self.ran.stderr)


if __name__ == "__main__":
    main()
