# SPDX-License-Identifier: MIT
"""How does Blender's own glTF exporter bake? From 4.4 on it calls post_export_hook once its file is written. Before that no hook
comes after the writing, and the operator of this add-on is the way."""

import bpy

from . import preferences, steering
from .program import bake_in_place
from .settings import arguments

HAS_HOOK = bpy.app.version >= (4, 4, 0)


class glTF2ExportUserExtension:
    """Blender's exporter makes one for each export."""

    def gather_node_hook(self, node, blender_object, _settings):
        if isinstance(blender_object, bpy.types.Object):
            steering.add_extras(node, blender_object.hemibake_object)

    def gather_material_hook(self, material, blender_material, _settings):
        steering.add_extras(material, blender_material.hemibake_material)

    def post_export_hook(self, export_settings):
        settings = bpy.context.scene.hemibake
        if not settings.bake_on_export:
            return
        fault = bake_exported(bpy.context, export_settings["gltf_filepath"], settings)
        if fault:
            # The exporter only logs what is raised here; a window says it where it is seen.
            show_error(fault)
            raise RuntimeError(fault)


def bake_exported(context, path, settings):
    """What is wrong, or None."""
    program = preferences.find_program(context)
    if not program:
        return "hemibake is not found: say where it is in the preferences of the add-on"
    manager = context.window_manager
    manager.progress_begin(0, 100)
    try:
        run = bake_in_place(program, path, arguments(settings, path), lambda share: manager.progress_update(100 * share))
    finally:
        manager.progress_end()
    return run.fault()


def show_error(text):
    if not bpy.app.background:
        bpy.context.window_manager.popup_menu(lambda menu, _: menu.layout.label(text=text), title="hemibake", icon="ERROR")


def draw_in_exporter(context, layout):
    settings = context.scene.hemibake
    header, body = layout.panel("HEMIBAKE_export", default_closed=True)
    header.prop(settings, "bake_on_export")
    if body:
        settings.draw(body)


def register():
    if HAS_HOOK:
        from io_scene_gltf2 import exporter_extension_layout_draw

        exporter_extension_layout_draw["hemibake"] = draw_in_exporter


def unregister():
    if HAS_HOOK:
        from io_scene_gltf2 import exporter_extension_layout_draw

        exporter_extension_layout_draw.pop("hemibake", None)
