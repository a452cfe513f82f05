# SPDX-License-Identifier: MIT
"""What do blended, transmissive and diffusely transmitting surfaces leave of the light, and what is shown of them?"""

import json
import math
import os
import unittest

from command import ROOT, CommandCase, main
from gltf_file import FLOAT, Asset, Scene, box, png, sphere

FIELD = os.path.join(os.path.dirname(ROOT), "shared", "field")
STRAIGHT, DIFFUSE = "KHR_materials_transmission", "KHR_materials_diffuse_transmission"

# Straight down onto what faces up: 1000 lux.
SUN = ("--sun", "0,90,1000,0")
RHO = 0.8


def pbr(factor=(1, 1, 1, 1), **more):
    return {"name": "m", "pbrMetallicRoughness": {"baseColorFactor": list(factor), "metallicFactor": 0}, **more}


def straight(color, factor=1.0, **more):
    return pbr([*color, 1], extensions={STRAIGHT: {"transmissionFactor": factor, **more}})


def diffuse(factor, color=(1, 1, 1), base=(0, 0, 0)):
    return pbr([*base, 1], extensions={DIFFUSE: {"diffuseTransmissionFactor": factor, "diffuseTransmissionColorFactor": list(color)}})


def plate(y, half=2.0):
    """Faces up."""
    return [[-half, y, -half], [-half, y, half], [half, y, half], [half, y, -half]], [(0, 1, 2), (0, 2, 3)]


class Yard(Scene):
    """A floor of 1 m, and over it what a test puts there."""

    def __init__(self):
        super().__init__()
        self.add_mesh("floor", plate(0, 0.5), self.add_material("floor", (RHO,) * 3))

    def add(self, name, mesh, material, uv=None, colors=None):
        self.json["materials"].append(material)
        self.json["extensionsUsed"] = sorted({*self.json.get("extensionsUsed", ()), *material.get("extensions", ())})
        self.add_mesh(name, mesh, len(self.json["materials"]) - 1)
        attributes = self.json["meshes"][-1]["primitives"][0]["attributes"]
        if uv:
            attributes["TEXCOORD_0"] = self._add_accessor([list(p) for p in uv], "VEC2", FLOAT)
        if colors:
            attributes["COLOR_0"] = self._add_accessor([list(c) for c in colors], "VEC4", FLOAT)
        if not self.json["extensionsUsed"]:
            del self.json["extensionsUsed"]
        return self


def add_light(scene, height, light, rotation=(0, 0, 0, 1)):
    scene.json["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
    scene.json["nodes"].append({"name": "light", "translation": [0, height, 0], "rotation": list(rotation),
                                "extensions": {"KHR_lights_punctual": {"light": 0}}})
    scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)
    scene.json["extensionsUsed"] = sorted({*scene.json.get("extensionsUsed", ()), "KHR_lights_punctual"})
    return scene


def mean(asset, name, up=None):
    """Radiance of a node by area; of the triangles that face up or down alone."""
    node = next(n for n in asset.json["nodes"] if n.get("name") == name)
    sums, area = [0.0] * 3, 0.0
    for primitive in asset.json["meshes"][node["mesh"]]["primitives"]:
        places, values = (asset.values(primitive["attributes"][a]) for a in ("POSITION", "_RADIOSITY"))
        flat = [i if isinstance(i, int) else i[0] for i in asset.values(primitive["indices"])]
        for t in range(0, len(flat), 3):
            p, own = [places[i] for i in flat[t:t + 3]], 0.0
            u, v = ([p[j][k] - p[0][k] for k in range(3)] for j in (1, 2))
            normal = [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]
            own = math.sqrt(sum(n * n for n in normal)) / 2
            if up is not None and (normal[1] > 0) != up:
                continue
            area += own
            for c in range(3):
                sums[c] += own * sum(values[i][c] for i in flat[t:t + 3]) / 3
    return [s / area for s in sums]


