# SPDX-License-Identifier: MIT
"""Do materials, lights and what assets switch come out as the format means them?"""

import math
import os

from baked import pixels
from rows import at_most, case, ends, holds, near, ratio


# ---- materials -----------------------------------------------------------------------------------------------------------

def as_grey(bench, name, grey):
    """The case against itself with a material that is plainly that grey."""
    def paint(tree):
        tree["materials"][0]["pbrMetallicRoughness"] = {"baseColorFactor": [grey, grey, grey, 1], "metallicFactor": 0}
        tree["meshes"][0]["primitives"][0]["material"] = 0

    bake, plain = bench.bake(name), bench.bake(bench.made("grey-" + name, name, paint))
    yield ends(bake)
    if bake.asset:
        yield near(f"room as of reflectance {grey}", bake.mean("room"), plain.mean("room"), 0.005)


@case()
def no_material(bench):
    yield from as_grey(bench, "no-material.glb", 0.5)


@case()
def metallic_absent(bench):
    yield from as_grey(bench, "metallic-absent.glb", 0.35)


@case()
def texture_ktx2(bench):
    """A colour in a form that cannot be read (as PlayCanvas writes it): the factor alone counts."""
    def texture(tree):
        tree["images"] = [{"mimeType": "image/ktx2", "uri": "data:image/ktx2;base64,q0tUWCAyMLsNChoK"}]
        tree["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
        tree["extensionsUsed"] = ["KHR_texture_basisu"]
        tree["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        tree["materials"][0]["pbrMetallicRoughness"].pop("metallicFactor")

    bake, plain = bench.bake(bench.made("ktx2.glb", "rug-none.glb", texture)), bench.bake("rug-none.glb")
    yield ends(bake)
    if bake.asset:
        yield near("room as by its factor", bake.mean("room"), plain.mean("room"), 0.005)
        yield holds("a line names the texture", bake.line("KTX2") or bake.line("texture", "read"))


@case()
def walls_blend_alpha_1(bench):
    bake, plain = bench.bake("walls-blend-alpha-1.glb"), bench.bake("walls-opaque.glb")
    yield ends(bake)
    if bake.asset:
        yield near("block", bake.mean("blk"), plain.mean("blk"), 0.001)
        yield near("walls", bake.mean("room"), plain.mean("room"), 0.001)


@case()
def window_transmission(bench):
    sun = ("--sun", "0,45,100000")
    bake, plain = bench.bake("window-transmission.glb", *sun), bench.bake("window-open.glb", *sun)
    yield ends(bake)
    if bake.asset:
        yield near("room", bake.mean("room"), plain.mean("room"), 0.05)


@case()
def bulb_in_shade(bench):
    bake, plain = bench.bake("bulb-in-shade.glb"), bench.bake("bulb-bare.glb")
    yield ends(bake)
    if bake.asset:
        yield near("room", bake.mean("room"), plain.mean("room"), 0.1)


@case(fast=True)
def black_color0(bench):
    bake = bench.bake("black-color0.glb")
    yield ends(bake)
    yield holds("black", bake.asset and bake.mean("room") == 0)
    yield holds("a line names the mesh", bake.line("black", "room"))


@case()
def variants(bench):
    bake = bench.bake("variants.glb")
    yield ends(bake)
    if bake.asset:
        found = [m for p in bake.asset.primitives("sofa")
                 for m in p.get("extensions", {}).get("KHR_materials_variants", {}).get("mappings", [])]
        looks = sorted(v for m in found for v in m["variants"])
        materials = {m["material"] for m in found}
        unlit = all("KHR_materials_unlit" in bake.asset.json["materials"][m].get("extensions", {}) for m in materials)
        yield "looks that are mapped", "[0, 1]", show_list(sorted(set(looks))), sorted(set(looks)) == [0, 1]
        yield holds("each look has its baked material", len(materials) == 2 and unlit)


def show_list(values):
    return str(list(values))


# ---- emission ------------------------------------------------------------------------------------------------------------

def visible(bench, name):
    """The preview's median over pixels that the sky does not fill, from 0 to 255."""
    path = os.path.join(bench.folder, name + ".png")
    bake = bench.bake(name, "--preview", path, linear=False)
    if not bake.asset or not os.path.exists(path):
        return bake, None
    _, _, rows, step = pixels(path)
    corner = rows[0][:3]
    shown = sorted(max(row[i:i + 3]) for row in rows for i in range(0, len(row), step) if row[i:i + 3] != corner)
    return bake, shown[len(shown) // 2] if shown else None


@case()
def emissive_atlas_spot(bench):
    bake = bench.bake("emissive-atlas-spot.glb")
    yield ends(bake)
    if bake.asset:
        # Closed form, since every face is as good as every other: M / (pi (1 - rho)) over 24 m2, of a spot of 16 texels of 64 x 64 on 4 m2.
        yield near("mean red of the room", bake.mean("room", band=0), 16 / 4096 * 4 / 24 / 0.3, 0.02)
        # The mean is right to 0.1 %; what is left is the edge of the spot, inside of one element.
        yield at_most("estimate", bake.report["error"]["estimate"], 0.5)
    shown, median = visible(bench, "emissive-atlas-spot.glb")
    yield "median of the picture", "18 to 178", str(median), median is not None and 18 <= median <= 178
    if shown.asset:
        yield at_most("|EV|", abs(shown.report["color"]["exposure_ev"]), 20)


@case(fast=True)
def emissive_atlas_black(bench):
    bake = bench.bake("emissive-atlas-black.glb")
    yield holds("refused, or done", bake.code in (0, 1), bake.code)
    yield holds("a line says that the texture is black", bake.line("black", "textur") or bake.line("black", "emissi"))
    yield holds("no advice to turn faces", "turn" not in bake.text.lower())


@case(fast=True)
def closed_no_lamp(bench):
    bake = bench.bake("closed-no-lamp.glb")
    yield ends(bake)
    yield holds("a line says that no light gets in", bake.line("no light", "camera"))


# ---- lights --------------------------------------------------------------------------------------------------------------

@case()
def ies_only(bench):
    bake = bench.bake("ies-only.glb")
    yield ends(bake)
    if bake.asset:
        centre, side = bake.at("room", (0, 0, 0), (0, 1, 0)), bake.at("room", (2, 2.9, 0), (-1, 0, 0))
        yield holds("the floor below is lit", centre and centre[0] > 0)
        yield holds("and brighter than the wall beside the light", centre and side and centre[0] > 2 * side[0])


@case()
def spot_equal_cones(bench):
    bake = bench.bake("spot-equal-cones.glb")
    yield ends(bake)
    if bake.asset:
        # 100 cd from 2 m: 25 lx, and lights in candela give nits.
        middle, beside = bake.at("floor", (0, 0, 0)), bake.at("floor", (0.5, 0, 0))
        yield near("in the cone", middle and middle[0], 0.5 * 25 / math.pi, 0.05)
        yield at_most("beside it / in it", ratio(beside[0], middle[0]), 1e-3)
        yield holds("a note", bake.line("cone"))


@case()
def smooth_ball_12x6(bench):
    bake = bench.bake("smooth-ball-12x6.glb")
    yield ends(bake)
    if bake.asset:
        # A few hundred at draft. What shows a smooth curve to within an error takes triangles as one over that error.
        yield at_most("triangles", bake.report["scene"]["triangles_out"], {"draft": 1000, "medium": 2000, "high": 2500}[bench.quality])
        # A facet at the equator, 30 degrees wide: within it the light of a smooth ball changes as between 117 and 130 of 255.
        spread = max((max(sum(c) for c in t.colors) / max(1e-9, min(sum(c) for c in t.colors)) for t in bake.nodes()["s"]
                      if min(sum(c) for c in t.colors) > 0.5 * max(sum(c) for u in bake.nodes()["s"] for c in u.colors)), default=0)
        yield holds("smooth within a facet", spread > 1.02, f"{spread:.3g} times")


# ---- what moves, hides and changes ---------------------------------------------------------------------------------------

def moving(bench, name):
    def still(tree):
        tree.pop("animations")

    bake, plain = bench.bake(name), bench.bake(bench.made("still-" + name, name, still))
    yield ends(bake)
    if bake.asset:
        yield near("block as if it stood", bake.mean("blk"), plain.mean("blk"), 0.001)
        yield near("room as if all stood", bake.mean("room"), plain.mean("room"), 0.001)
        yield "animations kept", "1", str(len(bake.asset.json.get("animations", []))), bool(bake.asset.json.get("animations"))


@case()
def animated_root(bench):
    yield from moving(bench, "animated-root.glb")


@case()
def animated_door(bench):
    yield from moving(bench, "animated-door.glb")


@case()
def node_hidden(bench):
    def require(tree):
        tree["extensionsRequired"] = ["KHR_node_visibility"]

    absent = bench.bake("node-absent.glb")
    for what, name in (("", "node-hidden.glb"), (", required", bench.made("required.glb", "node-hidden.glb", require))):
        bake = bench.bake(name)
        yield ends(bake)
        if bake.asset:
            yield near("room" + what, bake.mean("room"), absent.mean("room"), 0.001)


@case()
def lod(bench):
    bake = bench.bake("lod.glb")
    yield ends(bake)
    if bake.asset:
        for node in bake.asset.json["nodes"]:
            if node.get("name", "").startswith("chair"):
                light = [t.mean() for t in bake.mesh_triangles(node["mesh"])]
                yield holds(f"{node['name']} is lit", light and max(light) > 0)


@case()
def day_night(bench):
    def only(index):
        def change(tree):
            tree["scenes"] = [tree["scenes"][index]]
            tree["scene"] = 0
        return change

    for index, scene in enumerate(("day", "night")):
        bake = bench.bake("day-night.glb", "--scene", scene)
        alone = bench.bake(bench.made(f"{scene}-alone.glb", "day-night.glb", only(index)))
        yield ends(bake)
        if bake.asset and alone.asset:
            block = [t.mean() for name in bake.nodes() if (name or "").startswith("block") for t in bake.nodes()[name]]
            yield near(f"{scene}: block", sum(block) / max(1, len(block)) if block else None,
                       mean_of(alone.nodes()["block-shared"]), 0.001)
    bake = bench.bake("day-night.glb")
    yield holds("without --scene a line names the scene or the shared node", bake.line("scene", "day") or bake.line("block-shared"))


def mean_of(triangles):
    light = [t.mean() for t in triangles]
    return sum(light) / max(1, len(light))


# ---- packing -------------------------------------------------------------------------------------------------------------

@case()
def draco_counts(bench):
    """Blender's exporters of old wrote fewer points into accessor.count than Draco decodes."""
    packed = os.path.join(bench.folder, "packed.glb")
    if not os.path.exists(packed):
        bench.pack("rug-none.glb", packed)

    def lower(tree):
        for primitive in (p for m in tree["meshes"] for p in m["primitives"]):
            for index in primitive["attributes"].values():
                tree["accessors"][index]["count"] -= 2

    if not os.path.exists(packed):
        yield holds("a Draco file of ours", False)
        return
    bake = bench.bake(bench.made("fewer.glb", packed, lower))
    yield ends(bake)
    if bake.asset:
        yield near("room", bake.mean("room"), bench.bake("rug-none.glb").mean("room"), 0.01)
