# SPDX-License-Identifier: MIT
"""How is a scene that a program holds baked? Materials and numpy arrays in, arrays that look into the solution out.

Units are those of hemibake.h: metres, radiance in W/m2/sr. Fronts are counter-clockwise.
"""

from __future__ import annotations

import dataclasses
import logging
import os
import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .asset import Asset
from .errors import HemibakeError, UsageError
from .library import as_dict, check, desc, ffi, field_names, table, view

Progress = Callable[[float, str], "bool | None"]
Array = npt.NDArray[Any]

_log = logging.getLogger("hemibake")
_LEVELS = (logging.ERROR, logging.WARNING, logging.INFO)


def version() -> str:
    """Of the library that is open."""
    return str(ffi.string(table().version()).decode())


class Context:
    """Threads, and where messages go: the logger "hemibake". Calls on one context must not overlap; many may exist."""

    def __init__(self, threads: int = 0) -> None:
        self._error: str | None = None
        self._busy = threading.Lock()
        self._listen = ffi.callback("hemi_log_fn", self._hear)
        out = ffi.new("hemi_context **")
        check(table().context_create(desc("hemi_context_desc", threads=threads, log=self._listen), out))
        self._handle = ffi.gc(out[0], table().context_destroy)

    def _hear(self, _user: Any, level: int, text: Any) -> None:
        line = ffi.string(text).decode(errors="replace")
        if level == 0:
            self._error = line
        _log.log(_LEVELS[level], "%s", line)

    def _call(self, function: Any, *arguments: Any) -> None:
        """A call whose error text is the one that the library logged meanwhile."""
        if not self._busy.acquire(blocking=False):
            raise HemibakeError("calls on one context must not overlap; give each thread a Context of its own")
        try:
            self._error = None
            check(function(*arguments), self._error)
        finally:
            self._busy.release()


def _array(values: npt.ArrayLike, kind: type, width: int, name: str) -> Array:
    """values as rows of width; not copied if they are already so."""
    try:
        array: Array = np.ascontiguousarray(values, dtype=kind)
    except (TypeError, ValueError, OverflowError) as e:
        raise UsageError(f"{name}: {e}") from e
    if array.size % width != 0 or (array.ndim == 2 and array.shape[1] != width):
        raise UsageError(f"{name} has the shape {array.shape}; {width} numbers a row are needed")
    return array


def _indices(values: npt.ArrayLike) -> Array:
    array = np.asarray(values)
    if array.size and (array.dtype.kind not in "iu" or array.min() < 0 or array.max() > 0xFFFFFFFF):
        raise UsageError("indices are not numbers from 0 to 2^32 - 1")
    return _array(array, np.uint32, 3, "indices")


