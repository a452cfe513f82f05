# SPDX-License-Identifier: MIT
"""What is done inside Blender? One task of blender_test.py; its result goes to a JSON file.

    blender -b --factory-startup -P inside.py -- TASK OUT_FOLDER
"""

import json
import os
import sys
import time
import traceback

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms
import window

TASK, FOLDER = sys.argv[sys.argv.index("--") + 1 :]


def use_program(path):
    bpy.context.preferences.addons["hemibake"].preferences.program = path


def export(name, **settings):
    """What the operator returned, or the error that it reported."""
    for key, value in settings.items():
        setattr(bpy.context.scene.hemibake, key, value)
    try:
        return sorted(bpy.ops.export_scene.hemibake(filepath=os.path.join(FOLDER, name)))
    except RuntimeError as e:
        return str(e).strip()


def compare(build, samples):
    walls = build()
    before = sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()), sorted(bpy.data.materials.keys())
    began = time.monotonic()
    result = export("room.glb", quality="medium", scene_linear=True, draco=False, report=True)
    baked = time.monotonic() - began
    after = sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()), sorted(bpy.data.materials.keys())
    truth = rooms.bake_with_cycles(walls, samples)
    return {"result": result, "left": before == after, "truth": truth, "seconds": [baked, time.monotonic() - began - baked],
            "walls": {name: rooms.WALLS[name][:3] for name in walls}}


def area():
    return compare(rooms.area_room, 512)


def lamps():
    return compare(rooms.lamp_room, 256)


def options():
    """Every choice of the panel, and what goes wrong."""
    rooms.area_room()
    quick = {"quality": "draft"}
    out = {"first": export("a.glb", **quick, report=True, preview=True)}
    out["gltf"] = export("b.gltf", report=False, preview=False, exposure_auto=False, exposure=-1.0, view="Filmic")
    out["bad view"] = export("c.glb", view="None such")
    out["bad folder"] = export("missing/d.glb", view="")
    out["time"] = export("e.glb", time=0.001)
    use_program("/nowhere/hemibake")
    out["no program"] = export("f.glb", time=0.0)
    use_program("")
    bpy.context.scene.hemibake.selection = True
    bpy.ops.object.select_all(action="DESELECT")
    for name in ("floor", "lamp"):
        bpy.data.objects[name].select_set(True)
    out["selection"] = export("g.glb", draco=False)
    bpy.context.scene.hemibake.selection = False
    for each in [each for each in bpy.data.objects if each.type == "LIGHT" or each.name == "panel"]:
        bpy.data.objects.remove(each)
    out["dark"] = export("h.glb")
    return out


def steering():
    rooms.area_room()
    floor = bpy.data.objects["floor"].hemibake_object
    floor.bake, floor.cast_shadow, floor.element_size, floor.normals = False, False, 0.25, "FACES"
    bpy.data.objects["panel"].active_material.hemibake_material.emission = 2.5
    out = {"result": export("steered.glb", quality="draft", draco=False)}
    floor.bake = True
    floor.element_size, floor.normals = 0.0, "FILE"
    bpy.ops.export_scene.gltf(filepath=os.path.join(FOLDER, "plain.glb"), export_format="GLB")
    return out


def cages():
    rooms.cage_room()
    out = {"applied": export("applied.glb", quality="draft", draco=False)}
    out["cage"] = export("cage.glb", subdivision_cage=True)
    out["modifiers"] = [bpy.data.objects["ball"].modifiers[0].show_viewport]
    bpy.data.objects["ball"].modifiers[0].levels = 1
    out["levels"] = export("no.glb")
    bpy.data.objects["ball"].modifiers.clear()
    out["without"] = export("no.glb")
    return out


# Of what io_scene_gltf2 of 4.4 hands to its hooks, what an extension may want.
EXPORT_SETTINGS = {
    "gltf_filedirectory": FOLDER, "gltf_format": "GLB", "gltf_yup": True, "gltf_apply": True, "gltf_draco_mesh_compression": False,
    "gltf_user_extensions": [], "gltf_animations": True, "log": None,
}


