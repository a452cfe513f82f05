# SPDX-License-Identifier: MIT
"""How long does Cycles take to bake a glTF file to vertex colours? Runs inside Blender:

    blender -b --factory-startup --python-exit-code 1 -P cycles_bake.py -- IN.glb OUT.glb FACTS.json VERTICES SAMPLES THREADS [R,G,B]

Faces are cut to about VERTICES vertices in all, and diffuse light (direct, indirect, with colour) is baked to them on the
processor: no denoiser, no clamping, backs black, bounces to where less than a thousandth of the light is left. R,G,B: radiance of a sky, black without. All meshes are
one object, because Cycles prepares the scene anew for every object it bakes. OUT.glb holds radiance in _RADIOSITY, as
`hemibake bake --scene-linear` writes it; FACTS.json the seconds of the bake alone, without Blender's start or the import.
"""

import json
import math
import sys
import time

import bpy
import numpy

sys.path.insert(0, __file__.rsplit("/", 1)[0])
from radiance_glb import write_radiance  # noqa: E402 (Blender does not look beside the script)

# Paths go on for at most so many bounces: 0.73, the lightest of the scenes' walls, to the 24th is 0.0005. Roulette ends most
# of them sooner, without bias, from the second on.
BOUNCES = 24
ROULETTE_FROM = 2

COLOR_NAME = "light"


def import_triangles(path):
    """Corners in the world (Blender's axes), [triangle, corner, axis], and the material of each."""
    if "bool" not in vars(numpy):
        numpy.bool = bool  # Blender 3.4's importer says numpy.bool, which numpy 1.24 no longer has
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    corners, materials, objects = [], [], []
    for number, each in enumerate(sorted((o for o in bpy.data.objects if o.type == "MESH"), key=lambda o: o.name)):
        mesh = each.data
        mesh.calc_loop_triangles()
        for triangle in mesh.loop_triangles:
            corners.append([each.matrix_world @ mesh.vertices[v].co for v in triangle.vertices])
            materials.append(mesh.materials[triangle.material_index])
            objects.append(number)
        each.hide_render = True
    return numpy.array(corners, dtype=float), materials, numpy.array(objects)


def parts_of(corners, edge):
    """Into how many parts each side of each triangle is cut so that none is longer than edge."""
    sides = numpy.linalg.norm(corners - numpy.roll(corners, 1, axis=1), axis=2)
    # Cut by the shorter two sides: the longest of a halved rectangle is a diagonal, which no denser rows make better.
    return numpy.maximum(numpy.ceil(numpy.sort(sides, axis=1)[:, 1] / edge - 1e-9), 1).astype(int)


def cut(corners, objects, edge):
    """Vertices, triangles and the input triangle of each; vertices are shared within a plane of an object, not across."""
    index, vertices, triangles, source = {}, [], [], []
    scale = numpy.abs(corners).max()
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= numpy.linalg.norm(normals, axis=1, keepdims=True)
    for t, (parts, (a, b, c)) in enumerate(zip(parts_of(corners, edge), corners)):
        plane = (int(objects[t]), *numpy.round(normals[t], 4))

        def vertex(i, j):
            x = a + (b - a) * (i / parts) + (c - a) * (j / parts)
            key = (plane, *numpy.round(x / scale, 6))
            if key not in index:
                index[key] = len(vertices)
                vertices.append(x)
            return index[key]

        for i in range(parts):
            for j in range(parts - i):
                triangles.append((vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)))
                source.append(t)
                if i + j + 1 < parts:
                    triangles.append((vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)))
                    source.append(t)
    return numpy.array(vertices), numpy.array(triangles), source


def cut_to_count(corners, objects, wanted):
    """The edge length that gives the wanted number of vertices, to a twentieth where the input is not already finer."""
    area = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    low, high = 0.3 * math.sqrt(area / wanted), numpy.ptp(corners, axis=(0, 1)).max()
    best = cut(corners, objects, high)
    for _ in range(12):
        if abs(len(best[0]) - wanted) <= 0.05 * wanted:
            break
        middle = math.sqrt(low * high)
        best = cut(corners, objects, middle)
        low, high = (middle, high) if len(best[0]) > wanted else (low, middle)
    return best


