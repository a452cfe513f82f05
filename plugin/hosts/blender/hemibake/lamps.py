# SPDX-License-Identifier: MIT
"""How do area lamps leave Blender? glTF has none; so each becomes a surface that emits, for as long as the export takes.

An area lamp of P watts and area A has the radiance P / (4 A) in Cycles. (Measured: P / (pi A), which a Lambertian emitter of P
watts has, is 4 / pi too bright.) Points, spots and the sun are exported as lights in watts per steradian and per square metre (the
exporter's "COMPAT"), the unit that emission has too. Lamps of Cycles block no light; these surfaces do.
"""

import contextlib
import math

import bpy
from mathutils import Vector

CORNERS = 32  # of a disk; its area is set to the lamp's, whatever the polygon


def outline(light):
    """Corners in the lamp's own frame, counter-clockwise as seen from where it shines, along -z."""
    width = light.size
    height = light.size_y if light.shape in {"RECTANGLE", "ELLIPSE"} else light.size
    if light.shape in {"SQUARE", "RECTANGLE"}:
        return [(-width / 2, -height / 2), (-width / 2, height / 2), (width / 2, height / 2), (width / 2, -height / 2)]
    # A regular polygon has the area n/2 sin(2 pi / n) r^2.
    swell = math.sqrt(math.pi / (CORNERS / 2 * math.sin(2 * math.pi / CORNERS)))
    turns = [-2 * math.pi * i / CORNERS for i in range(CORNERS)]
    return [(swell * width / 2 * math.cos(a), swell * height / 2 * math.sin(a)) for a in turns]


def world_area(corners, matrix):
    """Of the outline once it stands in the world."""
    points = [matrix @ Vector((x, y, 0)) for x, y in corners]
    total = points[0] * 0
    for a, b in zip(points, points[1:] + points[:1]):
        total += a.cross(b)
    return total.length / 2


def emitter_material(name, radiance):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0, 0, 0, 1)
    color = "Emission" if "Emission" in shader.inputs else "Emission Color"
    strength = max(radiance)
    shader.inputs[color].default_value = (*[c / strength if strength else 0 for c in radiance], 1)
    shader.inputs["Emission Strength"].default_value = strength
    return material


def emitter(lamp, matrix):
    """An object that shines as the lamp does."""
    light = lamp.data
    corners = outline(light)
    area = world_area(corners, matrix)
    scale = light.energy / (4 * area) if area else 0
    name = f"{lamp.name} (hemibake)"
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(x, y, 0) for x, y in corners], [], [tuple(range(len(corners)))])
    mesh.materials.append(emitter_material(name, [c * scale for c in light.color]))
    out = bpy.data.objects.new(name, mesh)
    out.matrix_world = matrix
    return out


@contextlib.contextmanager
def area_lamps_as_surfaces(context, selection_only):
    """Within, area lamps that would be exported have emitting surfaces in their places."""
    made = []
    graph = context.evaluated_depsgraph_get()
    lamps = [
        each for each in context.view_layer.objects
        if each.type == "LIGHT" and each.data.type == "AREA" and each.visible_get() and (each.select_get() or not selection_only)
    ]
    try:
        for lamp in lamps:
            made.append(emitter(lamp, lamp.evaluated_get(graph).matrix_world.copy()))
            context.scene.collection.objects.link(made[-1])
            made[-1].select_set(selection_only)
        yield
    finally:
        for each in made:
            mesh, material = each.data, each.data.materials[0]
            bpy.data.objects.remove(each)
            bpy.data.meshes.remove(mesh)
            bpy.data.materials.remove(material)
