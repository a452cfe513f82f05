# SPDX-License-Identifier: MIT
"""What does the pavilion consist of? Podium, pools, walls, columns and roofs, in plan coordinates; README.md has the sources.

Walls and columns are sunk 5 cm into podium and roof, as one models them: they cross the slabs' faces.
"""

from solids import box, loft, pleats, ring, terrace, wall

LENGTH, DEPTH = 56.62, 18.48  # the podium
GROUND = -1.20
CEILING = 3.10
ROOF = CEILING + 0.30
POOL = -0.40
SUNK = 0.05

STEPS, TREAD, RISE = 8, 0.33, 0.15  # from the ground to the podium, up along -x
STAIR = (39.60, 0.0, 39.60 + STEPS * TREAD, 3.30)

HALL_ROOF = (25.60, 4.36, 51.00, 18.48)
UTILITY_ROOF = (0.50, 9.20, 11.40, 18.40)
UTILITY_ROOM = (1.40, 12.30, 8.10, 18.00)  # inside
DOOR = (13.80, 15.60)  # along y in its east wall, as high as the room
WALL = 0.30

COLUMN_CENTRES = [(x, y) for y in (7.61, 15.23) for x in (27.41, 34.67, 41.93, 49.19)]
LUMINOUS_WALL = (33.75, 8.95, 34.85, 14.85)
ONYX = (39.00, 12.40, 44.90, 12.60)


def standing(rectangles, material, high=CEILING + SUNK):
    return wall(rectangles, -SUNK, high, material)


def podium():
    west, front, east, back = STAIR
    stair = [((west + k * TREAD, front, west + (k + 1) * TREAD, back), -(k + 1) * RISE, "travertine") for k in range(STEPS - 1)]
    return terrace([
        ((0.0, 0.0, LENGTH, DEPTH), 0.0, "travertine"),
        ((1.80, 1.50, 22.90, 11.20), POOL, "pebbles"),
        ((51.50, 5.80, 54.90, 16.80), POOL, "black glass"),
        *stair,
    ], GROUND)


def west_walls():
    """The utility room, and the two arms that hold the large pool."""
    x0, y0, x1, y1 = UTILITY_ROOM
    return standing([
        (x0 - WALL, 0.80, x0, y1 + WALL),
        (x0 - WALL, 0.80, 9.00, 0.80 + WALL),
        (x0, y0 - WALL, x1 + WALL, y0),
        (x0, y1, x1 + WALL, y1 + WALL),
        (x1, y0 - WALL, x1 + WALL, DOOR[0]),
        (x1, DOOR[1], x1 + WALL, y1 + WALL),
    ], "travertine")


def court_walls():
    return standing([(44.60, 4.90, 55.55, 5.20), (55.25, 4.90, 55.55, 17.70), (40.30, 17.40, 55.55, 17.70)], "tinian marble")


def column(x, y):
    long, thin = 0.11, 0.03
    return standing([(x - long, y - thin, x + long, y + thin), (x - thin, y - long, x + thin, y + long)], "chrome")


def hall_roof():
    low, high = (*HALL_ROOF[:2], CEILING), (*HALL_ROOF[2:], ROOF)
    return box(low, high, "plaster", top="roofing")


def utility_roof():
    """Its faces are cut where the room's walls meet them: no face of the ceiling is half in the room, half outside."""
    x0, y0, x1, y1 = UTILITY_ROOM
    around = (x0 - WALL, y0 - WALL, x1 + WALL, y1 + WALL)
    return wall([UTILITY_ROOF, around, UTILITY_ROOM], CEILING, ROOF, "plaster")


def bench():
    """A slab of travertine before the long wall, on short feet."""
    seat = box((10.00, 15.30, 0.36), (26.50, 15.85, 0.44), "travertine")
    feet = [box((x, 15.40, -SUNK), (x + 0.30, 15.75, 0.37), "travertine") for x in (10.6, 14.5, 18.4, 22.3, 25.6)]
    return sum(feet, seat)


def statue():
    """Kolbe's Dawn, as far as a lathe gets: a figure on a block, arms raised against the light."""
    x, y = 53.60, 14.60
    block = box((x - 0.35, y - 0.35, POOL - SUNK), (x + 0.35, y + 0.35, -0.10), "black glass")
    body = loft([ring((x, y), r, h) for r, h in (
        ((0.13, 0.12), -0.12), ((0.16, 0.14), 0.35), ((0.24, 0.19), 0.95), ((0.17, 0.14), 1.22), ((0.24, 0.16), 1.52),
        ((0.08, 0.08), 1.68), ((0.13, 0.13), 1.82), ((0.11, 0.11), 1.98), ((0.04, 0.04), 2.05))], "bronze")
    arms = [loft([ring((x + s * 0.20, y), 0.07, 1.44, 6), ring((x + s * 0.42, y - 0.06), 0.06, 1.80, 6),
                  ring((x + s * 0.16, y - 0.12), 0.04, 2.25, 6)], "bronze") for s in (-1, 1)]
    return block + body + arms[0] + arms[1]


def parts():
    """name -> faces, in the order of the file."""
    made = {
        "podium": podium(),
        "hall-roof": hall_roof(),
        "utility-roof": utility_roof(),
        "west-walls": west_walls(),
        "long-wall": standing([(11.90, 16.30, 28.60, 16.60)], "travertine"),
        "court-walls": court_walls(),
        "green-wall": standing([(26.90, 8.45, 36.40, 8.65)], "alpine marble"),
        "onyx-wall": standing([ONYX], "onyx dore"),
        "curtain": pleats((37.60, 6.30), 46.40, 0.16, 0.03, 9, 0.03, CEILING - 0.04, "red velvet"),
        "carpet": box((38.60, 7.00, -0.01), (44.90, 11.90, 0.02), "black carpet"),
        "hedge-east": box((57.40, 4.40, GROUND), (57.90, 20.20, 10.60), "hedge"),
        "hedge-west": box((-1.60, -4.00, GROUND), (-1.00, 12.00, 6.00), "hedge"),
        "bench": bench(),
        "statue": statue(),
    }
    for k, centre in enumerate(COLUMN_CENTRES):
        made[f"column-{k + 1}"] = column(*centre)
    return made