class Scene:
    """What is lit: materials and meshes of them, and what lights them besides: lights and a sky."""

    def __init__(self, context: Context | None = None) -> None:
        self.context = context or Context()
        self._asset = Asset()
        self._sky: tuple[float, ...] | None = None
        out = ffi.new("hemi_scene **")
        self.context._call(table().scene_create, self.context._handle, out)
        # A scene must go before its context: the destructor holds on to it.
        context_handle = self.context._handle
        self._handle = ffi.gc(out[0], lambda scene, _keep=context_handle: table().scene_destroy(scene))

    def add_material(
        self,
        name: str = "",
        reflectance: Sequence[float] = (0.5, 0.5, 0.5),
        emission: Sequence[float] = (0.0, 0.0, 0.0),
        double_sided: bool = False,
        **more: Any,
    ) -> int:
        """Its number. `more`: further fields of hemi_material_desc."""
        text = ffi.new("char[]", name.encode())
        material = desc(
            "hemi_material_desc", name=text, reflectance=list(reflectance), emission=list(emission),
            double_sided=double_sided, **more,
        )
        index = ffi.new("uint32_t *")
        self.context._call(table().scene_add_material, self._handle, material, index)
        self._asset.add_material(name, reflectance, emission, double_sided)
        self._asset.lost |= set(more)
        return int(index[0])

    def add_mesh(
        self,
        positions: npt.ArrayLike,
        indices: npt.ArrayLike,
        material: int,
        *,
        normals: npt.ArrayLike | None = None,
        transform: npt.ArrayLike | None = None,
        attributes: npt.ArrayLike | None = None,
        name: str = "",
        subdivision: str = "none",
        subdivision_level: int = 0,
        **more: Any,
    ) -> int:
        """Its number. positions and normals: (n, 3); indices: (m, 3); transform: (4, 4), rows times columns as in numpy;
        attributes: (n, k), anything that interpolates linearly. `more`: further fields of hemi_mesh_desc, and of hemi_subdivision_desc."""
        points = _array(positions, np.float32, 3, "positions")
        corners = _indices(indices)
        text = ffi.new("char[]", name.encode())
        cage = {name: more.pop(name) for name in field_names("hemi_subdivision_desc") if name in more}
        fields: dict[str, Any] = {
            "name": text,
            "positions": ffi.from_buffer("float[]", points),
            "vertex_count": points.size // 3,
            "indices": ffi.from_buffer("uint32_t[]", corners),
            "triangle_count": corners.size // 3,
            "material": material,
            **more,
        }
        if subdivision != "none":
            fields["subdivision"] = desc("hemi_subdivision_desc", scheme=subdivision, level=subdivision_level, **cage)
        directions = matrix = None
        if normals is not None:
            directions = _array(normals, np.float32, 3, "normals")
            if directions.size != points.size:
                raise UsageError(f"there are {directions.size // 3} normals for {points.size // 3} positions")
            fields["normals"] = ffi.from_buffer("float[]", directions)
        if transform is not None:
            matrix = _array(transform, np.float64, 4, "transform")
            if matrix.shape != (4, 4):
                raise UsageError(f"transform has the shape {matrix.shape}; (4, 4) is needed")
            fields["transform"] = matrix.T.ravel().tolist()
        if attributes is not None:
            values = np.asarray(attributes)
            if values.ndim != 2 or len(values) != points.size // 3 or values.shape[1] == 0:
                raise UsageError(f"attributes has the shape {values.shape}; a row for each of {points.size // 3} positions is needed")
            fields["attributes"] = ffi.from_buffer("float[]", _array(values, np.float32, values.shape[1], "attributes"))
            fields["attribute_count"] = values.shape[1]
        index = ffi.new("uint32_t *")
        self.context._call(table().scene_add_mesh, self._handle, desc("hemi_mesh_desc", **fields), index)
        self._asset.lost |= {*more, *cage, *(["attributes"] if attributes is not None else []), *(["subdivision"] if subdivision != "none" else [])}
        self._asset.add_mesh(name, points, corners, directions, matrix, material)
        return int(index[0])

    def add_light(
        self,
        kind: str,
        intensity: Sequence[float],
        *,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        direction: Sequence[float] = (0.0, -1.0, 0.0),
        inner_cone: float = 0.0,
        outer_cone: float = 0.0,
        range: float = 0.0,
        angular_diameter: float = 0.0,
        name: str = "",
        light_group: int = 0,
    ) -> int:
        """Its number. kind: "point", "spot" or "directional", as in KHR_lights_punctual; intensity: W/sr, or W/m2 of a
        directional light; angles in radians. A sun is directional with an angular_diameter of 0.0093. light_group: that it
        belongs to, below light_groups of the bake."""
        text = ffi.new("char[]", name.encode())
        light = desc(
            "hemi_light_desc", kind=kind, name=text, intensity=list(intensity), position=list(position),
            direction=list(direction), inner_cone=inner_cone, outer_cone=outer_cone, range=range,
            angular_diameter=angular_diameter, light_group=light_group,
        )
        index = ffi.new("uint32_t *")
        self.context._call(table().scene_add_light, self._handle, light, index)
        self._asset.add_light(kind, name, intensity, position, direction, (inner_cone, outer_cone), range)
        self._asset.lost |= ({"angular_diameter"} if angular_diameter else set()) | ({"light_group"} if light_group else set())
        return int(index[0])

    def set_sky(self, radiance: Sequence[float] = (1.0, 1.0, 1.0), image: npt.ArrayLike | None = None, light_group: int = 0) -> None:
        """What is seen past all surfaces. image: a panorama of shape (height, width, 3) that radiance multiplies: row 0 at
        the zenith, +x in the middle, +z a quarter to the right of it. light_group: as of a light."""
        fields: dict[str, Any] = {"radiance": list(radiance), "light_group": light_group}
        if image is not None:
            panorama = np.asarray(image)
            if panorama.ndim != 3 or panorama.shape[2] != 3:
                raise UsageError(f"image has the shape {panorama.shape}; (height, width, 3) is needed")
            fields["height"], fields["width"] = panorama.shape[:2]
            fields["image"] = ffi.from_buffer("float[]", _array(panorama, np.float32, 3, "image"))
        self.context._call(table().scene_set_sky, self._handle, desc("hemi_sky_desc", **fields))
        self._sky = None if image is not None else tuple(map(float, radiance))
        self._asset.lost |= {"the panorama of the sky"} if image is not None else set()

    def save(self, path: str | os.PathLike[str]) -> dict[str, str]:
        """Writes the scene as a .glb that hemibake.bake and the command take, and every other program. Returns the options of a
        bake that belong to it: a sky is none of glTF's. What else glTF has no words for goes to the logger."""
        self._asset.write(path)
        if self._asset.lost:
            _log.warning("%s: glTF has no words for %s", os.fspath(path), ", ".join(sorted(self._asset.lost)))
        return {} if self._sky is None else {"environment": ",".join(map(repr, self._sky))}

    def bake(self, progress: Progress | None = None, **options: Any) -> Solution:
        """Solves the light. options: fields of hemi_bake_desc, as quality="draft", element_size=0.1; with keep_rows=True
        the solution can be lit anew (Solution.relight), with light_groups=N each of N groups of lights is told apart.

        progress(fraction, stage) is called now and then; False cancels, and what it raises comes out of here.
        """
        return _solve(self, table().bake, (self._handle,), progress, options)


