# SPDX-License-Identifier: MIT
"""How does a scene get from Blender to the program? Blender's own glTF exporter writes what will be baked."""

import contextlib

import bpy

from . import cages, lamps


def mend_numpy():
    """The exporter of Blender 3.4 says numpy.bool, which numpy 1.24 (Debian's) no longer has."""
    import numpy

    if "bool" not in vars(numpy):
        numpy.bool = bool


def exported_meshes(context, selection_only):
    objects = context.selected_objects if selection_only else context.view_layer.objects
    return [each for each in objects if each.type == "MESH" and each.visible_get()]


def known(wishes):
    """Those arguments that this Blender's exporter has."""
    has = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
    return {name: value for name, value in wishes.items() if name in has}


def export_scene(context, path, settings):
    """Writes a .glb to bake; returns the options that belong to it."""
    mend_numpy()
    objects = exported_meshes(context, settings.selection)
    with contextlib.ExitStack() as stack:
        options = []
        if settings.subdivision_cage:
            options = stack.enter_context(cages.subdivisions_as_cages(objects))
        stack.enter_context(lamps.area_lamps_as_surfaces(context, settings.selection))
        bpy.ops.export_scene.gltf(**known({
            "filepath": path,
            "export_format": "GLB",
            "use_selection": settings.selection,
            "use_visible": True,
            "export_lights": True,
            "export_import_convert_lighting_mode": "COMPAT",
            "convert_lighting_mode": "COMPAT",
            "export_cameras": True,
            "export_extras": True,
            # Applying keeps shape keys from being exported, and makes cages of what is not applied.
            "export_apply": True,
            "export_draco_mesh_compression_enable": False,
        }))
    return options
