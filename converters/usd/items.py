# SPDX-License-Identifier: MIT
"""What is there of a stage to bake, before it stands anywhere? A tree of items; what instances share is there once."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from .lights import Light

Array = np.ndarray[Any, Any]


@dataclasses.dataclass
class Camera:
    members: dict[str, Any]


@dataclasses.dataclass
class Copies:
    """What a PointInstancer places: a prototype and a matrix for each of its copies, rows as images of the axes."""

    prototype: Item
    path: str  # of the prototype
    matrices: Array


@dataclasses.dataclass
class Item:
    """A prim with something below or in it; matrix leads to its parent, or to the stage if resets."""

    name: str
    matrix: Array | None = None  # None: the identity
    resets: bool = False
    mesh: int = -1  # of the GLB
    light: Light | None = None
    camera: Camera | None = None
    copies: list[Copies] = dataclasses.field(default_factory=list)
    children: list[Item] = dataclasses.field(default_factory=list)

    def is_empty(self) -> bool:
        return self.mesh < 0 and not (self.light or self.camera or self.copies or self.children)
