# SPDX-License-Identifier: MIT
"""Blender add-on: File > Export > glTF baked with hemibake.

On Blender 4.4 and newer, Blender's own glTF exporter can bake too: its panel gets a box "Bake with hemibake".
"""

bl_info = {
    "name": "hemibake",
    "description": "Export glTF with global illumination in its vertex colours",
    "author": "hemibake",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "File > Export > glTF baked with hemibake",
    "category": "Import-Export",
}

import bpy

from . import export_hook, operator, preferences, settings, steering
from .export_hook import glTF2ExportUserExtension  # noqa: F401  Blender's exporter looks for it here

CLASSES = (preferences.HemibakePreferences, settings.HemibakeSettings, *operator.CLASSES, *steering.CLASSES)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.hemibake = bpy.props.PointerProperty(type=settings.HemibakeSettings)
    steering.register()
    bpy.types.TOPBAR_MT_file_export.append(operator.draw_menu)
    export_hook.register()


def unregister():
    export_hook.unregister()
    bpy.types.TOPBAR_MT_file_export.remove(operator.draw_menu)
    steering.unregister()
    del bpy.types.Scene.hemibake
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
