# SPDX-License-Identifier: MIT
"""Which scenes are hard, and what is hard about each? Functions that build them; one is named as what it tries."""

import math
import random

from shapes import GREEN, GREY, RED, WHITE, Hard, box, ceiling, floor, joined, moved, quad, sphere

CASES = {}
SUN, SKY = "--sun", ("--environment", "1,1,1")


def case(function):
    CASES[function.__name__] = function
    return function


def two_rooms(scene):
    """Two rooms of 2 m that are open towards each other, a lamp in the near one; the case puts what parts them at x = 0. What is less
    than 20 cm behind that counts with the near one: the far one is judged by itself, and is not to be all seam."""
    for name, low, high, open_side in (("near", -2, 0.2, 1), ("far", 0.2, 2, 0)):
        positions, triangles = box((low, 0, -1), (high, 2, 1), inward=True)
        scene.put(name, (positions, [t for i, t in enumerate(triangles) if i // 2 != open_side]))
    return scene.ceiling_lamp(-1.1, 1.9, 0)


def lit_room(*options):
    """2 m wide, a lamp 10 cm under its ceiling."""
    return Hard(*options).room((-1, 0, -1), (1, 2, 1)).ceiling_lamp(0, 1.9, 0)


# ---- slots and gaps ------------------------------------------------------------------------------------------------------

@case
def slot_5mm():
    s = two_rooms(Hard())
    s.put("wall", box((-0.05, 0, -1), (0.05, 2, -0.0025)))
    return s.put("wall 2", box((-0.05, 0, 0.0025), (0.05, 2, 1)))


@case
def gap_10cm_beside_wall():
    return two_rooms(Hard()).put("wall", box((-0.05, 0, -1), (0.05, 2, 0.9)))


@case
def gap_1cm_under_door():
    return two_rooms(Hard()).put("door", box((-0.02, 0.01, -1), (0.02, 2, 1)))


@case
def keyhole_to_sky():
    def room(s):
        s.put("room", joined(floor(-1, -1, 1, 1), ceiling(-1, -1, 1, 1, 2), quad((-1, 0, 1), (-1, 2, 1), (1, 2, 1), (1, 0, 1)),
                             quad((-1, 0, -1), (-1, 2, -1), (-1, 2, 1), (-1, 0, 1)), quad((1, 0, 1), (1, 2, 1), (1, 2, -1), (1, 0, -1)),
                             quad((-1, 0, -1), (-0.03, 0, -1), (-0.03, 2, -1), (-1, 2, -1)), quad((0.03, 0, -1), (1, 0, -1), (1, 2, -1), (0.03, 2, -1)),
                             quad((-0.03, 0, -1), (0.03, 0, -1), (0.03, 0.95, -1), (-0.03, 0.95, -1)),
                             quad((-0.03, 1.05, -1), (0.03, 1.05, -1), (0.03, 2, -1), (-0.03, 2, -1))))
        return s
    s = room(Hard(*SKY))
    # A sky of one radiance behind a hole is a lamp of it in the hole.
    s.truth = room(Hard()).lamp(quad((-0.03, 0.95, -1), (0.03, 0.95, -1), (0.03, 1.05, -1), (-0.03, 1.05, -1)), 1.0)
    return s


@case
def blinds():
    s = lit_room()
    for i in range(20):
        s.put(f"slat {i}", moved(box((-0.98, -0.002, -0.04), (0.98, 0.002, 0.04)), (0, 0.1 + 0.07 * i, 0.4), (1, 0, 0), 40))
    return s


# ---- partitions, closets -------------------------------------------------------------------------------------------------

@case
def closet_in_lit_room():
    return lit_room().put("closet", box((0.3, 0, 0.3), (0.8, 1, 0.8))).put("dark", box((0.32, 0.02, 0.32), (0.78, 0.98, 0.78), inward=True))


@case
def partition_without_thickness():
    s = two_rooms(Hard())
    return s.put("wall", quad((0, 0, -1), (0, 2, -1), (0, 2, 0.3), (0, 0, 0.3)), double=True)


@case
def partition_1mm_seals_dark_room():
    s = two_rooms(Hard())
    return s.put("wall", box((-0.0005, -0.01, -1.01), (0.0005, 2.01, 1.01)), RED)


@case
def two_rooms_share_a_wall():
    s = Hard().room((-2, 0, -1), (0, 2, 1)).room((0.001, 0, -1), (2, 2, 1), name="dark")
    return s.ceiling_lamp(-1, 1.9, 0)


@case
def zigzag_corridor():
    s = Hard().room((-3, 0, -1), (3, 2, 1)).ceiling_lamp(-2.5, 1.9, 0)
    for i, x in enumerate((-1.5, 0.0, 1.5)):
        s.put(f"wall {i}", box((x - 0.05, 0, -1), (x + 0.05, 2, 0.5)) if i % 2 == 0 else box((x - 0.05, 0, -0.5), (x + 0.05, 2, 1)))
    return s


# ---- lamps ---------------------------------------------------------------------------------------------------------------

@case
def lamp_edge_1mm_from_wall():
    s = Hard().room((-1, 0, -1), (1, 2, 1))
    s.bright = (-1.01, 1.3, -0.5), (-0.9, 1.7, 0.5)
    return s.lamp(ceiling(-0.999, -0.3, -0.4, 0.3, 1.5))


@case
def lamp_back_1mm_from_wall():
    return Hard().room((-1, 0, -1), (1, 2, 1)).lamp(quad((-0.999, 0.7, -0.3), (-0.999, 1.3, -0.3), (-0.999, 1.3, 0.3), (-0.999, 0.7, 0.3)))


@case
def lamp_faces_wall_at_2cm():
    return Hard().room((-1, 0, -1), (1, 2, 1)).lamp(quad((-0.98, 0.7, 0.3), (-0.98, 1.3, 0.3), (-0.98, 1.3, -0.3), (-0.98, 0.7, -0.3)))


@case
def lamp_touches_ceiling():
    """A flat box of light whose top is the ceiling."""
    return Hard().room((-1, 0, -1), (1, 2, 1)).lamp(box((-0.1, 1.98, -0.2), (0.5, 2.0, 0.4)))


@case
def lamp_in_the_plane_of_its_ceiling():
    """Two fronts in one plane: what shines is seen. The truth has it a hair below."""
    s = Hard().room((-1, 0, -1), (1, 2, 1)).ceiling_lamp(0.2, 2.0, 0.1)
    s.truth = Hard().room((-1, 0, -1), (1, 2, 1)).ceiling_lamp(0.2, 1.9999, 0.1)
    s.leave_out = (-0.1, 1.99, -0.2), (0.5, 2.01, 0.4)
    return s


@case
def lamp_in_corner_touches_three_walls():
    return Hard().room((-1, 0, -1), (1, 2, 1)).lamp(quad((-1, 2, -0.6), (-0.6, 2, -1), (-1, 1.6, -1), (-1, 1.6, -1)))


@case
def hundred_lamps():
    s = Hard().room((-2, 0, -2), (2, 2.5, 2)).put("box", box((-0.4, 0, -0.3), (0.5, 0.8, 0.4)), RED)
    for i in range(100):
        s.ceiling_lamp(-1.8 + 0.4 * (i % 10), 2.45, -1.8 + 0.4 * (i // 10), 0.02, 20 + i, f"lamp {i}")
    return s


@case
def lamps_of_1_to_1000000():
    s = Hard().room((-1, 0, -1), (1, 2, 1)).ceiling_lamp(-0.5, 1.9, 0, 0.2, 1.0)
    return s.ceiling_lamp(0.5, 1.9, 0, 0.005, 1e6, "bright").put("box", box((-0.6, 0, -0.3), (-0.2, 0.6, 0.3)))


@case
def tube_lamp():
    s = Hard().room((-1, 0, -1), (1, 2, 1))
    return s.lamp(box((-0.7, 1.7, -0.01), (0.7, 1.72, 0.01)), 100.0).put("box", box((-0.4, 0, -0.3), (0.2, 0.6, 0.3)), GREEN)


@case
def lamp_in_open_shade():
    def side(radius, inward):
        n = 12
        ring = [(radius * math.cos(2 * math.pi * i / n), radius * math.sin(2 * math.pi * i / n)) for i in range(n)]
        positions = [[x, y, z] for y in (1.2, 1.5) for x, z in ring]
        triangles = [t for i in range(n) for t in ((i, n + i, n + (i + 1) % n), (i, n + (i + 1) % n, (i + 1) % n))]
        return positions, [t[::-1] for t in triangles] if inward else triangles
    s = Hard().room((-1, 0, -1), (1, 2, 1))
    s.put("shade", joined(side(0.2, False), side(0.199, True)))
    return s.lamp(box((-0.03, 1.32, -0.03), (0.03, 1.38, 0.03)), 200.0)


@case
def lamp_in_cove():
    s = Hard().room((-1, 0, -1), (1, 2, 1)).put("shelf", box((-1, 1.7, -1), (-0.8, 1.72, 1)))
    return s.put("lip", box((-0.82, 1.72, -1), (-0.8, 1.8, 1))).lamp(floor(-0.98, -0.9, -0.9, 0.9, 1.73), 50.0)


@case
def glowing_box_seen_from_inside():
    return Hard().put("ball", sphere(16, (0, 0.3, 0), 0.3)).put("floor", floor(-1, -1, 1, 1)).lamp(
        joined(ceiling(-1, -1, 1, 1, 2), quad((-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1))), 1.0)


# ---- small and large -----------------------------------------------------------------------------------------------------

def furnished(k):
    s = Hard().room((-k, 0, -k), (k, 2 * k, k)).ceiling_lamp(0, 1.9 * k, 0, 0.3 * k)
    return s.put("box", box((-0.5 * k, 0, -0.4 * k), (0.1 * k, 0.7 * k, 0.3 * k)), RED)


@case
def room_of_a_tenth_of_a_millimetre():
    return furnished(5e-5)


@case
def room_of_10_km():
    return furnished(5e3)


@case
def room_1000_km_away():
    s = furnished(1.0)
    s.away = (1e6, -1e6, 1e6)
    return s


@case
def needle():
    return lit_room().put("needle", box((0.2, 0, 0.2), (0.203, 1.2, 0.203)), RED)


@case
def sizes_1000_to_1():
    s = Hard().room((-10, 0, -10), (10, 5, 10)).ceiling_lamp(0, 4.9, 0, 1.0, 20.0)
    return s.put("cube", box((1, 0, 1), (1.02, 0.02, 1.02)), RED).put("box", box((-3, 0, -2), (-1, 2, 2)), GREEN)


@case
def huge_floor_tiny_lamp():
    """The wall is black: of light that it reflects no path in ten thousand would know."""
    s = Hard().put("floor", floor(-30, -30, 30, 30)).put("wall", box((0.3, 0, -0.5), (0.35, 0.5, 0.5)), (0, 0, 0))
    s.only = {"floor"}
    s.bright = (-0.6, -0.01, -0.6), (0.29, 0.01, 0.6)
    return s.ceiling_lamp(0, 0.2, 0, 0.015, 1000.0)


@case
def islands_100m_apart():
    s = Hard()
    for i, x in enumerate((-50.0, 50.0)):
        s.put(f"floor {i}", floor(x - 1, -1, x + 1, 1)).put(f"box {i}", box((x - 0.3, 0, -0.3), (x + 0.2, 0.5, 0.3)), RED)
        s.ceiling_lamp(x, 1.5, 0, 0.2, 10.0 * (i + 1), f"lamp {i}")
    return s


@case
def corridor_20_to_1():
    return Hard().room((-20, 0, -1), (20, 2, 1)).ceiling_lamp(-19, 1.9, 0)


# ---- contact -------------------------------------------------------------------------------------------------------------

@case
def sheets_a_tenth_mm_apart():
    s = lit_room().put("lower", floor(-0.5, -0.5, 0.5, 0.5, 0.0001), RED)
    return s.put("upper", floor(-0.3, -0.3, 0.6, 0.3, 0.0002), GREEN)


@case
def box_floats_1mm():
    return lit_room().put("box", box((-0.4, 0.001, -0.3), (0.2, 0.6, 0.3)), RED)


@case
def rug_in_the_floor():
    """Of two fronts in one plane the first is seen, so the rug changes nothing."""
    s = lit_room().put("rug", floor(-0.6, -0.4, 0.4, 0.5, 0.0), RED)
    s.truth, s.only = lit_room(), {"room"}
    return s


@case
def solids_cross():
    s = lit_room().put("box", moved(box((-0.5, -0.3, -0.2), (0.5, 0.3, 0.2)), (0, 0.5, 0), (0, 0.6, 0.8), 30), RED)
    return s.put("box 2", moved(box((-0.15, -0.5, -0.15), (0.15, 0.5, 0.15)), (0.1, 0.4, 0), (1, 0, 0), 25), GREEN)


@case
def sphere_in_a_corner():
    return lit_room().put("ball", sphere(24, (-0.6, 0.4, -0.6), 0.4))


@case
def sphere_through_a_box():
    return lit_room().put("ball", sphere(20, (0.1, 0.5, 0.1), 0.35), RED).put("box", box((-0.4, 0, -0.3), (0.2, 0.6, 0.2)))


@case
def cube_on_an_edge():
    half = 0.4 / math.sqrt(2)
    return lit_room().put("cube", moved(box((-0.2, -0.2, -0.2), (0.2, 0.2, 0.2)), (0, half, 0), (0, 0, 1), 45), RED)


@case
def stairs():
    s = Hard().room((-1, 0, -2), (1, 3, 2)).ceiling_lamp(0, 2.9, -1)
    for i in range(12):
        s.put(f"step {i}", box((-0.6, 0, -1.6 + 0.25 * i), (0.6, 0.17 * (i + 1), -1.35 + 0.25 * i)))
    return s


@case
def blades_that_cross():
    """Each through some dozens of others: what is cut along every line that one crosses another in is 40 times as many elements."""
    dice, blades = random.Random(1989), []
    for _ in range(800):
        x, z, turn = dice.uniform(-0.2, 0.2), dice.uniform(-0.2, 0.2), dice.uniform(0, math.pi)
        wide, lean = (0.015 * math.cos(turn), 0.015 * math.sin(turn)), (dice.uniform(-0.3, 0.3), dice.uniform(-0.3, 0.3))
        blades.append(quad((x - wide[0], 0, z - wide[1]), (x + wide[0], 0, z + wide[1]), (x + wide[0] + lean[0], 0.3, z + wide[1] + lean[1]),
                           (x - wide[0] + lean[0], 0.3, z - wide[1] + lean[1])))
    return lit_room().put("grass", joined(*blades), GREEN, double=True)


# ---- ill-formed meshes ---------------------------------------------------------------------------------------------------

@case
def degenerate_faces():
    positions, triangles = box((-0.4, 0, -0.3), (0.2, 0.6, 0.3))
    positions = positions + [[-0.1, 0.6, 0.0], [-0.1, 0.6, 0.0], [0.0, 0.6, 0.0]]
    return lit_room().put("box", (positions, triangles + [(0, 0, 1), (8, 9, 10), (8, 8, 8), (3, 3, 7)]), RED)


@case
def non_manifold_edges():
    sheets = [moved(quad((0, 0, -0.4), (0, 0, 0.4), (0.5, 0, 0.4), (0.5, 0, -0.4)), (0, 0.7, 0), (0, 0, 1), a) for a in (0, 80, 170, 260)]
    positions, triangles = joined(*sheets)
    return lit_room().put("fins", (positions, triangles), RED, double=True)


@case
def fan_of_slivers():
    n = 256
    ring = [[0.4 * math.cos(2 * math.pi * i / n), 0.8, 0.4 * math.sin(2 * math.pi * i / n)] for i in range(n)]
    return lit_room().put("disc", ([[0.1, 0.8, 0.0]] + ring, [(0, 1 + (i + 1) % n, 1 + i) for i in range(n)]), RED, double=True)


@case
def t_junctions():
    s = Hard().room((-1, 0, -1), (1, 2, 1)).ceiling_lamp(0, 1.9, 0)
    sheets = [floor(-0.5, -0.5, 0.1, 0.5, 0.5)] + [floor(0.1, -0.5 + 0.25 * i, 0.5, -0.25 + 0.25 * i, 0.5) for i in range(4)]
    return s.put("table", joined(*sheets), RED, double=True)


@case
def mirrored_node():
    s = lit_room().put("box", box((-0.25, 0, -0.3), (0.25, 1.2, 0.3)), RED)
    s.json["nodes"][-1].update(scale=[-1, 0.5, 1.3], translation=[0.3, 0, 0])
    return s


# ---- light ---------------------------------------------------------------------------------------------------------------

@case
def furnace_of_99_percent():
    return Hard().room((-1, 0, -1), (1, 2, 1), (0.99,) * 3).ceiling_lamp(0, 1.9, 0, 0.1, 10.0).put(
        "box", box((-0.4, 0, -0.3), (0.2, 0.6, 0.3)), (0.99,) * 3)


@case
def black_room():
    return Hard().room((-1, 0, -1), (1, 2, 1), (0.02,) * 3).ceiling_lamp(0, 1.9, 0).put("box", box((-0.4, 0, -0.3), (0.2, 0.6, 0.3)), (0.02,) * 3)


@case
def one_band_alone():
    s = Hard().room((-1, 0, -1), (1, 2, 1), (0.7, 0.0, 0.3)).put("box", box((-0.4, 0, -0.3), (0.2, 0.6, 0.3)), (0.0, 0.9, 0.5))
    return s.lamp(ceiling(-0.3, -0.3, 0.3, 0.3, 1.9), (10.0, 0.0, 0.0))


@case
def sun_at_the_horizon():
    s = Hard(SUN, "90,2,100000,0.533").put("ground", floor(-5, -5, 5, 5))
    s.bright = (-1.1, -0.01, -1.1), (-0.9, 1.01, 1.1)
    return s.put("tower", box((1, 0, -0.2), (1.3, 0.2, 0.2)), RED).put("block", box((-1.5, 0, -1), (-1, 1, 1)), WHITE)


@case
def sun_through_a_window():
    hole = joined(floor(-1, -1, 1, 1), ceiling(-1, -1, 1, 1, 2), quad((-1, 0, 1), (-1, 2, 1), (1, 2, 1), (1, 0, 1)),
                  quad((-1, 0, -1), (-1, 2, -1), (-1, 2, 1), (-1, 0, 1)), quad((1, 0, 1), (1, 2, 1), (1, 2, -1), (1, 0, -1)),
                  quad((-1, 0, -1), (-0.4, 0, -1), (-0.4, 2, -1), (-1, 2, -1)), quad((0.4, 0, -1), (1, 0, -1), (1, 2, -1), (0.4, 2, -1)),
                  quad((-0.4, 0, -1), (0.4, 0, -1), (0.4, 0.8, -1), (-0.4, 0.8, -1)), quad((-0.4, 1.6, -1), (0.4, 1.6, -1), (0.4, 2, -1), (-0.4, 2, -1)))
    shell = box((-1.1, -0.1, -1.0), (1.1, 2.1, 1.1))
    walls = (shell[0], [t for i, t in enumerate(shell[1]) if i // 2 != 4])  # all but the side of the window
    return Hard(SUN, "10,35,50000,0.533").put("room", hole).put("outside", walls)


@case
def point_light_5cm_over_floor():
    s = Hard().room((-1, 0, -1), (1, 2, 1)).put("box", box((0.3, 0, -0.3), (0.6, 0.4, 0.3)), RED)
    s.bright = (-0.2, -0.01, -0.2), (0.2, 0.01, 0.2)
    return s.light((0, 0.05, 0), {"type": "point", "intensity": 100})


@case
def narrow_spot():
    s = Hard().room((-1, 0, -1), (1, 2, 1)).put("box", box((-0.2, 0, -0.2), (0.2, 0.4, 0.2)), GREEN)
    s.bright = (0.3, -0.01, -0.2), (0.7, 0.01, 0.2)
    return s.light((0.5, 1.8, 0), {"type": "spot", "intensity": 1000, "spot": {"innerConeAngle": 0.05, "outerConeAngle": 0.06}},
                   (-0.6963642, 0.1227878, 0.1227878, 0.6963642))


@case
def masked_fence():
    from gltf_file import png
    s = lit_room()
    s.add_image(png(8, 8, lambda y, x: (255, 255, 255, 255 * ((y // 4 + x // 4) & 1)), channels=4))
    index = s.material((1, 1, 1), double=True, alphaMode="MASK")
    s.json["materials"][index]["pbrMetallicRoughness"].update(baseColorFactor=[0.5, 0.5, 0.5, 1], baseColorTexture={"index": 0})
    s.add_mesh("fence", quad((-0.8, 0.2, 0.3), (0.8, 0.2, 0.3), (0.8, 1.4, 0.3), (-0.8, 1.4, 0.3)), index)
    return s.attribute("TEXCOORD_0", [[0, 0], [1, 0], [1, 1], [0, 1]], "VEC2")


@case
def nested_glass():
    def glass(s):
        s.json["extensionsUsed"] = sorted({*s.json.get("extensionsUsed", ()), "KHR_materials_transmission"})
        return s.material((1, 1, 1), extensions={"KHR_materials_transmission": {"transmissionFactor": 1.0}})
    s = lit_room().put("pillar", box((-0.1, 0, -0.1), (0.1, 0.5, 0.1)), RED)
    for i, half in enumerate((0.2, 0.3)):
        s.add_mesh(f"glass {i}", box((-half, 0.001, -half), (half, 0.3 + half, half)), glass(s))
    s.only = {"room", "pillar"}
    s.truth = lit_room().put("pillar", box((-0.1, 0, -0.1), (0.1, 0.5, 0.1)), RED)  # clear glass takes nothing
    return s


@case
def cage_with_creases():
    """A cube all of whose edges are wholly sharp is its own limit surface."""
    s = lit_room().put("cube", box((-0.4, 0.1, -0.3), (0.2, 0.6, 0.3)), RED)
    s.truth = lit_room().put("cube", box((-0.4, 0.1, -0.3), (0.2, 0.6, 0.3)), RED)
    edges = [(a, a | 1 << k) for a in range(8) for k in range(3) if not a >> k & 1]
    s.json["meshes"][-1]["extras"] = {"hemibake_subdivision": {"level": 2, "creases": [[*e, 10] for e in edges]}}
    return s


@case
def grey_ball_of_5000_triangles():
    return lit_room().put("ball", sphere(70, (0.2, 0.6, 0.1), 0.35), GREY)
