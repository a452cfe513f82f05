# SPDX-License-Identifier: MIT
"""Where does everything stand? Items become nodes of the GLB, named as their prims and with their paths; lamps become surfaces, suns,
points and spots; domes one sky."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from . import domes, lights, shaping
from .glb import Glb, number, numbers
from .items import Copies, Item
from .lights import Light
from .materials import Material
from .reader import Reader
from .shaping import Shape
from .stage import Source
from .transforms import decomposed, is_sheared, unsheared

Array = np.ndarray[Any, Any]


class Frame:
    """A prim's place: its node is made when something in or below it needs one."""

    def __init__(self, scene: Scene, above: Frame | None, name: str, path: str, matrix: Array | None) -> None:
        self.scene, self.above, self.name, self.path, self.matrix = scene, above, name, path, matrix
        self.world: Array = above.world if above else np.eye(4)
        if matrix is not None:
            self.world = matrix @ self.world
        self._node = -1

    def members(self) -> dict[str, Any]:
        out: dict[str, Any] = {"name": self.name}
        if self.matrix is not None:
            out["matrix"] = self.matrix
        if self.path:
            out["extras"] = {"usd": {"path": self.path}}
        return out

    def node(self, **more: Any) -> int:
        """The index of its node; what is new to a node that is there is added to it."""
        glb = self.scene.glb
        if self._node < 0:
            members, parent = self.members(), self.above.node() if self.above else -1
            if self.matrix is not None and is_sheared(self.matrix):
                outer, members["matrix"] = unsheared(self.matrix)
                parent = glb.node(parent, name=self.name, **outer)
            self._node = glb.node(parent, **members)
        extras = more.pop("extras", None)
        glb.nodes[self._node].update(more)
        if extras:
            glb.nodes[self._node].setdefault("extras", {}).update(extras)
        return self._node


