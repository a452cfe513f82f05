# SPDX-License-Identifier: MIT
"""What does one object or one material ask of a bake? Properties of their own panels, which leave Blender as extras.hemibake."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty


class HemibakeObject(bpy.types.PropertyGroup):
    bake: BoolProperty(name="Bake", description="Off: it stays as it is, lit by the viewer", default=True)
    cast_shadow: BoolProperty(name="Stands in the Way", description="Of what is not baked: whether it takes light from the rest", default=True)
    element_size: FloatProperty(
        name="Element Size", description="Target edge of its elements; 0: that of the bake", default=0.0, min=0.0, unit="LENGTH"
    )
    normals: EnumProperty(
        name="Normals", description="By which light is received",
        items=[("FILE", "Smooth", "Those of the mesh"), ("FACES", "Faces", "Those of its facets")], default="FILE",
    )

    def extras(self):
        """Only what is not as ever."""
        out = {} if self.bake else {"bake": False}
        if not self.bake and not self.cast_shadow:
            out["castShadow"] = False
        if self.element_size > 0.0:
            out["elementSize"] = self.element_size
        if self.normals == "FACES":
            out["normals"] = "faces"
        return out


class HemibakeMaterial(bpy.types.PropertyGroup):
    emission: FloatProperty(name="Emission", description="What it emits is multiplied by this in the bake", default=1.0, min=0.0, soft_max=100.0)

    def extras(self):
        return {} if self.emission == 1.0 else {"emission": self.emission}


class ObjectPanel(bpy.types.Panel):
    bl_idname = "OBJECT_PT_hemibake"
    bl_label = "hemibake"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.object is not None

    def draw(self, context):
        own = context.object.hemibake_object
        self.layout.use_property_split = True
        self.layout.prop(own, "bake")
        row = self.layout.row()
        row.enabled = not own.bake
        row.prop(own, "cast_shadow")
        self.layout.prop(own, "element_size")
        self.layout.prop(own, "normals")


class MaterialPanel(bpy.types.Panel):
    bl_idname = "MATERIAL_PT_hemibake"
    bl_label = "hemibake"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.material is not None

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.prop(context.material.hemibake_material, "emission")


CLASSES = (HemibakeObject, HemibakeMaterial, ObjectPanel, MaterialPanel)
GROUPS = ((bpy.types.Object, "hemibake_object", HemibakeObject), (bpy.types.Material, "hemibake_material", HemibakeMaterial))


def add_extras(exported, group):
    """To a node or material that Blender's exporter has made."""
    extras = group.extras()
    if extras:
        exported.extras = {**(exported.extras or {}), "hemibake": extras}


def register():
    for kind, name, group in GROUPS:
        setattr(kind, name, bpy.props.PointerProperty(type=group))


def unregister():
    for kind, name, _ in GROUPS:
        delattr(kind, name)
