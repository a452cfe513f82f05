# SPDX-License-Identifier: MIT
"""How does a lamp shine whose light ShapingAPI confines? A Lambert surface cannot, so it becomes spots at points of its surface: the
sum of a few spots of KHR_lights_punctual, whose light falls off as ((cos - cos_outer) / (cos_inner - cos_outer))^2, follows the
intensity over the angle."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]

# A spot ends at a right angle at most, and its edge is no sharper than this in cosine [KHR_lights_punctual].
EDGE = 0.001
WEAKEST = 2e-4


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


@dataclasses.dataclass(frozen=True)
class Spot:
    weight: float
    inner: float
    outer: float


def _ramp(cosine: Array, low: float, high: float) -> Array:
    return np.clip((cosine - low) / (high - low), 0, 1) ** 2


def _non_negative(A: Array, b: Array) -> Array:
    """x >= 0 that makes A x closest to b: columns come in while they help, and go when they would turn negative [Lawson & Hanson 1974]."""
    x, used = np.zeros(A.shape[1]), np.zeros(A.shape[1], bool)
    for _ in range(60):
        gain = np.where(used, -np.inf, A.T @ (b - A @ x))
        if not gain.max() > 1e-5 * np.abs(b).max():
            break
        used[gain.argmax()] = True
        while True:
            best = np.zeros_like(x)
            best[used] = np.linalg.lstsq(A[:, used], b, rcond=None)[0]
            falling = used & (best <= 0)
            if not falling.any():
                break
            step = np.min(x[falling] / np.maximum(x[falling] - best[falling], 1e-300))
            x += step * (best - x)
            used &= x > 1e-14
            x[~used] = 0
        x = best
    return x


def spots(shape: Shape, facing: bool) -> list[Spot]:
    """Weights sum up to the intensity along the axis in units of radiance times area. facing: a flat lamp, which shows cos of its
    area."""
    least = math.cos(min(shape.cone, math.pi / 2))
    # As many places near the axis, where a focus is narrow, as near the edge.
    cosine = np.concatenate([np.linspace(least, 1, 161), np.cos(np.linspace(0, math.acos(least), 161))])
    wanted = shape.factor(cosine) * (cosine if facing else 1.0)
    if shape.softness <= 0 and shape.focus <= 0 and not facing:
        return [Spot(1.0, math.acos(min(least + EDGE, 1.0)), math.acos(least))]
    knots = np.unique(np.round([*np.linspace(least, 1, 9), *np.cos(np.linspace(0, math.acos(least), 13))], 9))
    pairs = [(low, max(high, low + EDGE)) for i, low in enumerate(knots[:-1]) for high in [low + EDGE, *knots[i + 1 :]]]
    weights = _non_negative(np.stack([_ramp(cosine, low, high) for low, high in pairs], axis=1), wanted)
    kept = [(w, low, high) for w, (low, high) in zip(weights, pairs) if w > WEAKEST * weights.max()]
    return [Spot(float(w), math.acos(min(high, 1.0)), math.acos(low)) for w, low, high in kept]
