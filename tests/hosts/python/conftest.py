# SPDX-License-Identifier: MIT
"""What do the tests of the Python package share?"""

from pathlib import Path

import numpy as np
import pytest

import hemibake

ROOT = Path(__file__).resolve().parents[3]

SQUARE = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
FLOOR = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], np.float32)
LAMP = np.array([[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]], np.float32)


@pytest.fixture
def room():
    """A small file to bake."""
    return ROOT / "samples/pillar-room.glb"


@pytest.fixture
def squares():
    """A scene: a grey floor under a lamp of radiance 1, one metre apart."""
    scene = hemibake.Scene(hemibake.Context(threads=2))
    grey = scene.add_material("grey", reflectance=(0.5, 0.5, 0.5))
    light = scene.add_material("light", reflectance=(0, 0, 0), emission=(1, 1, 1))
    scene.add_mesh(FLOOR, SQUARE, grey, name="floor")
    scene.add_mesh(LAMP, SQUARE, light, name="lamp")
    return scene