def _solve(scene: Scene, function: Any, of: tuple[Any, ...], progress: Progress | None, options: dict[str, Any]) -> Solution:
    raised: list[BaseException] = []

    def report(_user: Any, at: Any) -> bool:
        return bool(progress is None or progress(at.fraction, ffi.string(at.stage).decode()) is not False)

    def stop(_kind: Any, error: BaseException, _trace: Any) -> bool:
        raised.append(error)
        return False

    listen = ffi.callback("hemi_progress_fn", report, error=False, onerror=stop)
    wish = desc("hemi_bake_desc", progress=listen, **options)
    out = ffi.new("hemi_solution **")
    try:
        scene.context._call(function, *of, wish, out)
    except HemibakeError:
        if raised:
            raise raised[0] from None
        raise
    return Solution(ffi.gc(out[0], table().solution_destroy), options)


@dataclasses.dataclass(frozen=True)
class MeshView:
    """One mesh after tessellation. The arrays look into the solution, are read-only, and keep it alive."""

    positions: Array  # (n, 3) float32, the mesh's own frame
    normals: Array  # (n, 3) float32
    radiance: Array  # (n, 3) float32, W/m2/sr
    indices: Array  # (m, 3) uint32
    source_triangles: Array | None  # (n,) uint32: a triangle of the input that holds the vertex
    source_weights: Array | None  # (n, 3) float32: its barycentric coordinates there
    attributes: Array | None  # (n, k) float32 of the limit surface, if the mesh was subdivided
    light_groups: Array | None  # (g, n, 3) float32, W/m2/sr: by each group of lights alone, which add up; with light_groups=g
    errors: Array | None  # (n,) float32: where the error lies, as a share of the rms radiance; with vertex_errors=True


class Solution:
    """What a bake gives."""

    def __init__(self, handle: Any, options: dict[str, Any] | None = None) -> None:
        self._handle = handle
        self._options = options or {}

    def relight(self, scene: Scene, progress: Progress | None = None, **options: Any) -> Solution:
        """Bakes a scene of the same meshes with other emission, lights or sky on what the rays of this bake hit, which takes
        a fraction of its time. This one is of bake(keep_rows=True), whose options hold unless others are given; those of
        sizes and rays must be the same. progress: as of Scene.bake."""
        asked = {key: value for key, value in {**self._options, **options}.items() if key != "keep_rows"}
        return _solve(scene, table().solution_relight, (self._handle, scene._handle), progress, asked)

    def _look(self, pointer: Any, kind: str, dtype: type, shape: tuple[int, ...]) -> Array | None:
        if pointer == ffi.NULL:
            return None
        handle = self._handle
        # numpy keeps the buffer, the buffer its pointer, and the pointer's destructor the solution.
        held = ffi.gc(pointer, lambda _pointer, _keep=handle: None)
        count = int(np.prod(shape))
        size = count * ffi.sizeof(kind)
        array: Array = np.frombuffer(ffi.buffer(held, size), dtype=dtype) if count else np.empty(0, dtype)
        array.flags.writeable = False
        return array.reshape(shape)

    def mesh(self, index: int) -> MeshView:
        looked = view("hemi_mesh_view")
        if not 0 <= index <= 0xFFFFFFFF or table().solution_mesh(self._handle, index, looked) != 0:
            raise UsageError(f"mesh {index} is none of the solution's")
        n, m = looked.vertex_count, looked.triangle_count
        looks = {
            "positions": self._look(looked.positions, "float", np.float32, (n, 3)),
            "normals": self._look(looked.normals, "float", np.float32, (n, 3)),
            "radiance": self._look(looked.radiance, "float", np.float32, (n, 3)),
            "indices": self._look(looked.indices, "uint32_t", np.uint32, (m, 3)),
            "source_triangles": self._look(looked.source_triangles, "uint32_t", np.uint32, (n,)),
            "source_weights": self._look(looked.source_weights, "float", np.float32, (n, 3)),
            "attributes": self._look(looked.attributes, "float", np.float32, (n, looked.attribute_count)),
            "light_groups": self._look(looked.light_groups, "float", np.float32, (looked.light_group_count, n, 3)),
            "errors": self._look(looked.errors, "float", np.float32, (n,)),
        }
        return MeshView(**looks)  # type: ignore[arg-type]

    @property
    def statistics(self) -> dict[str, Any]:
        """hemi_statistics by its names: statistics["error"]["estimate"]."""
        out = view("hemi_statistics")
        check(table().solution_statistics(self._handle, out))
        return as_dict(out[0])

    @property
    def curve(self) -> list[dict[str, Any]]:
        """Error against time, one dict a point."""
        points = []
        for index in range(table().solution_curve_count(self._handle)):
            point = view("hemi_curve_point")
            check(table().solution_curve_point(self._handle, index, point))
            points.append(as_dict(point[0]))
        return points