class Scene:
    """The GLB of one stage, and the sky that goes beside it."""

    def __init__(self, source: Source) -> None:
        self.source, self.losses, self.glb = source, source.losses, Glb()
        self.reader = Reader(source, self.glb)
        self.lights = 0
        self._domes: list[domes.Dome] = []
        self._lamps: dict[Any, int] = {}
        self._profiles: dict[tuple[Shape, str], int] = {}
        items = self.reader.read()
        root = source.root_matrix()
        self.root = None if np.array_equal(root, np.eye(4)) else Frame(self, None, "stage", "", root)
        for item in items:
            self._put(item, self.root, "")
        self.sky = domes.sky(self._domes, source.up, source.time, self.losses)

    # ---- the tree ------------------------------------------------------------------------------------------------------

    def _put(self, item: Item, above: Frame | None, path: str, matrix: Array | None = None, name: str | None = None) -> None:
        """matrix: instead of the item's own, for a copy."""
        own = item.matrix if matrix is None else matrix
        path = f"{path}/{item.name}" if name is None else name
        frame = Frame(self, self.root if item.resets else above, item.name, path, own)
        if item.mesh >= 0:
            frame.node(mesh=item.mesh)
        if item.camera:
            frame.node(camera=self.glb.append("cameras", item.camera.members))
        if item.light:
            self._put_light(item.light, frame)
        for copies in item.copies:
            self._put_copies(copies, frame)
        for child in item.children:
            self._put(child, frame, path)

    # ---- copies of a PointInstancer ------------------------------------------------------------------------------------

    def _put_copies(self, copies: Copies, frame: Frame) -> None:
        """Meshes of a prototype by EXT_mesh_gpu_instancing; what that cannot say, one node a copy."""
        found: list[tuple[int, Array, str]] = []
        if not _only_meshes(copies.prototype, np.eye(4), copies.path, found):
            for matrix in copies.matrices:
                own = copies.prototype.matrix
                self._put(copies.prototype, frame, "", matrix if own is None else own @ matrix, copies.path)
            return
        for mesh, inner, path in found:
            self._put_mesh(mesh, inner @ copies.matrices, path, frame)

    def _put_mesh(self, mesh: int, matrices: Array, path: str, frame: Frame) -> None:
        extras = {"usd": {"path": path, "instancer": frame.path}}
        name, parent = path.rsplit("/", 1)[-1], frame.node()
        parts = decomposed(matrices) if len(matrices) > 1 else None
        if parts is None:
            for matrix in matrices:
                inner, above = matrix, parent
                if is_sheared(matrix):
                    outer, inner = unsheared(matrix)
                    above = self.glb.node(parent, name=name, **outer)
                self.glb.node(above, name=name, mesh=mesh, matrix=inner, extras=extras)
            return
        names = ("TRANSLATION", "ROTATION", "SCALE")
        attributes = {key: self.glb.accessor(values) for key, values in zip(names, parts)}
        self.glb.use("EXT_mesh_gpu_instancing")
        self.glb.node(parent, name=name, mesh=mesh, extras=extras, extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})

    # ---- lamps ---------------------------------------------------------------------------------------------------------

    def _put_light(self, light: Light, frame: Frame) -> None:
        self.lights += 1
        # Lamps below the root's matrix stand in metres; what a lamp's size is counted in are units of the stage.
        if light.kind in lights.DOMES:
            self._domes.append(domes.Dome(light, frame.world, domes.pole_of(light.prim, self.source.time)))
        elif light.kind == "DistantLight":
            self._sun(light, frame)
        elif light.is_point or light.shape:
            self._points(light, frame)
        else:
            self._lamp(light, frame)

    def _lamp(self, light: Light, frame: Frame) -> None:
        color = lights.emitted(light, frame.world, self.source.meters)
        key = (light.kind, light.size, color)
        if key not in self._lamps:
            positions, triangles = light.body()
            material = self.reader.materials.index(Material("lamp", (0.0, 0.0, 0.0)), False, color)
            primitive = {"attributes": {"POSITION": self.glb.accessor(positions, bounds=True)}, "indices": self.glb.accessor(triangles.ravel()), "material": material}
            self._lamps[key] = self.glb.append("meshes", {"name": light.kind, "primitives": [primitive]})
        frame.node(mesh=self._lamps[key], extras={"hemibake_lamp": True})

    def _sun(self, light: Light, frame: Frame) -> None:
        if light.angle > 2 * lights.WIDEST:
            self.losses.add(frame.path, "its disc is wider than half the sky, and is baked as one of 178 degrees")
        member: dict[str, Any] = {"type": "directional"}
        angle = min(light.angle, lights.WIDEST)
        if angle > 0:
            member["extras"] = {"hemibake_angular_diameter": numbers([angle])[0]}
        if light.angle > angle:
            self.losses.add(frame.path, f"its disc of {math.degrees(light.angle):g} degrees is baked as one of {math.degrees(angle):g}")
        self._punctual(frame, member, lights.illuminance(light))

    def _points(self, light: Light, frame: Frame) -> None:
        """What confines its light shines by a profile from points of its surface."""
        radiance, area = lights.intensity_area(light, frame.world, self.source.meters)
        intensity = tuple(c * area for c in radiance)
        if light.shape:
            self._profiled(light, frame, intensity)
        else:
            self._punctual(frame, {"type": "point"}, intensity)

    def _profiled(self, light: Light, frame: Frame, intensity: tuple[float, ...]) -> None:
        places = None if light.is_point else shaping.places(light.kind, light.size)
        if places is not None:
            self.losses.add(frame.path, f"its cone is baked as {len(places)} points of its surface")
        most = max(intensity)
        if light.shape is None or not most > 0:
            return
        held = {"light": self._profile(light.shape, light.kind), "multiplier": numbers([most])[0], "color": numbers([c / most for c in intensity])}
        extras = {} if places is None else {"hemibake_places": [number(v) for v in places.ravel().tolist()]}
        frame.node(extensions={"EXT_lights_ies": held}, extras=extras)

    def _profile(self, shape: Shape, kind: str) -> int:
        """The index of the light of EXT_lights_ies that shines so."""
        if (shape, kind) not in self._profiles:
            self.glb.use("EXT_lights_ies")
            all_lights = self.glb.root.setdefault("extensions", {}).setdefault("EXT_lights_ies", {"lights": []})["lights"]
            all_lights.append({"bufferView": self.glb.view(shaping.profile(shape, kind)), "mimeType": "application/x-ies-lm-63"})
            self._profiles[shape, kind] = len(all_lights) - 1
        return self._profiles[shape, kind]

    def _punctual(self, frame: Frame, member: dict[str, Any], color: tuple[float, ...]) -> None:
        most = max(color)
        if not most > 0:
            return
        member.update(name=frame.name, color=numbers([c / most for c in color]), intensity=numbers([most])[0])
        self.glb.use("KHR_lights_punctual")
        all_lights = self.glb.root.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        all_lights.append(member)
        frame.node(extensions={"KHR_lights_punctual": {"light": len(all_lights) - 1}})


def _only_meshes(item: Item, below: Array, path: str, out: list[tuple[int, Array, str]]) -> bool:
    """Gathers meshes with where they stand in the copy; False where there is something else."""
    if item.light or item.camera or item.copies or item.resets:
        return False
    here = below if item.matrix is None else item.matrix @ below
    if item.mesh >= 0:
        out.append((item.mesh, here, path))
    return all(_only_meshes(child, here, f"{path}/{child.name}", out) for child in item.children)
