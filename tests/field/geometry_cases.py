# SPDX-License-Identifier: MIT
"""Is light where geometry lets it be: sealed rooms, contact lines, windows, slivers, trees?"""

import math

from baked import dot
from rows import SKY, at_most, case, ends, near, ratio


# ---- what is sealed stays dark -------------------------------------------------------------------------------------------

@case(fast=True)
def sealed_under_sky(bench):
    bake = bench.bake("sealed-under-sky.glb", *SKY)
    yield ends(bake)
    if bake.asset:
        yield at_most("inside of the cube / outbox", ratio(bake.mean("cube"), bake.mean("outbox")), 0.001)
        yield at_most("inbox / outbox", ratio(bake.mean("inbox"), bake.mean("outbox")), 0.001)


@case(fast=True)
def house_on_ground(bench):
    bake = bench.bake("house-on-ground.glb", *SKY)
    yield ends(bake)
    if bake.asset:
        def ground(points):
            values = [bake.at("ground", (x, 0, z), (0, 1, 0)) for x, z in points]
            return sum(v[0] for v in values) / len(values)

        steps = [-1.9 + 3.8 * i / 12 for i in range(13)]
        outside = ground([(s * 1.5, z) for s in steps for z in (-4.5, -3, 3, 4.5)])
        yield at_most("block / outside", ratio(bake.mean("in"), outside), 0.001)
        yield at_most("ground within / outside", ground([(x, z) for x in steps for z in steps]) / outside, 0.001)


@case(fast=True)
def two_skins(bench):
    bake, one = bench.bake("two-skins.glb"), bench.bake("rug-none.glb")
    yield ends(bake)
    if bake.asset and one.asset:
        def inward(t):
            return dot(t.normal, [(0, 1, 0)[k] - t.corners[0][k] for k in range(3)]) > 0

        yield near("inside", bake.mean("room", inward), one.mean("room"), 0.003)
        yield at_most("backs", bake.mean("room", lambda t: not inward(t)), 1e-6)


# ---- contact lines -------------------------------------------------------------------------------------------------------

def room_points():
    """A grid on the room's six faces: (point, normal, node that shows there)."""
    steps = [-0.97 + 1.94 * i / 14 for i in range(15)]
    for a in steps:
        for b in steps:
            yield (a, 0, b), (0, 1, 0), "rug" if max(abs(a), abs(b)) < 0.6 else "room"
            yield (a, 2, b), (0, -1, 0), "room"
            yield (a, 1 + b, -1), (0, 0, 1), "pic" if abs(a) < 0.4 and -0.2 < b < 0.4 else "room"
            yield (a, 1 + b, 1), (0, 0, -1), "room"
            yield (-1, 1 + a, b), (1, 0, 0), "room"
            yield (1, 1 + a, b), (-1, 0, 0), "room"


def seen_mean(bake):
    """Mean radiance of what shows of the room, its rug and its picture, whichever lies on top."""
    values = []
    for point, normal, node in room_points():
        value = bake.at(node if node in bake.nodes() else "room", point, normal)
        if value is None:
            return None
        values.append(sum(value) / 3)
    return sum(values) / len(values)


def rug(bench, name):
    bake, none = bench.bake(name), bench.bake("rug-none.glb")
    yield ends(bake)
    if bake.asset and none.asset:
        yield near("mean of what shows", seen_mean(bake), seen_mean(none), 0.01)
        yield at_most("elements / without", bake.report["scene"]["elements"] / none.report["scene"]["elements"], 1.5)
        # 0.3 s: what another program on the machine may take away from a bake of half a second.
        yield at_most("time / without", bake.processor_s / (none.processor_s + 0.3), 2)


@case()
def rug_0mm(bench):
    yield from rug(bench, "rug-0mm.glb")


@case(fast=True)
def rug_tenth_mm(bench):
    yield from rug(bench, "rug-tenth-mm.glb")


@case()
def window_bar(bench):
    bake = bench.bake("window-bar.glb", *SKY)
    yield ends(bake)
    if bake.asset:
        for z, red in ((-0.245, 0.579), (-0.21, 0.654), (-0.10, 0.252), (-0.01, 0.335)):
            value = bake.at("window wall reveal 0", (2.335, 0.9, z), (0, 1, 0))
            yield near(f"sill at z {z}", value and value[0], red, 0.05)


# ---- windows under sky ---------------------------------------------------------------------------------------------------

def window_factor(x, z, width, low, high):
    """Form factor of a window in z = 0, centred at x = 0, from a point (x, 0, z) of a floor that looks up. Sum over corners,
    in each the integral of cos cos / pi r^2 from the foot of the point. [Howell82, configurations of a plane element]"""
    def corner(a, b):
        # Looking up from the floor: the part of the window from height 0 to b, from x to x + a.
        lean = 1 / math.sqrt(b * b + z * z)
        return (math.atan(a / z) - z * lean * math.atan(a * lean)) / (2 * math.pi)

    left, right = -width / 2 - x, width / 2 - x
    return corner(right, high) - corner(left, high) - corner(right, low) + corner(left, low)


def window_sky(bench, name, width, low, high):
    bake = bench.bake(name, *SKY)
    yield ends(bake)
    if bake.asset:
        errors, squares = 0, 0
        for i in range(25):
            for j in range(25):
                x, z = -2.4 + 4.8 * i / 24, 0.15 + 3.7 * j / 24
                F = window_factor(x, z, width, low, high)
                value = bake.at("floor", (x, 0, z), (0, 1, 0))
                errors += ((value[0] if value else 0) - 0.5 * F) ** 2
                squares += (0.5 * F) ** 2
        yield at_most("rms / rms", math.sqrt(errors / squares), 0.05 if bench.quality == "draft" else 0.02)


@case()
def window_sky_1200mm(bench):
    yield from window_sky(bench, "window-sky-1200mm.glb", 1.2, 0.9, 2.1)


@case()
def window_sky_200mm(bench):
    yield from window_sky(bench, "window-sky-200mm.glb", 0.2, 1.5, 1.7)


# ---- many and thin -------------------------------------------------------------------------------------------------------

def slivers(bench, name):
    bake = bench.bake(name)
    yield ends(bake)
    if bake.asset and bench.quality == "draft":
        # Three seconds on two cores.
        yield at_most("processor seconds", bake.processor_s, 6.0)


@case()
def slivers_hole_512(bench):
    yield from slivers(bench, "slivers-hole-512.glb")


@case()
def slivers_tube_512(bench):
    yield from slivers(bench, "slivers-tube-512.glb")


def trees(bench, name):
    bake = bench.bake(name, "--sun", "150,40,80000")
    yield ends(bake)
    if bake.asset:
        # Twenty seconds on two cores.
        yield at_most("processor seconds", bake.processor_s, 40.0)
        yield "trees are lit", "yes", f"{bake.mean('trees')}", (bake.mean("trees") or 0) > 0


@case(only=("draft",))
def trees_250_masked(bench):
    yield from trees(bench, "trees-250-masked.glb")


@case(only=("draft",))
def trees_400_opaque(bench):
    yield from trees(bench, "trees-400-opaque.glb")
