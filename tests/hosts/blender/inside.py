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
    result = export("room.glb", quality="high", scene_linear=True, draco=False, report=True)
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
    out["time"] = export("e.glb", time=0.01, element_size=0.02)
    use_program("/nowhere/hemibake")
    out["no program"] = export("f.glb", time=0.0, element_size=0.0)
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


def hook():
    """What Blender 4.4's exporter would call, on a file that this Blender's exporter wrote."""
    rooms.area_room()
    from hemibake import export_hook

    path = os.path.join(FOLDER, "hooked.glb")
    bpy.context.scene.hemibake.quality = "draft"
    from hemibake.export import mend_numpy

    mend_numpy()
    bpy.ops.export_scene.gltf(filepath=path, export_format="GLB")
    extension = export_hook.glTF2ExportUserExtension()
    extension.post_export_hook({"gltf_filepath": path})
    untouched = os.path.getsize(path)
    bpy.context.scene.hemibake.bake_on_export = True
    extension.post_export_hook({"gltf_filepath": path})
    out = {"untouched": untouched, "baked": os.path.getsize(path), "fault": None}
    try:
        extension.post_export_hook({"gltf_filepath": os.path.join(FOLDER, "missing.glb")})
    except RuntimeError as e:
        out["fault"] = str(e)
    bpy.ops.preferences.addon_disable(module="hemibake")
    bpy.ops.preferences.addon_enable(module="hemibake")
    out["again"] = hasattr(bpy.types.Scene, "hemibake")
    return out


try:
    result = globals()[TASK]()
except BaseException:
    traceback.print_exc()
    sys.exit(1)
with open(os.path.join(FOLDER, TASK + ".json"), "w") as f:
    json.dump(result, f)
