# SPDX-License-Identifier: MIT
"""Which translations, rotations and scales make a matrix, since nodes of glTF may have no other? Rows are images of the axes."""

from __future__ import annotations

from typing import Any

import numpy as np

from .glb import Json, number

Array = np.ndarray[Any, Any]

# Cosine between two axes from where on they are not square; float32 is off by 1e-7.
SQUARE = 1e-6


def rotations(q: Array) -> Array:
    """Rows are images of the axes; q is (x, y, z, w), of any length."""
    norm = np.linalg.norm(q, axis=1, keepdims=True)
    x, y, z, w = (np.where(norm > 0, q / np.maximum(norm, 1e-300), [0, 0, 0, 1])).T
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1),
        np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1),
        np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1),
    ], axis=1)  # fmt: skip


def quaternions(rows: Array) -> Array:
    """(x, y, z, w) of rotations whose rows are images of the axes, w not negative."""
    m = rows.transpose(0, 2, 1)
    trace = m[:, 0, 0] + m[:, 1, 1] + m[:, 2, 2]
    four = np.stack([1 + 2 * m[:, 0, 0] - trace, 1 + 2 * m[:, 1, 1] - trace, 1 + 2 * m[:, 2, 2] - trace, 1 + trace], axis=1)
    largest = four.argmax(axis=1)
    products = {
        0: np.stack([four[:, 0], m[:, 0, 1] + m[:, 1, 0], m[:, 0, 2] + m[:, 2, 0], m[:, 2, 1] - m[:, 1, 2]], axis=1),
        1: np.stack([m[:, 0, 1] + m[:, 1, 0], four[:, 1], m[:, 1, 2] + m[:, 2, 1], m[:, 0, 2] - m[:, 2, 0]], axis=1),
        2: np.stack([m[:, 0, 2] + m[:, 2, 0], m[:, 1, 2] + m[:, 2, 1], four[:, 2], m[:, 1, 0] - m[:, 0, 1]], axis=1),
        3: np.stack([m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1], four[:, 3]], axis=1),
    }
    q = np.choose(largest[:, None], [products[k] for k in range(4)])
    q /= np.maximum(np.linalg.norm(q, axis=1, keepdims=True), 1e-300)
    return q * np.where(q[:, 3:] < 0, -1.0, 1.0)


def decomposed(matrices: Array) -> tuple[Array, Array, Array] | None:
    """Translations, rotations and scales as float32. None: a matrix shears, or its numbers would not survive."""
    linear = matrices[:, :3, :3]
    scales = np.linalg.norm(linear, axis=2)
    if not (scales > 0).all():
        return None
    scales[:, 0] *= np.where(np.linalg.det(linear) < 0, -1.0, 1.0)
    turns = quaternions(linear / scales[:, :, None])
    if np.abs(rotations(turns) * scales[:, :, None] - linear).max() > 1e-5 * np.abs(scales).max():
        return None
    return matrices[:, 3, :3].astype(np.float32), turns.astype(np.float32), scales.astype(np.float32)


# ---- shear -------------------------------------------------------------------------------------------------------------


def is_sheared(matrix: Array) -> bool:
    """No node of glTF may have such a matrix: its axes are not square, or it flattens."""
    (a, b, c), (d, e, f), (g, h, i) = matrix[:3, :3].tolist()
    x, y, z = a * a + b * b + c * c, d * d + e * e + f * f, g * g + h * h + i * i
    off = ((a * d + b * e + c * f) ** 2, x * y), ((a * g + b * h + c * i) ** 2, x * z), ((d * g + e * h + f * i) ** 2, y * z)
    return any(dot > SQUARE**2 * both or not both for dot, both in off)


def unsheared(matrix: Array) -> tuple[Json, Array]:
    """Two nodes that make it, members of the outer and the matrix of the inner: a turned box, turned."""
    turn, sizes, axes = np.linalg.svd(matrix[:3, :3])
    sign, outer_sign = (1.0 if np.linalg.det(m) > 0 else -1.0 for m in (turn, axes))
    inner = np.eye(4)
    inner[:3, :3] = sign * turn
    rotation = quaternions(outer_sign * axes[None])[0]
    members = {"translation": matrix[3, :3], "rotation": rotation, "scale": sign * outer_sign * sizes}
    return {key: [number(v) for v in values.tolist()] for key, values in members.items()}, inner
