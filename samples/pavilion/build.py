#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds pavilion.glb: Mies van der Rohe's pavilion of 1929 at night, in the spirit of the paper's figures 14 and 15.

    python3 samples/pavilion/build.py [-o FILE.glb]
"""

import argparse
import os

import building
import furniture
import lamps
from glb import Glb

DARK = (0.0, 0.0, 0.0)

# name: (rho, radiance). Reflectances are plausible ones for the stone, read off photographs; lamps reflect nothing.
MATERIALS = {
    "travertine": ((0.62, 0.54, 0.43), DARK),
    "tinian marble": ((0.10, 0.22, 0.15), DARK),
    "alpine marble": ((0.13, 0.27, 0.20), DARK),
    "onyx dore": ((0.66, 0.38, 0.14), DARK),
    "plaster": ((0.80, 0.79, 0.76), DARK),
    "roofing": ((0.25, 0.24, 0.22), DARK),
    "chrome": ((0.55, 0.56, 0.58), DARK),
    "black glass": ((0.03, 0.03, 0.03), DARK),
    "pebbles": ((0.12, 0.14, 0.13), DARK),
    "black carpet": ((0.04, 0.04, 0.05), DARK),
    "red velvet": ((0.45, 0.03, 0.03), DARK),
    "white leather": ((0.74, 0.71, 0.64), DARK),
    "bronze": ((0.30, 0.19, 0.10), DARK),
    "oak": ((0.42, 0.27, 0.15), DARK),
    "crate": ((0.50, 0.38, 0.24), DARK),
    "green paint": ((0.14, 0.30, 0.22), DARK),
    "copper": ((0.48, 0.24, 0.14), DARK),
    "hedge": ((0.04, 0.07, 0.03), DARK),
    "housing": ((0.15, 0.15, 0.16), DARK),
    "opal glass": (DARK, (1.6, 1.56, 1.45)),
    "halogen": (DARK, (90.0, 76.0, 56.0)),
    "bulb": (DARK, (100.0, 74.0, 44.0)),
    "tube": (DARK, (9.0, 8.6, 8.0)),
    "pool light": (DARK, (22.0, 32.0, 38.0)),
    "floodlight": (DARK, (60.0, 54.0, 42.0)),
}

CAMERAS = [
    ("figure-14", (47.9, 8.7, 1.50), (38.0, 10.9, 1.22), 50.0),
    ("figure-15", (1.8, 15.0, 1.60), (12.0, 14.75, 1.42), 58.0),
]


def build():
    glb = Glb(MATERIALS)
    for stage in (building, furniture, lamps):
        for name, faces in stage.parts().items():
            glb.add_part(name, faces)
    for camera in CAMERAS:
        glb.add_camera(*camera)
    return glb.bytes()


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description="Build the pavilion.")
    parser.add_argument("-o", "--output", default=os.path.join(here, "pavilion.glb"))
    with open(parser.parse_args().output, "wb") as f:
        f.write(build())


if __name__ == "__main__":
    main()
