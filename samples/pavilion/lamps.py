# SPDX-License-Identifier: MIT
"""What lights the pavilion at night? A wall of opal glass, lamps of 30, 16 and 9 cm in the ceilings, tubes, bulbs of 6 cm.

Each lamp is a closed solid: its lit faces, and a housing for the rest.
"""

from building import CEILING, LUMINOUS_WALL, ONYX, POOL, UTILITY_ROOM
from solids import box

DEEP = 0.03  # a housing in its slab


def downlight(x, y, size, material):
    """Flush with the ceiling but for a centimetre; lit from below."""
    half = size / 2
    return box((x - half, y - half, CEILING - 0.01), (x + half, y + half, CEILING + DEEP), "housing", bottom=material)


def luminous_wall():
    """A steel box between two skins of opal glass; three panes a side, a pane's edge before the steel."""
    x0, y0, x1, y1 = LUMINOUS_WALL
    core = box((x0 + 0.05, y0, -0.05), (x1 - 0.05, y1, CEILING + 0.05), "housing")
    pane = (y1 - y0) / 3
    for k in range(3):
        low, high = y0 + k * pane + 0.04, y0 + (k + 1) * pane - 0.04
        core += box((x0, low, 0.10), (x0 + 0.06, high, CEILING - 0.10), "housing", west="opal glass")
        core += box((x1 - 0.06, low, 0.10), (x1, high, CEILING - 0.10), "housing", east="opal glass")
    return core


def bulb(x, y, low):
    """Six centimetres of light on a cord."""
    lit = box((x - 0.03, y - 0.03, low), (x + 0.03, y + 0.03, low + 0.06), "bulb", top="housing")
    cap = box((x - 0.02, y - 0.02, low + 0.05), (x + 0.02, y + 0.02, low + 0.11), "housing")
    return lit + cap + box((x - 0.005, y - 0.005, low + 0.10), (x + 0.005, y + 0.005, CEILING + DEEP), "housing")


def tube(low, high, side):
    return box(low, high, "housing", **{side: "tube"})


def floor_lamp(x, y, size):
    half = size / 2
    return box((x - half, y - half, -0.02), (x + half, y + half, 0.04), "housing", top="floodlight")


def pool_lamp(x, y, side):
    """In the pool's edge, under the rim."""
    along, across = (0.12, 0.02) if side in ("front", "back") else (0.02, 0.12)
    return box((x - along, y - across, POOL + 0.12), (x + along, y + across, POOL + 0.24), "housing", **{side: "pool light"})


def parts():
    x0, y0, x1, y1 = UTILITY_ROOM
    made = {"luminous-wall": luminous_wall()}
    places = {
        "ceiling-lamp": [(x, y, 0.30) for x in (31.0, 38.3, 45.5) for y in (5.4, 10.4, 16.6)],
        "wall-washer": [(ONYX[0] + 0.59 + 1.18 * k, ONYX[1] - 1.10, 0.16) for k in range(5)],
        "green-washer": [(28.1 + 1.6 * k, 7.75, 0.09) for k in range(6)],
        "court-spot": [(50.4, 13.4, 0.16), (50.4, 15.8, 0.16)],
        "eaves-lamp": [(9.9, 12.6, 0.16), (9.9, 16.8, 0.16)],
    }
    for name, lamps in places.items():
        for k, (x, y, size) in enumerate(lamps):
            made[f"{name}-{k + 1}"] = downlight(x, y, size, "halogen")
    for k, (x, y) in enumerate([(3.4, 15.2), (5.2, 15.2), (6.6, 16.0)]):
        made[f"bulb-{k + 1}"] = bulb(x, y, 2.20)
    made["bench-tube"] = tube((3.90, y0 + 0.40, 1.60), (5.30, y0 + 0.45, 1.64), "bottom")
    made["shelf-tube"] = tube((4.70, y1 - 0.50, 1.87), (5.70, y1 - 0.46, 1.91), "bottom")
    for k, (x, y, side) in enumerate([(5, 1.5, "back"), (12, 1.5, "back"), (19, 1.5, "back"), (22.9, 5, "west"),
                                      (22.9, 9, "west"), (51.5, 9, "east"), (51.5, 13, "east")]):
        made[f"pool-lamp-{k + 1}"] = pool_lamp(x, y, side)
    made["floodlight"] = floor_lamp(51.2, 14.6, 0.20)
    return made
