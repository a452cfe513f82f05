# SPDX-License-Identifier: MIT
"""What stands in the pavilion? Chairs, stools and a table in the hall; what a caretaker keeps in the utility room."""

import math

from building import UTILITY_ROOM
from solids import box, loft, placed, ring, tilted, wall

FLOOR = 0.02  # the carpet's top


def _crossed_legs(reach, height, y, width=0.03):
    """Two flat bars that cross, in the plane along x at y, one beside the other so that they do not meet."""
    half, length = reach / 2, math.hypot(reach, height) / 2
    slope = math.degrees(math.atan2(height, reach))
    bars = []
    for k, degrees in enumerate((slope, -slope)):
        bar = box((half - length, y + k * width, height / 2 - 0.015),
                  (half + length, y + (k + 1) * width - 0.005, height / 2 + 0.015), "chrome")
        bars += tilted(bar, (half, height / 2), degrees)
    return bars


def chair():
    """The Barcelona chair: 75 cm wide, 77 cm high, seat and back as cushions; it looks along -x."""
    seat = tilted(box((0.0, 0.0, 0.30), (0.58, 0.75, 0.42), "white leather"), (0.0, 0.42), -8)
    back = tilted(box((0.60, 0.0, 0.30), (1.08, 0.75, 0.42), "white leather"), (0.60, 0.30), 66)
    legs = sum((_crossed_legs(0.54, 0.27, y) for y in (0.08, 0.62)), [])
    return seat + back + legs


def stool():
    cushion = box((0.0, 0.0, 0.31), (0.58, 0.60, 0.40), "white leather")
    return cushion + sum((_crossed_legs(0.58, 0.30, y) for y in (0.06, 0.48)), [])


def table():
    """A black plate on a chromium cross."""
    plate = box((-0.50, -0.50, 0.42), (0.50, 0.50, 0.45), "black glass")
    cross = wall([(-0.55, -0.02, 0.55, 0.02), (-0.02, -0.55, 0.02, 0.55)], -0.015, 0.43, "chrome")
    return plate + placed(cross, (0, 0, 0), 45)


def shelf():
    """Along the back wall: three uprights, four boards, and what is kept on them."""
    made = [box((x, 0.0, -0.05), (x + 0.05, 0.50, 2.10), "oak") for x in (0.0, 1.40, 2.80)]
    for h in (0.25, 0.80, 1.35, 1.90):
        made += [box((a, 0.02, h), (a + 1.37, 0.48, h + 0.04), "oak") for a in (0.04, 1.44)]
    stored = [(0.15, 0.30, 0.29, "crate"), (0.70, 0.42, 0.29, "red velvet"), (1.60, 0.50, 0.29, "crate"),
              (2.30, 0.35, 0.29, "crate"),
              (0.20, 0.34, 0.84, "plaster"), (0.90, 0.28, 0.84, "crate"), (1.55, 0.25, 0.84, "green paint"),
              (2.10, 0.40, 0.84, "plaster"), (0.25, 0.45, 1.39, "green paint"), (1.70, 0.36, 1.39, "crate"),
              (2.35, 0.26, 1.39, "red velvet")]
    for x, size, h, material in stored:
        made.append(box((x, 0.08, h - 0.005), (x + size, 0.38, h + 0.8 * size), material))
    return sum(made, [])


def workbench():
    plate = box((0.0, 0.0, 0.84), (2.00, 0.70, 0.90), "oak")
    legs = [box((x, y, -0.05), (x + 0.08, y + 0.08, 0.85), "oak") for x in (0.06, 1.86) for y in (0.06, 0.56)]
    tools = box((0.30, 0.20, 0.89), (0.75, 0.50, 1.10), "green paint") + box((1.30, 0.25, 0.89), (1.50, 0.45, 1.14), "crate")
    panel = box((0.16, 0.05, 0.04), (1.84, 0.10, 0.85), "oak")
    return sum(legs, plate) + panel + tools


def boiler():
    """A tank with its flue up through the ceiling."""
    tank = loft([ring((0, 0), 0.10, -0.05, 12), ring((0, 0), 0.34, 0.12, 12), ring((0, 0), 0.34, 1.62, 12),
                 ring((0, 0), 0.10, 1.80, 12)], "copper")
    return tank + loft([ring((0, 0), 0.07, 1.70), ring((0, 0), 0.07, 3.15)], "copper")


def ladder():
    rails = [box((x, 0.0, -0.03), (x + 0.05, 0.06, 2.30), "oak") for x in (0.0, 0.45)]
    rungs = [box((0.04, 0.01, 0.25 + 0.3 * k), (0.46, 0.05, 0.29 + 0.3 * k), "oak") for k in range(7)]
    return sum(rails + rungs, [])


def parts():
    x0, y0, x1, y1 = UTILITY_ROOM
    return {
        "chair-1": placed(chair(), (41.20, 10.90, FLOOR), -90),
        "chair-2": placed(chair(), (42.60, 10.90, FLOOR), -90),
        "stool-1": placed(stool(), (40.20, 8.30, FLOOR), -90),
        "stool-2": placed(stool(), (41.30, 8.30, FLOOR), -90),
        "stool-3": placed(stool(), (42.40, 8.30, FLOOR), -90),
        "table": placed(table(), (42.10, 9.15, FLOOR)),
        "shelf": placed(shelf(), (3.20, y1 - 0.55, 0.0)),
        "workbench": placed(workbench(), (3.60, y0 - 0.02, 0.0)),
        "boiler": placed(boiler(), (7.30, y1 - 0.65, 0.0)),
        "ladder": placed(ladder(), (6.60, y0 + 0.03, 0.0)),
    }