def call_hooks(path, *extensions):
    """As export_user_extensions("post_export_hook", export_settings) does; what was raised, which there is only logged."""
    settings = {**EXPORT_SETTINGS, "gltf_filepath": path, "gltf_user_extensions": extensions}
    raised = []
    for extension in settings["gltf_user_extensions"]:
        try:
            getattr(extension, "post_export_hook")(settings)
        except Exception as e:
            raised.append(f"{type(e).__name__}: {e}")
    return raised


def read(path):
    with open(path, "rb") as f:
        return f.read()


def hook():
    """What Blender 4.4's exporter would call, on files that this Blender's exporter wrote."""
    rooms.area_room()
    import hemibake
    from hemibake.export import mend_numpy

    mend_numpy()
    settings, path, apart = bpy.context.scene.hemibake, os.path.join(FOLDER, "hooked.glb"), os.path.join(FOLDER, "apart.gltf")
    settings.quality = "draft"
    bpy.ops.export_scene.gltf(filepath=path, export_format="GLB")
    bpy.ops.export_scene.gltf(filepath=apart, export_format="GLTF_SEPARATE")
    written = read(path)
    # The exporter looks for the class in the add-on's module, and makes one for each export.
    out = {"off": call_hooks(path, hemibake.glTF2ExportUserExtension()), "untouched": read(path) == written}
    settings.bake_on_export = True
    settings.view = "None such"
    out["bad view"] = call_hooks(path, hemibake.glTF2ExportUserExtension())
    settings.view = ""
    use_program("/nowhere/hemibake")
    out["no program"] = call_hooks(path, hemibake.glTF2ExportUserExtension())
    use_program("")
    out["missing"] = call_hooks(os.path.join(FOLDER, "missing.glb"), hemibake.glTF2ExportUserExtension())
    out["still untouched"] = read(path) == written and sorted(name for name in os.listdir(FOLDER) if name[0] != ".")
    out["on"] = call_hooks(path, hemibake.glTF2ExportUserExtension()) + call_hooks(apart, hemibake.glTF2ExportUserExtension())
    out["sizes"] = [len(written), os.path.getsize(path)]
    bpy.ops.preferences.addon_disable(module="hemibake")
    bpy.ops.preferences.addon_enable(module="hemibake")
    out["again"] = hasattr(bpy.types.Scene, "hemibake")
    return out


def panel():
    """The box in the exporter of 4.4, which calls draw(context, layout) for each entry of a dict."""
    rooms.empty()
    import io_scene_gltf2
    from hemibake import export_hook

    entries = io_scene_gltf2.exporter_extension_layout_draw = {"other": None}
    export_hook.HAS_HOOK = True
    export_hook.register()
    draw = entries["hemibake"]
    shown = {}
    for name, body in (("open", window.Recorder(row=window.Recorder())), ("closed", None)):
        header = window.Recorder()
        draw(bpy.context, window.Recorder(panel=(header, body)))
        shown[name] = [header.said("prop")[0][1]] + [arguments[1] for arguments in (body.said("prop") if body else [])]
    export_hook.unregister()
    return {**shown, "left": sorted(entries)}


def modal():
    """The operator as it works in a window."""
    rooms.area_room()
    settings = bpy.context.scene.hemibake
    settings.quality = "draft"
    out = {"whole": window.whole(os.path.join(FOLDER, "whole.glb"))}
    settings.view = "None such"
    out["refused"] = window.refused(os.path.join(FOLDER, "refused.glb"))
    settings.view = ""
    # Fine enough that no machine finishes before it is stopped.
    settings.element_size, settings.quality = 0.01, "high"
    out["escaped"] = window.escaped(os.path.join(FOLDER, "escaped.glb"))
    out["killed"] = window.killed(os.path.join(FOLDER, "killed.glb"))
    use_program("/nowhere/hemibake")
    out["not begun"] = window.not_begun(os.path.join(FOLDER, "none.glb"))
    return out


try:
    result = globals()[TASK]()
except BaseException:
    traceback.print_exc()
    sys.exit(1)
with open(os.path.join(FOLDER, TASK + ".json"), "w") as f:
    json.dump(result, f)
