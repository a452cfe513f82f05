# SPDX-License-Identifier: MIT
"""How does a lamp shine whose light ShapingAPI confines? A Lambert surface cannot, so it becomes points of its surface, each with the
intensity over the angle that a piece of the surface has: a profile as measured lamps have one [IES LM-63]."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]

# Degrees between the angles of a profile, and from a sharp edge to where it is dark.
STEP, EDGE = 0.5, 1e-3

# Points of a flat lamp across and along, of a tube along.
GRID = 8


@dataclasses.dataclass(frozen=True)
class Shape:
    """Of ShapingAPI, angles in radians."""

    cone: float
    softness: float
    focus: float

    def factor(self, cosine: Array) -> Array:
        """What radiance is multiplied by, of the cosine to the axis."""
        angle = np.arccos(np.clip(cosine, -1, 1))
        begin = self.cone * (1 - min(max(self.softness, 0.0), 1.0))
        x = np.clip((angle - begin) / max(self.cone - begin, 1e-9), 0, 1)
        soft = 1 - x * x * (3 - 2 * x) if self.softness > 0 else (angle <= self.cone).astype(float)
        return soft * np.abs(cosine) ** max(self.focus, 0.0)


# ---- intensity ---------------------------------------------------------------------------------------------------------


def _shown(kind: str, theta: Array, phi: Array) -> Array:
    """The share of its area that a lamp shows at theta from -z, phi from x: a ball all, a tube along x as much as it is seen from
    aside, a flat one the cosine."""
    if kind == "SphereLight":
        return np.ones(np.broadcast(theta, phi).shape)
    if kind == "CylinderLight":
        return np.sqrt(np.maximum(1 - (np.sin(theta) * np.cos(phi)) ** 2, 0))
    return np.maximum(np.cos(theta), 0) + 0 * phi


def profile(shape: Shape, kind: str) -> bytes:
    """A file of IES LM-63, type C, whose 1 candela is radiance times the area that the lamp shows at most."""
    cone = min(np.degrees(shape.cone), 180.0)
    vertical = np.unique(np.round([*np.arange(0, 180 + STEP, STEP), cone, min(cone + EDGE, 180.0)], 6))
    horizontal = np.arange(0, 91, 5.0) if kind == "CylinderLight" else np.zeros(1)
    theta, phi = np.meshgrid(np.radians(vertical), np.radians(horizontal))
    candela = shape.factor(np.cos(theta)) * _shown(kind, theta, phi)
    head = f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {len(vertical)} {len(horizontal)} 1 2 0 0 0\n1 1 0\n"
    rows = [" ".join(f"{value:.7g}" for value in row) for row in (vertical, horizontal, *candela)]
    return (head + "\n".join(rows) + "\n").encode()


# ---- points ------------------------------------------------------------------------------------------------------------


def _ring(radius: float, count: int) -> Array:
    angle = 2 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _of_ball(radius: float) -> Array:
    """Corners of an icosahedron, as far from the middle as makes their spread that of the disc which is seen, from anywhere."""
    golden = (1 + 5**0.5) / 2
    one = np.array([[0, s, t * golden] for s in (-1, 1) for t in (-1, 1)])
    corners = np.concatenate([np.roll(one, k, axis=1) for k in range(3)])
    return corners / np.linalg.norm(corners[0]) * radius * np.sqrt(3 / 4)


def _of_tube(radius: float, length: float) -> Array:
    """Across as far apart as makes their spread that of the width which is seen."""
    steps = length * ((np.arange(GRID) + 0.5) / GRID - 0.5)
    around = _ring(radius * np.sqrt(2 / 3), 4)
    return np.array([[x, *yz] for x in steps for yz in around])


def _of_disk(radius: float) -> Array:
    """Nineteen points that stand for equal areas: one in the middle, six and twelve around it."""
    flat = np.concatenate([np.zeros((1, 2)), _ring(radius * np.sqrt(4 / 19), 6), _ring(radius * np.sqrt(13 / 19), 12)])
    return np.column_stack([flat, np.zeros(len(flat))])


def places(kind: str, size: tuple[float, float]) -> Array:
    """Where the points of a lamp stand, in its own frame; each stands for the same area."""
    if kind == "SphereLight":
        return _of_ball(size[0])
    if kind == "CylinderLight":
        return _of_tube(*size)
    if kind == "DiskLight":
        return _of_disk(size[0])
    steps = (np.arange(GRID) + 0.5) / GRID - 0.5
    x, y = np.meshgrid(size[0] * steps, size[1] * steps)
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
