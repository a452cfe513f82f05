# SPDX-License-Identifier: MIT
"""Which scenes does Blender export in the tests? Built with bpy, metres, z up."""

import bpy
from mathutils import Vector

TEXELS = 16  # of a wall's edge, where Cycles is asked

# Origin and two edges, counter-clockwise seen from inside a room of 2 m.
WALLS = {
    "floor": ((-1, -1, 0), (2, 0, 0), (0, 2, 0), (0.7, 0.7, 0.7)),
    "ceiling": ((-1, -1, 2), (0, 2, 0), (2, 0, 0), (0.7, 0.7, 0.7)),
    "west": ((-1, -1, 0), (0, 2, 0), (0, 0, 2), (0.6, 0.1, 0.1)),
    "east": ((1, -1, 0), (0, 0, 2), (0, 2, 0), (0.1, 0.2, 0.6)),
    "south": ((-1, -1, 0), (0, 0, 2), (2, 0, 0), (0.7, 0.7, 0.7)),
    "north": ((-1, 1, 0), (2, 0, 0), (0, 0, 2), (0.7, 0.7, 0.7)),
}


def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="hemibake")
    bpy.ops.preferences.addon_enable(module="cycles")
    return bpy.context.scene


def diffuse(name, color, emission=None):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1)
    shader.inputs["Specular"].default_value = 0
    shader.inputs["Roughness"].default_value = 1
    if emission:
        shader.inputs["Emission"].default_value = (*[c / max(emission) for c in emission], 1)
        shader.inputs["Emission Strength"].default_value = max(emission)
    return material


def add_mesh(name, vertices, faces, material):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(material)
    out = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(out)
    return out


def add_wall(name):
    origin, u, v, color = WALLS[name]
    origin, u, v = Vector(origin), Vector(u), Vector(v)
    wall = add_mesh(name, [origin, origin + u, origin + u + v, origin + v], [(0, 1, 2, 3)], diffuse(name, color))
    layer = wall.data.uv_layers.new()
    for loop, uv in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
        loop.uv = uv
    return wall


def add_box(name="box", low=(-0.7, -0.5, 0.3), high=(-0.2, 0.1, 0.8), color=(0.4, 0.5, 0.2), emission=None):
    """Above the floor: where it touched, colours at vertices would blur what Cycles has sharp."""
    vertices = [[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return add_mesh(name, vertices, faces, diffuse(name, color, emission))


def add_lamp(kind, name, location, energy, **more):
    light = bpy.data.lights.new(name, kind)
    light.energy = energy
    for key, value in more.items():
        setattr(light, key, value)
    lamp = bpy.data.objects.new(name, light)
    lamp.location = location
    bpy.context.scene.collection.objects.link(lamp)
    return lamp


def room():
    empty()
    walls = {name: add_wall(name) for name in WALLS}
    add_box()
    return walls


def area_room():
    """Lit by area lamps, a rectangle and a disk under the ceiling, and by a cube that emits."""
    walls = room()
    # Small, and far from the ceiling: lamps of Cycles hide none of it.
    add_lamp("AREA", "lamp", (0.2, -0.3, 1.5), 40, shape="RECTANGLE", size=0.2, size_y=0.15, color=(1, 0.9, 0.8))
    add_lamp("AREA", "disk", (-0.4, 0.5, 1.4), 20, shape="DISK", size=0.15)
    # All its sides emit, as surfaces of Cycles do.
    add_box("panel", (0.3, 0.2, 0.8), (0.5, 0.4, 1.0), (0, 0, 0), (5, 8, 10))
    return walls


def lamp_room():
    """Lit by a point, a spot, and the sun, which comes through the open ceiling."""
    walls = room()
    walls.pop("ceiling")
    bpy.data.objects.remove(bpy.data.objects["ceiling"])
    add_lamp("POINT", "point", (0.4, 0.3, 1.3), 40, shadow_soft_size=0)
    # Narrow where it fades: glTF says how in another curve than Cycles.
    add_lamp("SPOT", "spot", (0.1, -0.1, 1.8), 30, shadow_soft_size=0, spot_size=1.2, spot_blend=0.1)
    add_lamp("SUN", "sun", (0, 0, 5), 2.0, angle=0.0).rotation_euler = (0.3, 0.2, 0)
    return walls


def cage_room():
    """A sphere by Catmull-Clark, lit by a lamp that is one too."""
    empty()
    for name, z, emission in (("ball", 0, None), ("light", 3, (5, 5, 5))):
        vertices = [[(-1, 1)[i >> k & 1] for k in range(2)] + [(z - 1, z + 1)[i >> 2]] for i in range(8)]
        faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        ball = add_mesh(name, vertices, faces, diffuse(name, (0.5, 0.5, 0.5), emission))
        ball.modifiers.new("smooth", "SUBSURF").levels = 2
    return {}


def make_lambertian():
    """Principled's diffuse part is Disney's, brighter at grazing angles by a tenth; the exporter reads no other shader."""
    for material in bpy.data.materials:
        tree = material.node_tree
        shader = tree.nodes["Principled BSDF"]
        if shader.inputs["Emission Strength"].default_value * max(shader.inputs["Emission"].default_value[:3]) > 0:
            continue
        lambert = tree.nodes.new("ShaderNodeBsdfDiffuse")
        lambert.inputs["Color"].default_value = shader.inputs["Base Color"].default_value
        tree.links.new(lambert.outputs["BSDF"], tree.nodes["Material Output"].inputs["Surface"])


def bake_with_cycles(walls, samples):
    """Radiance of each wall's texels, rows of v from 0: {name: [TEXELS][TEXELS][3]}."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    make_lambertian()
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_adaptive_sampling = "CPU", samples, False
    cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = 64
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    scene.render.bake.margin = 0
    bpy.ops.object.select_all(action="DESELECT")
    images = {}
    for name, wall in walls.items():
        image = images[name] = bpy.data.images.new(name, TEXELS, TEXELS, float_buffer=True, is_data=True)
        nodes = wall.data.materials[0].node_tree.nodes
        node = nodes.new("ShaderNodeTexImage")
        node.image = image
        nodes.active = node
        wall.select_set(True)
    bpy.context.view_layer.objects.active = next(iter(walls.values()))
    bpy.ops.object.bake(type="COMBINED")
    return {name: [[list(image.pixels[4 * (y * TEXELS + x) :][:3]) for x in range(TEXELS)] for y in range(TEXELS)]
            for name, image in images.items()}
