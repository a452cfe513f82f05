# SPDX-License-Identifier: MIT
"""What does a baked document say that its input does not, or no longer, beside what a bake is documented to change?

Documented: asset.generator and asset.extras.hemibake; one buffer; baked primitives with POSITION, COLOR_0 (_RADIOSITY),
their TEXCOORDs and custom attributes, and an unlit material (with --keep-pbr: all they had, and the material they had); images in the buffer; objects that only the replaced geometry
and materials named are gone; the lists of extensions follow. Everything else is a difference.
"""

DROPPED = {"NORMAL", "TANGENT", "COLOR_0"}
RENUMBERED = {"asset", "extensionsUsed", "extensionsRequired", "buffers", "bufferViews", "accessors", "meshes", "materials",
              "textures", "images", "samplers", "nodes", "skins", "animations"}


def differ(a, b, path, out):
    if isinstance(a, dict) and isinstance(b, dict):
        for key in sorted({*a, *b}, key=str):
            if key not in a or key not in b:
                out.append(f"{path}.{key} " + ("is new" if key in b else "is lost"))
            else:
                differ(a[key], b[key], f"{path}.{key}", out)
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            differ(x, y, f"{path}[{i}]", out)
    elif a != b or type(a) is not type(b):
        if a is not None or "bufferView" not in path:  # None: bytes that the input has packed
            out.append(f"{path}: {str(a)[:60]} became {str(b)[:60]}")


def without(value, *names):
    return {k: v for k, v in value.items() if k not in names}


def unknown_extensions(value):
    return {k: v for k, v in value.get("extensions", {}).items()
            if not k.startswith("KHR_materials_") and k != "KHR_draco_mesh_compression"}


def is_lit(document, primitive):
    if "_RADIOSITY" in primitive["attributes"]:
        return True
    if "material" not in primitive or "COLOR_0" not in primitive["attributes"]:
        return False
    return "KHR_materials_unlit" in document.list("materials")[primitive["material"]].get("extensions", {})


def check_material(before, after, path, out):
    """An unlit copy keeps what it can show, and what is not about shading."""
    for name in ("name", "extras"):
        differ(before.get(name), after.get(name), f"{path}.{name}", out)
    differ(unknown_extensions(before), unknown_extensions(after), f"{path}.extensions", out)
    shading = [k for k in after["extensions"] if k.startswith("KHR_materials_") and k != "KHR_materials_unlit"]
    if shading or "emissiveFactor" in after or "emissiveTexture" in after:
        out.append(f"{path} is unlit, but still has {shading or 'emission'}")
    texture = before.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    glossy = before.get("extensions", {}).get("KHR_materials_pbrSpecularGlossiness")
    if glossy:
        texture = glossy.get("diffuseTexture")
    kept = after.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    if kept is not None:
        differ(texture, kept, f"{path}.baseColorTexture", out)


def check_lit(a, b, before, after, path, out):
    differ(before.get("extras"), after.get("extras"), f"{path}.extras", out)
    differ(unknown_extensions(before), unknown_extensions(after), f"{path}.extensions", out)
    same_material = a.material(before.get("material")) == b.material(after.get("material"))
    had = set(before["attributes"]) - (set() if same_material else DROPPED)
    has = set(after["attributes"]) - {"_RADIOSITY"} - (set() if same_material else {"COLOR_0"})
    for name in sorted(had - has):
        if not name.startswith(("JOINTS_", "WEIGHTS_")):
            out.append(f"{path}.attributes.{name} is lost")
    for name in sorted(has - had):
        out.append(f"{path}.attributes.{name} is new")
    if not same_material:
        check_material(a.material(before.get("material")), b.material(after["material"]), f"{path}.material", out)


def check_mesh(a, b, before, after, path, out):
    """Returns how many primitives are gone: those without any triangle that has an area."""
    differ(without(before, "primitives"), without(after, "primitives"), path, out)
    left, gone = list(after["primitives"]), 0
    for i, primitive in enumerate(before["primitives"]):
        at = f"{path}.primitives[{i}]"
        if left and is_lit(b, left[0]) and not is_lit(a, primitive) and primitive.get("mode", 4) >= 4:
            check_lit(a, b, primitive, left.pop(0), at, out)
        elif left:
            found = []
            differ(a.primitive(primitive), b.primitive(left[0]), at, found)
            if found and is_lit(b, left[0]):
                check_lit(a, b, primitive, left[0], at, out)
            else:
                out += found
            left.pop(0)
        else:
            gone += 1
    if left:
        out.append(f"{path}: {len(left)} primitives are new")
    return gone


def check_nodes(a, b, out):
    gone = 0
    for i, (before, after) in enumerate(zip(a.list("nodes"), b.list("nodes"))):
        path, instanced = f"nodes[{i}]", False
        x, y = without(before, "mesh"), without(after, "mesh")
        if "EXT_mesh_gpu_instancing" in x.get("extensions", {}) and "EXT_mesh_gpu_instancing" not in y.get("extensions", {}):
            instanced = True
            x, y = without(x, "extensions", "children"), without(y, "extensions", "children")
        if "EXT_mesh_gpu_instancing" in x.get("extensions", {}):
            x, y = without(x, "extensions"), without(y, "extensions")
        differ(x, y, path, out)
        if "mesh" in before and "mesh" in after:
            gone += check_mesh(a, b, a.list("meshes")[before["mesh"]], b.list("meshes")[after["mesh"]], f"{path}.mesh", out)
        elif "mesh" in before and not instanced:
            gone += len(a.list("meshes")[before["mesh"]]["primitives"])
        elif "mesh" in after:
            out.append(f"{path}.mesh is new")
    if len(b.list("nodes")) < len(a.list("nodes")):
        out.append("nodes are lost")
    return gone


def check_unused(a, b, out):
    """Materials that no primitive uses, and meshes that no node shows, are still there."""
    used = {p.get("material") for mesh in a.list("meshes") for p in mesh["primitives"]}
    there = [b.material(i) for i in range(len(b.list("materials")))]
    for i in range(len(a.list("materials"))):
        if i not in used and a.material(i) not in there:
            out.append(f"materials[{i}], which nothing uses, is lost")
    shown = {node.get("mesh") for node in a.list("nodes")}
    if len(b.list("meshes")) < sum(i not in shown for i in range(len(a.list("meshes")))):
        out.append("a mesh that no node shows is lost")


def check_asset(a, b, out):
    before, after = without(a.json["asset"], "generator"), without(b.json["asset"], "generator")
    extras = without(after.get("extras", {}), "hemibake")
    after = without(after, "extras") if not extras and "extras" not in before else {**after, "extras": extras}
    differ(before, after, "asset", out)


def differences(a, b):
    """(undocumented changes, primitives without area that are gone)"""
    out = []
    check_asset(a, b, out)
    differ(without(a.json, *RENUMBERED), without(b.json, *RENUMBERED), "", out)
    gone = check_nodes(a, b, out)
    differ(a.skins(), b.skins(), "skins", out)
    differ(a.animations(), b.animations(), "animations", out)
    check_unused(a, b, out)
    return out, gone