def one_sided(material):
    """Lambert's law and emission on the front, black behind, instead of the importer's node tree."""
    tree = material.node_tree
    principled = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
    base = tuple(principled.inputs["Base Color"].default_value)
    light = tuple(principled.inputs["Emission"].default_value)
    strength = principled.inputs["Emission Strength"].default_value
    tree.nodes.clear()
    new, link = tree.nodes.new, tree.links.new
    diffuse, emission, black = new("ShaderNodeBsdfDiffuse"), new("ShaderNodeEmission"), new("ShaderNodeBsdfDiffuse")
    front, sided, side, output = (new("ShaderNodeAddShader"), new("ShaderNodeMixShader"), new("ShaderNodeNewGeometry"),
                                  new("ShaderNodeOutputMaterial"))
    diffuse.inputs["Color"].default_value = base
    diffuse.inputs["Roughness"].default_value = 0.0
    black.inputs["Color"].default_value = (0, 0, 0, 1)
    emission.inputs["Color"].default_value = light
    emission.inputs["Strength"].default_value = strength
    link(diffuse.outputs[0], front.inputs[0])
    emits = strength > 0 and max(light[:3]) > 0
    if emits:
        link(emission.outputs[0], front.inputs[1])
    link(side.outputs["Backfacing"], sided.inputs[0])
    link((front if emits else diffuse).outputs[0], sided.inputs[1])
    link(black.outputs[0], sided.inputs[2])
    link(sided.outputs[0], output.inputs["Surface"])
    return [strength * light[k] if emits else 0.0 for k in range(3)]


def build_object(vertices, triangles, materials):
    """One flat-shaded object to bake, its colours a float rgba a vertex; returns it and what each slot emits."""
    mesh = bpy.data.meshes.new("scene")
    mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
    slots = {name: k for k, name in enumerate(sorted({m.name for m in materials}))}
    emissions = [one_sided(bpy.data.materials[name]) for name in slots]
    for name in slots:
        mesh.materials.append(bpy.data.materials[name])
    mesh.polygons.foreach_set("material_index", [slots[m.name] for m in materials])
    mesh.color_attributes.new(COLOR_NAME, "FLOAT_COLOR", "POINT")
    mesh.attributes.active_color = mesh.color_attributes[COLOR_NAME]
    mesh.update()
    thing = bpy.data.objects.new("scene", mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing, [emissions[slots[m.name]] for m in materials]


def set_up(samples, threads, sky):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.bake.use_clear = True
    scene.render.bake.margin = 0
    settings = scene.cycles
    settings.device, settings.samples, settings.seed = "CPU", samples, 0
    settings.use_denoising = settings.use_adaptive_sampling = False
    settings.max_bounces = settings.diffuse_bounces = BOUNCES
    settings.min_light_bounces = ROULETTE_FROM
    settings.sample_clamp_direct = settings.sample_clamp_indirect = 0
    if scene.world is None:
        scene.world = bpy.data.worlds.new("black")
    scene.world.use_nodes = False
    scene.world.color = sky


def bake(thing):
    bpy.ops.object.select_all(action="DESELECT")
    thing.select_set(True)
    bpy.context.view_layer.objects.active = thing
    begin = time.perf_counter()
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT", "COLOR"}, target="VERTEX_COLORS")
    return time.perf_counter() - begin


def to_gltf_axes(vectors):
    return numpy.stack([vectors[:, 0], vectors[:, 2], -vectors[:, 1]], axis=1)


def main(source, output, facts, vertex_count, samples, threads, sky="0,0,0"):
    corners, materials, objects = import_triangles(source)
    vertices, triangles, origin = cut_to_count(corners, objects, int(vertex_count))
    thing, emission = build_object(vertices, triangles, [materials[t] for t in origin])
    set_up(int(samples), int(threads), tuple(float(band) for band in sky.split(",")))
    seconds = bake(thing)
    colors = numpy.empty(4 * len(vertices), dtype=numpy.float32)
    thing.data.color_attributes[COLOR_NAME].data.foreach_get("color", colors)
    radiance = colors.reshape(-1, 4)[:, :3].astype(float)
    emitted = numpy.zeros_like(radiance)
    for corner in range(3):
        emitted[triangles[:, corner]] = emission
    write_radiance(output, to_gltf_axes(vertices), triangles, radiance + emitted)
    with open(facts, "w", encoding="utf-8") as f:
        json.dump({"seconds": seconds, "vertices": len(vertices), "triangles": len(triangles),
                   "blender": bpy.app.version_string}, f)


main(*sys.argv[sys.argv.index("--") + 1:])
