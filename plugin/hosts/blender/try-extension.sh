#!/bin/sh
# SPDX-License-Identifier: MIT
# Does the extension work in Blender as pip has it (bpy)? Installs it there as its preferences would, and exports a small room.
#
#     sh plugin/hosts/blender/try-extension.sh [VERSION ...]      default: 4.2.23 4.5.15 5.0.1; some 400 MB each
#
# $HEMIBAKE_BPY_PYTHON: the Python that bpy of these versions is for (3.11). $HEMIBAKE: the command. Not run by CTest.
set -eu

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd -P)
root=$(CDPATH='' cd -- "$here/../../.." && pwd -P)
[ $# -gt 0 ] || set -- 4.2.23 4.5.15 5.0.1
program=${HEMIBAKE:-$root/build/release/bin/hemibake}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sh "$here/build-extension.sh" "$work/hemibake.zip" >/dev/null
cat >"$work/try.py" <<'END'
import bpy, json, os, struct, sys

folder, program = sys.argv[1:]
bpy.ops.extensions.package_install_files(filepath=os.path.join(folder, "hemibake.zip"), repo="user_default", enable_on_install=True, overwrite=True)
bpy.context.preferences.addons["bl_ext.user_default.hemibake"].preferences.program = program
for old in list(bpy.data.objects):
    bpy.data.objects.remove(old)
bpy.ops.mesh.primitive_cube_add(size=2)
bpy.context.object.name = "cube"
bpy.ops.mesh.primitive_plane_add(size=6, location=(0, 0, -1))
floor = bpy.context.object
floor.data.materials.append(bpy.data.materials.new("floor"))
floor.hemibake_object.element_size = 0.5
bpy.data.objects["cube"].hemibake_object.bake = bpy.data.objects["cube"].hemibake_object.cast_shadow = False
floor.active_material.hemibake_material.emission = 2.0
bpy.ops.object.light_add(type="AREA", location=(0, 0, 3))
bpy.context.scene.hemibake.quality = "draft"
out = os.path.join(folder, "out.glb")
assert bpy.ops.export_scene.hemibake(filepath=out) == {"FINISHED"}
with open(out, "rb") as f:
    written = f.read()
assert b"KHR_materials_unlit" in written
document = json.loads(written[20 : 20 + struct.unpack("<I", written[12:16])[0]])
asked = {one["name"]: one["extras"]["hemibake"] for kind in ("nodes", "materials") for one in document[kind] if "hemibake" in one.get("extras", {})}
assert asked == {"cube": {"bake": False, "castShadow": False}, "Plane": {"elementSize": 0.5}, "floor": {"emission": 2.0}}, asked
cube = next(document["meshes"][node["mesh"]] for node in document["nodes"] if node["name"] == "cube")
assert "COLOR_0" not in cube["primitives"][0]["attributes"], "it is not to be baked"
print("tried: bpy", bpy.app.version_string, flush=True)
os._exit(0)  # as a module bpy crashes now and then when Python lets go of it
END
for version in "$@"; do
  "${HEMIBAKE_BPY_PYTHON:-python3.11}" -m venv "$work/$version"
  "$work/$version/bin/pip" install --quiet "bpy==$version"
  rm -f "$work/out.glb"
  HOME=$work "$work/$version/bin/python" "$work/try.py" "$work" "$program" >"$work/said" 2>&1 || { cat "$work/said" >&2; exit 1; }
  grep '^tried' "$work/said"
  rm -rf "${work:?}/$version"
done
