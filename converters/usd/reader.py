# SPDX-License-Identifier: MIT
"""Which prims of a stage are baked? The walk through the composed stage: what is active, defined, visible and of purpose default or
render, with the inside of an instance read once for all instances alike."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdLux, UsdShade

from . import lights, mesh, shapes
from .glb import Glb
from .instancer import read_copies
from .items import Camera, Item
from .materials import GONE, Materials
from .stage import Source
from .surfaces import Color

PURPOSES = ("default", "render")
UNREAD = ("BasisCurves", "NurbsCurves", "HermiteCurves", "Points", "NurbsPatch", "TetMesh", "Volume")
IDENTITY = Gf.Matrix4d(1)
COLLECTION_BINDING = "material:binding:collection:"
PROXIES = Usd.TraverseInstanceProxies()
UNDEFINED = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)


@dataclasses.dataclass(frozen=True)
class Inherited:
    """What a prim gets from above: its purpose, which prims bind materials and colours for it, and which bind by collections; and whether
    it is below an over or a class, where prototypes are kept from whoever walks the stage."""

    purpose: str = "default"
    binding: str = ""
    color: str = ""
    collections: tuple[str, ...] = ()
    is_kept: bool = False


class Reader:
    """Turns prims into items and puts their meshes into the GLB."""

    def __init__(self, source: Source, glb: Glb) -> None:
        self.source, self.glb = source, glb
        self.time, self.losses = source.time, source.losses
        self.materials = Materials(glb, source.time, source.losses)
        self.gprims = 0
        self._inside: dict[tuple[str, Inherited, Any], list[Item]] = {}
        self._collections: dict[str, list[Any]] = {}
        self._shapes: dict[Any, int] = {}
        self.instancers: list[Any] = []  # whose prototypes are being read

    def read(self) -> list[Item]:
        return self._children(self.source.stage.GetPseudoRoot(), Inherited())

    # ---- the walk ------------------------------------------------------------------------------------------------------

    def _children(self, prim: Any, above: Inherited) -> list[Item]:
        found = prim.GetFilteredChildren(UNDEFINED if above.is_kept else PROXIES)
        if above.is_kept:
            found = [child for child in found if child.GetSpecifier() == Sdf.SpecifierDef]
        if prim.HasAPI("LODRootAPI"):
            found = self._one_level(prim, found)
        return [item for item in (self.item(child, above) for child in found) if item]

    def _one_level(self, prim: Any, children: list[Any]) -> list[Any]:
        """Children of an LODRootAPI exclude each other."""
        index = prim.GetAttribute("lod:default:index")
        number = int((index.Get(self.time) if index else 0) or 0)
        levels = [child for child in children if child.IsA(UsdGeom.Imageable)]
        return levels[number : number + 1] if 0 <= number < len(levels) else levels[:1]

    def item(self, prim: Any, above: Inherited, with_matrix: bool = True) -> Item | None:
        """None: there is nothing to bake in it or below."""
        if prim.IsA(UsdShade.Material) or prim.IsA(UsdShade.NodeGraph) or prim.IsA(UsdShade.Shader):
            return None
        # What is not authored need not be asked for, of ten thousand instances.
        names = prim.GetAuthoredPropertyNames()
        if "visibility" in names and prim.IsA(UsdGeom.Imageable) and UsdGeom.Imageable(prim).GetVisibilityAttr().Get(self.time) == "invisible":
            return None
        here = self._inherit(prim, above, names)
        out = Item(prim.GetName())
        if with_matrix and "xformOpOrder" in names and prim.IsA(UsdGeom.Xformable):
            try:
                self._place(prim, out)
            except (ValueError, TypeError, Tf.ErrorException):
                self.losses.add(prim, "its transform is left out, an operation of it is of a wrong type or not there")
        if prim.IsA(UsdGeom.PointInstancer):
            if here.purpose in PURPOSES:
                out.copies = self._copies(prim, here)
            return None if out.is_empty() else out
        if here.purpose in PURPOSES and not (here.purpose == "render" and self._is_hidden_in_renders(prim)):
            try:
                self._content(prim, out)
            except (ValueError, TypeError, IndexError, OverflowError, Tf.ErrorException) as fault:
                # An attribute of another type than its schema's, or numbers that fit nothing.
                self.losses.add(prim, f"not baked, it cannot be read: {str(fault)[:160]}")
        out.children = self._below(prim, here)
        return None if out.is_empty() else out

    def _is_hidden_in_renders(self, prim: Any) -> bool:
        """By VisibilityAPI, which can hide a purpose alone."""
        imageable = UsdGeom.Imageable(prim)
        return bool(imageable) and hasattr(imageable, "ComputeEffectiveVisibility") and imageable.ComputeEffectiveVisibility("render", self.time) == "invisible"

    def _copies(self, prim: Any, here: Inherited) -> list[Any]:
        try:
            return read_copies(self, prim, here)
        except (ValueError, TypeError, IndexError, OverflowError, Tf.ErrorException) as fault:
            self.losses.add(prim, f"not baked, it cannot be read: {str(fault)[:160]}")
            return []

    def _below(self, prim: Any, here: Inherited) -> list[Item]:
        if not prim.IsInstance():
            return self._children(prim, here)
        key = (str(prim.GetPrototype().GetPath()), here, self._membership(prim, here))
        if key not in self._inside:
            self._inside[key] = self._children(prim, here)
        return self._inside[key]

    def _membership(self, prim: Any, here: Inherited) -> tuple[Any, ...]:
        """Which of the collections above that bind materials an instance is in: instances that differ in it look different, and one
        that a collection names a part of is like no other."""
        path, out = prim.GetPath(), []
        for owner in here.collections:
            for query, named in self._queries(owner):
                out.append(str(path) if any(n.HasPrefix(path) and n != path for n in named) else bool(query.IsPathIncluded(path)))
        return tuple(out)

    def _queries(self, owner: str) -> list[Any]:
        """(membership, paths it names) of the collections that a prim binds materials by."""
        if owner not in self._collections:
            prim, found = self.source.stage.GetPrimAtPath(owner), []
            for relationship in prim.GetProperties():
                if relationship.GetName().startswith(COLLECTION_BINDING):
                    query = UsdShade.MaterialBindingAPI.CollectionBinding(relationship).GetCollection().ComputeMembershipQuery()
                    found.append((query, [Sdf.Path(path) for path in query.GetAsPathExpansionRuleMap()]))
            self._collections[owner] = found
        return self._collections[owner]

    def _inherit(self, prim: Any, above: Inherited, names: list[str]) -> Inherited:
        """names: of its authored properties."""
        purpose, binding, color, collections = above.purpose, above.binding, above.color, above.collections
        if "purpose" in names and prim.IsA(UsdGeom.Imageable):
            purpose = str(UsdGeom.Imageable(prim).GetPurposeAttr().Get())
        if not any(name.startswith(("material:binding", "primvars:")) for name in names):
            return above if purpose == above.purpose else dataclasses.replace(above, purpose=purpose)
        if any(name.startswith("material:binding") for name in names):
            binding = str(prim.GetPath())
        if any(name.startswith(COLLECTION_BINDING) for name in names):
            collections = (*collections, str(prim.GetPath()))
        if any(name.startswith("primvars:") for name in names):
            color = str(prim.GetPath())
        return Inherited(purpose, binding, color, collections, above.is_kept)

    def _place(self, prim: Any, out: Item) -> None:
        xformable = UsdGeom.Xformable(prim)
        out.resets = bool(xformable.GetResetXformStack())
        matrix = xformable.GetLocalTransformation(self.time)
        if matrix == IDENTITY:
            return
        rows = np.array(matrix)
        if math.isfinite(rows.sum()):
            out.matrix = rows
        else:
            self.losses.add(prim, "its transform is not finite and is left out")

    # ---- what a prim is ------------------------------------------------------------------------------------------------

    def _content(self, prim: Any, out: Item) -> None:
        kind = str(prim.GetTypeName())
        if kind == "Mesh":
            out.mesh = self._mesh(prim)
        elif prim.IsA(UsdGeom.Gprim):
            out.mesh = self._shape(prim, kind)
        elif kind == "Camera":
            out.camera = self._camera(prim)
        elif lights.is_light(prim):
            out.light = lights.read(prim, self.time, self.losses)
        elif kind in UNREAD:
            self.losses.add(prim, f"not baked, {kind} is not read")
        elif kind and not prim.GetPrimTypeInfo().GetSchemaTypeName():
            self.losses.add(prim, f"not read, there is no schema {kind} here")

    def _emission(self, prim: Any, body: mesh.Faces | shapes.Triangles) -> Any:
        """Of a gprim with MeshLightAPI: what it gives and how its material answers; None: it is no light. Triangles inside a round
        shape give the power of all of it."""
        if not lights.is_light(prim):
            return None
        lights.note_losses(prim, self.time, self.losses)
        mode = prim.GetAttribute("light:materialSyncMode")
        radiance = lights.radiance_of(prim, self.time)
        world = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(self.time))
        area = shapes.area(mesh.triangles_of(body) if isinstance(body, mesh.Faces) else body, world)
        whole = area if isinstance(body, mesh.Faces) else shapes.true_area(prim, self.time, world)
        scale = (1 if UsdLux.LightAPI(prim).GetNormalizeAttr().Get(self.time) else whole) / area if area > 0 else 0.0
        radiance = tuple(c * scale for c in radiance)
        if prim.HasAPI(UsdLux.ShapingAPI):
            self.losses.add(prim, "shaping of a mesh light is not read")
        return radiance, str(mode.Get() if mode else "materialGlowTintsLight")

    def _material_index(self, prim: Any, material: Any, double_sided: bool, light: Any) -> int:
        if light is None:
            return self.materials.index(material, double_sided)
        radiance, mode = light
        glow: Color = material.emission
        bound = self.materials.bound(prim) is not None
        if mode == "independent":
            radiance = tuple(a + b for a, b in zip(radiance, glow))
        elif mode == "materialGlowTintsLight" and bound:
            radiance = tuple(a * b for a, b in zip(radiance, glow))
        return self.materials.index(material, double_sided, radiance, mode != "noMaterialResponse" and bound)

    def _mesh(self, prim: Any) -> int:
        faces = mesh.read_faces(prim, self.time, self.losses)
        if not faces:
            return -1
        if prim.GetRelationship("skel:skeleton").GetTargets() or prim.GetAttribute("primvars:skel:jointIndices").HasAuthoredValue():
            self.losses.add(prim, "skinned; baked at rest")
        light = self._emission(prim, faces)
        if light and faces.scheme != "none" and UsdLux.LightAPI(prim).GetNormalizeAttr().Get(self.time):
            self.losses.add(prim, "normalize counts the area of its control cage")
        double_sided = bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get(self.time))
        parts = self.materials.parts(prim, len(faces.topology.counts))
        made = mesh.primitives(faces, parts, self.time, self.losses)
        members = [self._primitive(p, self._material_index(prim, p.material, double_sided, light)) for p in made]
        self.gprims += bool(members)
        return self.glb.append("meshes", {"name": prim.GetName(), "primitives": members}) if members else -1

    def _primitive(self, made: mesh.Primitive, material: int) -> dict[str, Any]:
        attributes = {"POSITION": self.glb.accessor(made.positions, bounds=True)}
        if made.normals is not None:
            attributes["NORMAL"] = self.glb.accessor(made.normals)
        for n, texcoord in enumerate(made.texcoords):
            attributes[f"TEXCOORD_{n}"] = self.glb.accessor(np.ascontiguousarray(texcoord, np.float32))
        if made.colors is not None:
            attributes["COLOR_0"] = self.glb.accessor(np.ascontiguousarray(np.clip(made.colors, 0, 1), np.float32))
        out: dict[str, Any] = {"attributes": attributes, "indices": self.glb.accessor(np.ascontiguousarray(made.triangles.ravel(), np.uint32)), "material": material}
        if made.cage:
            out["extras"] = {"hemibake_subdivision": made.cage}
        if made.ngons:
            out["extensions"] = {"FB_ngon_encoding": {}}
            self.glb.use("FB_ngon_encoding")
        return out

    def _shape(self, prim: Any, kind: str) -> int:
        made = shapes.of_prim(prim, self.time) if kind not in UNREAD else None
        if made is None:
            self.losses.add(prim, f"not baked, {kind} is not read")
            return -1
        if not np.isfinite(made[0]).all() or not shapes.area(made) > 0 or shapes.is_inside_out(prim, self.time):
            self.losses.add(prim, "not baked, a size of it is not above 0, or not finite")
            return -1
        material = self.materials.bound(prim) or self.materials.unbound(prim)
        if material.coordinates:
            self.losses.add(prim, "a shape without points has no texture coordinates")
        material = self.materials.in_one_color(prim, material)
        double_sided = bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get(self.time))
        if material.mode == GONE:
            return -1
        light = self._emission(prim, made)
        index = self._material_index(prim, material, double_sided, light)
        key = (made[0].tobytes(), index)
        if key not in self._shapes:
            points, triangles, normals = shapes.smooth_normals(made)
            coordinates = [np.broadcast_to(np.float32(mesh.UNCONNECTED) * [1, -1] + [0, 1], (len(points), 2)) for _ in material.coordinates]
            primitive = mesh.Primitive(points, triangles, coordinates, None, material, normals=normals)
            self.gprims += 1
            self._shapes[key] = self.glb.append("meshes", {"name": kind, "primitives": [self._primitive(primitive, index)]})
        return self._shapes[key]

    def _camera(self, prim: Any) -> Camera | None:
        """Focal length and apertures are in the same unit, so only their ratios count."""
        seen = UsdGeom.Camera(prim).GetCamera(self.time)
        near, far = seen.clippingRange.min, seen.clippingRange.max
        width, height = seen.horizontalAperture, seen.verticalAperture
        if not (width > 0 and height > 0 and seen.focalLength > 0 and math.isfinite(far)):
            self.losses.add(prim, "a camera without an angle of view is left out")
            return None
        if seen.projection == seen.Orthographic:
            # An aperture is in tenths of a unit of the stage.
            return Camera({"type": "orthographic", "orthographic": {"xmag": width / 20, "ymag": height / 20, "znear": max(near, 0.0), "zfar": max(far, near + 1e-3)}})
        perspective = {"yfov": 2 * math.atan(height / 2 / seen.focalLength), "aspectRatio": width / height, "znear": max(near, 1e-4)}
        if far > perspective["znear"]:
            perspective["zfar"] = far
        return Camera({"type": "perspective", "perspective": perspective})