class Glass(CommandCase):
    def light(self, scene, *options, quality="draft"):
        """The baked asset."""
        if isinstance(scene, Scene):
            scene = self.write("in.glb", scene.glb())
        self.ran = self.bake(scene, "out.glb", "--no-draco", "--scene-linear", "--quality", quality, "--report", "report.json", *options)
        return Asset(self.path("out.glb"))

    def check(self, found, right, share=0.01):
        for a, b in zip(found, right):
            self.assertAlmostEqual(a, b, delta=share * max(right), msg=(found, right))

    def check_books(self):
        """What passes a pane arrives once. Rows gather by rays: by a percent."""
        self.assertLess(json.loads(self.read("report.json"))["energy"]["residual_fraction"], 0.01)

    def floor(self, scene, *options):
        return mean(self.light(scene, *options), "floor")

    # ---- straight through ----

    def test_panes_multiply_and_so_do_their_tints(self):
        tints = (0.9, 0.5, 0.2), (0.5, 1.0, 0.5)
        both = [a * b for a, b in zip(*tints)]
        scene = Yard().add("low", plate(0.5), straight(tints[0])).add("high", plate(1.0), straight(tints[1]))
        sunlit = RHO * 1000 / math.pi
        self.check(self.floor(scene, *SUN), [sunlit * t for t in both])
        # Every ray to the sky passes both, but those below their rims; beside the free floor.
        free, sky = self.floor(Yard(), "--environment", "1,1,1"), ("--environment", "1,1,1")
        wide = Yard().add("low", plate(0.01), straight(tints[0])).add("high", plate(0.02), straight(tints[1]))
        self.check(self.floor(wide, *sky), [f * t for f, t in zip(free, both)], 0.02)
        self.check_books()
        # A lamp above them.
        lamp = ([[-0.2, 2, -0.2], [0.2, 2, -0.2], [0.2, 2, 0.2], [-0.2, 2, 0.2]], [(0, 1, 2), (0, 2, 3)])
        glow = pbr((0, 0, 0, 1), emissiveFactor=[1, 1, 1])
        free = self.floor(Yard().add("lamp", lamp, glow))
        self.check(self.floor(scene.add("lamp", lamp, glow)), [f * t for f, t in zip(free, both)])
        self.check_books()
        self.assertEqual(json.loads(self.read("report.json"))["solver"]["method"], "rows")
        # Kept rows book it as others do, at once and lit anew.
        for emission in ("1", "2"):
            self.light(scene, "--rows", "glass.rows", "--emissive-scale", emission)
            self.check_books()

    def test_columns_know_straight_panes_and_say_what_they_leave_out(self):
        tint = (0.9, 0.5, 0.2)
        scene = Yard().add("pane", plate(0.5), straight(tint))
        self.check(self.floor(scene, *SUN, "--method", "hybrid"), [RHO * 1000 / math.pi * t for t in tint])
        self.assertEqual(self.ran.stderr.count("surfaces let light through, which rows solve"), 1)

    def test_glass_with_two_faces_and_a_picture(self):
        left = png(16, 16, lambda y, x: (255, 0, 0) if x < 8 else (0, 0, 0))
        scene = Yard().add("box", box((-2, 0.5, -2), (2, 0.6, 2)), straight((0.5, 0.8, 1), 0.5))
        # A quarter in blue straight through both faces; the single-sided faces reflect the other half up, so that only
        # what the floor and the lower face exchange comes to that.
        found = self.floor(scene, *SUN)
        for value, tint in zip(found, (0.5, 0.8, 1)):
            through = RHO * 1000 / math.pi * (0.5 * tint) ** 2
            self.assertGreater(value, 0.99 * through)
            self.assertLess(value, through / (1 - RHO * 0.5 * tint))
        scene = Yard().add("pane", plate(0.5, 0.5), straight((1, 1, 1), 1, transmissionTexture={"index": 0}),
                           uv=((0, 0), (0, 1), (1, 1), (1, 0))).add_image(left)
        baked = self.light(scene, *SUN)
        primitive = baked.json["meshes"][0]["primitives"][0]
        for p, v in zip(*(baked.values(primitive["attributes"][a]) for a in ("POSITION", "_RADIOSITY"))):
            if abs(p[0]) > 0.2:
                right = RHO * 1000 / math.pi if p[0] < 0 else 0
                self.assertAlmostEqual(v[0], right, delta=0.15 * RHO * 1000 / math.pi, msg=p)

    def test_a_point_light_shines_through_a_tint(self):
        def lit(scene):
            return self.floor(add_light(scene, 2, {"type": "point", "intensity": 10}))
        free = lit(Yard())
        self.check(lit(Yard().add("pane", plate(1), straight((0.3, 0.6, 0.9)))), [f * t for f, t in zip(free, (0.3, 0.6, 0.9))])

    def test_reflected_light_passes_too(self):
        """From a floor that a spot lights, through a pane, to a ceiling that nothing else lights."""
        def ceiling(tint):
            scene = Yard()
            scene.add_mesh("ceiling", ([[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]], [(0, 1, 2), (0, 2, 3)]),
                           scene.add_material("ceiling", (0.5,) * 3))
            if tint:
                scene.add("pane", plate(0.5, 2), straight(tint))
            return mean(self.light(add_light(scene, 0.4, {"type": "spot", "intensity": 10, "spot": {"outerConeAngle": 0.8}},
                                             [-math.sqrt(0.5), 0, 0, math.sqrt(0.5)]), "--method", "rows"), "ceiling")
        free, tints = ceiling(None), (0.9, 0.5, 0.1)
        self.check(ceiling(tints), [f * t for f, t in zip(free, tints)], 0.04)

    def test_the_edge_of_the_sun_is_as_fine_behind_glass(self):
        """A roof shades half of a floor: where its shadow ends elements are split, whether the sun passes a pane or not."""
        tint = 0.9, 0.5, 0.2

        def edge(panes):
            scene = Yard()
            scene.add_mesh("roof", ([[0.03, 1, -1], [0.03, 1, 1], [1, 1, 1], [1, 1, -1]], [(0, 1, 2), (0, 2, 3)]),
                           scene.add_material("roof", (0, 0, 0)))
            if panes:
                scene.add("pane", plate(0.05), straight(tint))
            baked = self.light(scene, *SUN, "--environment", "30,30,30")
            node = next(n for n in baked.json["nodes"] if n.get("name") == "floor")
            attributes = baked.json["meshes"][node["mesh"]]["primitives"][0]["attributes"]
            places, values = (baked.values(attributes[a]) for a in ("POSITION", "_RADIOSITY"))
            sides = [[v for p, v in zip(places, values) if low < p[0] < high] for low, high in ((-0.3, 0.0), (0.06, 0.3))]
            lit, dark = ([sum(v[c] for v in side) / len(side) for c in range(3)] for side in sides)
            share = [(p[0], (v[0] - dark[0]) / (lit[0] - dark[0])) for p, v in zip(places, values)]
            return min(x for x, s in share if s < 0.25) - max(x for x, s in share if s > 0.75), lit, dark
        # Panes have area, too, by which elements are larger.
        (free, lit, dark), (found, *tinted) = edge(panes=False), edge(panes=True)
        self.assertLess(free, 0.02)
        self.assertLess(found, 0.02)
        # Parts of elements get the sky through the pane, as the sun.
        for bare, through in zip((lit, dark), tinted):
            self.check(through, [b * t for b, t in zip(bare, tint)], 0.05)

    # ---- alpha ----

    def test_blended_surfaces_cover_by_their_alpha(self):
        sunlit = RHO * 1000 / math.pi
        picture = png(16, 16, lambda y, x: (255, 255, 255, 255 if x < 8 else 51), channels=4)
        uv = ((0, 0), (0, 1), (1, 1), (1, 0))
        veil = pbr((0, 0, 0, 0.3), alphaMode="BLEND")
        self.check(self.floor(Yard().add("veil", plate(0.5), veil), *SUN), [0.7 * sunlit] * 3)
        shades = Yard().add("veil", plate(0.5, 0.5), pbr((0, 0, 0, 0.5), alphaMode="BLEND"), uv=uv,
                            colors=[[1, 1, 1, 0.8]] * 4)
        self.check(self.floor(shades, *SUN), [0.6 * sunlit] * 3)
        textured = pbr((0, 0, 0, 0.5), alphaMode="BLEND")
        textured["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        baked = self.light(Yard().add("veil", plate(0.5, 0.5), textured, uv=uv).add_image(picture), *SUN)
        primitive = baked.json["meshes"][0]["primitives"][0]
        for p, v in zip(*(baked.values(primitive["attributes"][a]) for a in ("POSITION", "_RADIOSITY"))):
            if abs(p[0]) > 0.2:
                self.assertAlmostEqual(v[0] / sunlit, 0.5 if p[0] < 0 else 0.9, delta=0.05, msg=p)

    def test_blended_surfaces_keep_their_look_and_get_their_light(self):
        veil = Yard().add("veil", plate(0.5), pbr((0.4, 0.4, 0.4, 0.25), alphaMode="BLEND"))
        baked = self.light(veil, "--sun", "0,90,1,0")
        # A quarter reflects 0.4 of 1 lux; the viewer blends by that quarter, so colours are of what is covered.
        self.check(mean(baked, "veil"), [0.25 * 0.4 / math.pi] * 3, 0.05)
        primitive = baked.json["meshes"][1]["primitives"][0]
        material = baked.json["materials"][primitive["material"]]
        self.assertEqual((material["alphaMode"], material["pbrMetallicRoughness"]["baseColorFactor"][3]), ("BLEND", 0.25))
        self.assertEqual(set(material["extensions"]), {"KHR_materials_unlit"})
        for color in baked.values(primitive["attributes"]["COLOR_0"]):
            self.assertAlmostEqual(color[0], 0.4 / math.pi, delta=0.05 * 0.4 / math.pi)
        glass = Yard().add("glass", plate(0.5), straight((0.8, 0.4, 0.4), 1))
        baked = self.light(glass, "--sun", "0,90,1,0")
        material = baked.json["materials"][baked.json["meshes"][1]["primitives"][0]["material"]]
        # It leaves 0.4 of what is behind it in all bands, and shows what it leaves more of red.
        self.assertAlmostEqual(material["pbrMetallicRoughness"]["baseColorFactor"][3], 0.6, delta=1e-6)
        self.assertEqual(material["alphaMode"], "BLEND")
        color = baked.values(baked.json["meshes"][1]["primitives"][0]["attributes"]["COLOR_0"])[0]
        self.assertGreater(color[0], 2 * color[1])

    # ---- diffusely ----

    def test_a_curtain_glows_on_the_other_side(self):
        baked = self.light(Yard().add("curtain", plate(0.5), diffuse(0.6, (1, 0.5, 0.25), (0.2, 0.2, 0.2))), *SUN)
        below = [0.6 * c * 1000 / math.pi for c in (1, 0.5, 0.25)]
        # The floor, which is dim, adds a little to both.
        self.check(mean(baked, "curtain", False), below, 0.03)
        above, own = mean(baked, "curtain", True), 0.4 * 0.2 * 1000 / math.pi
        self.check(above[2:], [own], 0.03)
        self.assertGreater(above[0], own)
        self.assertLess(above[0], own + 0.05 * below[0])
        # The floor gets what the other side shines.
        floor = mean(baked, "floor")
        self.assertGreater(floor[0], 0.7 * RHO * below[0])
        self.assertLess(floor[0], RHO * below[0] * 1.05)

    def room_with_bulb(self, shade):
        scene = Scene()
        scene.add_mesh("room", box((-1, 0, -1), (1, 2, 1), inward=True), scene.add_material("walls", (0.7,) * 3))
        scene.add_mesh("bulb", box((-0.05, 0.95, -0.05), (0.05, 1.05, 0.05)), scene.add_material("bulb", (0, 0, 0), (1, 1, 1)))
        if shade:
            scene.json["materials"].append(shade)
            scene.json["extensionsUsed"] = list(shade["extensions"])
            scene.add_mesh("globe", sphere(12, (0, 1, 0), 0.3, 6), 2)
        return mean(self.light(scene), "room")

    def test_a_frosted_globe_gives_the_room_what_its_bulb_gives(self):
        bare = self.room_with_bulb(None)
        self.check(self.room_with_bulb(diffuse(1.0)), bare, 0.1)
        self.check_books()
        self.check(self.room_with_bulb(straight((1, 1, 1))), bare, 0.05)
        self.check_books()

    # ---- cases from the field ----

    def field(self, name, *options):
        path = os.path.join(FIELD, name + ".glb")
        if not os.path.exists(path):
            raise unittest.SkipTest("no ../shared/field beside the checkout")
        return self.light(path, *options)

    def test_walls_that_are_marked_as_blended_are_walls(self):
        opaque, blended = (self.field(name) for name in ("walls-opaque", "walls-blend-alpha-1"))
        for name in ("room", "ends", "blk"):
            self.check(mean(blended, name), mean(opaque, name), 1e-4)

    def test_a_clear_pane_is_as_an_open_window(self):
        sun = "--sun", "0,45,100000"
        self.check(mean(self.field("window-transmission", *sun), "room"), mean(self.field("window-open", *sun), "room"), 0.05)

    def test_a_bulb_in_a_glass_shade_is_as_bare(self):
        self.check(mean(self.field("bulb-in-shade"), "room"), mean(self.field("bulb-bare"), "room"), 0.1)


if __name__ == "__main__":
    main()
