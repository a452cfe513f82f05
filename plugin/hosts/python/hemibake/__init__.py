# SPDX-License-Identifier: MIT
"""Bakes diffuse global illumination into glTF, and into meshes that a program holds.

    import hemibake
    hemibake.bake("room.glb", "room.baked.glb", quality="high", exposure="auto")      # a file, by the program

    scene = hemibake.Scene()                                                           # numpy arrays, by the library
    white = scene.add_material(reflectance=(0.7, 0.7, 0.7))
    floor = scene.add_mesh(positions, indices, white)
    solution = scene.bake(quality="draft")
    solution.mesh(floor).radiance
"""

from .errors import (
    Cancelled,
    DataError,
    HemibakeError,
    LibraryMissing,
    OutputError,
    UsageError,
    WorkerDied,
)
from .files import Bake, bake
from .scene import Context, MeshView, Scene, Solution, version

__all__ = [
    "Bake",
    "Cancelled",
    "Context",
    "DataError",
    "HemibakeError",
    "LibraryMissing",
    "MeshView",
    "OutputError",
    "Scene",
    "Solution",
    "UsageError",
    "WorkerDied",
    "bake",
    "version",
]
