/* SPDX-License-Identifier: MIT */
#include "asset_scene.h"

#include "asset_lights.h"
#include "cage_levels.h"
#include "occlusion.h"
#include "usd_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* As many as elements where nobody says how many. */
static const double LIMIT_TRIANGLES_DEFAULT = 4e6;

/* Of all meshes, before those that are finer than elements get simpler ones: they take 5 GB or so. */
static const double TRIANGLES_OF_AN_ELEMENT = 8.0;

/* s a triangle of the asset, from its colours to the end of its file: 1.45 for a million, with Draco, on two
 * processors. What is no triangle, as a hundred thousand lights, is written in this share of the time that it was read
 * in. */
static const double WRITING_S = 1.45e-6, WRITING_OF_READING = 0.5;

/* Where others have the processors, writing takes as many times as long as all did so far: up to so many. */
static const double SLOWER_MOST = 3.0;

/* A time limit of 0 is none. */
static const double LEAST_TIME = 1e-3;

static hemi_result add_materials(hemi_scene *scene, const gltf_asset *asset, const asset_colors *colors,
                                 const options *o, console *c) {
    hemi_result result = HEMI_OK;
    for (uint32_t i = 0; result == HEMI_OK && i < gltf_asset_material_count(asset); i++) {
        hemi_material_desc material;
        result = asset_colors_material(colors, asset, i, c, &material);
        if (o->ao) occlusion_material(&material);
        if (result == HEMI_OK) result = hemi_scene_add_material(scene, &material, NULL);
    }
    const hemi_material_desc unlit = { .struct_size = sizeof unlit, .name = "unlit" };
    return result == HEMI_OK ? hemi_scene_add_material(scene, &unlit, NULL) : result;
}

/* What an asset asks for itself goes before what is asked for all; --subdivide 0 takes every mesh as it is. Either way
 * the asset says which polygons the triangles were. Of a USD stage every mesh says whether it is a cage. */
static void set_subdivision(hemi_mesh_desc *mesh, const options *o, bool knows_cages, hemi_subdivision_desc *own) {
    const hemi_subdivision_desc *asked = mesh->subdivision;
    if (knows_cages && o->subdivide >= 0) return;
    if (o->subdivide < 0) mesh->subdivision = NULL;
    if (o->subdivide <= 0 || (asked && asked->scheme != HEMI_SUBDIVISION_NONE)) return;
    *own = asked ? *asked : (hemi_subdivision_desc){ .struct_size = sizeof *own };
    own->scheme = (hemi_subdivision_scheme)o->subdivision;
    own->level = (uint32_t)o->subdivide;
    own->tessellation = o->subdivide_adaptive ? HEMI_TESSELLATION_ADAPTIVE : HEMI_TESSELLATION_UNIFORM;
    mesh->subdivision = own;
}

/* Triangles of the limit surface at most: Catmull-Clark makes six of one, and each further level quarters them. */
static double limit_triangles(const hemi_mesh_desc *mesh) {
    const hemi_subdivision_desc *s = mesh->subdivision;
    if (!s || s->scheme == HEMI_SUBDIVISION_NONE || s->level == 0) return mesh->triangle_count;
    double first = s->scheme == HEMI_SUBDIVISION_LOOP ? 4.0 : 6.0;
    return first * mesh->triangle_count * pow(4.0, s->level - 1.0);
}

/* A cage of some faces asks for millions by one digit; what is more than may be solved is refused before it is made. */
static hemi_result check_subdivision(const hemi_mesh_desc *mesh, const options *o, double *triangles, console *c) {
    double most = o->bake.max_elements > 0 ? (double)o->bake.max_elements : LIMIT_TRIANGLES_DEFAULT;
    double own = limit_triangles(mesh);
    if (own == mesh->triangle_count || (*triangles += own) <= most) return HEMI_OK;
    console_error(
        c,
        "mesh '%s': with %u levels of subdivision the meshes have up to %.0f triangles, more than %.0f; ask for "
        "fewer levels, or raise --max-elements",
        mesh->name ? mesh->name : "", mesh->subdivision->level, *triangles, most);
    return HEMI_ERROR_LIMIT;
}

static double count_triangles(const gltf_asset *asset) {
    double sum = 0.0;
    hemi_mesh_desc mesh;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++)
        if (gltf_asset_mesh(asset, i, &mesh)) sum += mesh.triangle_count;
    return sum;
}

double asset_scene_time_left(const gltf_asset *asset, double limit_s, double spent_s, double read_s) {
    double slower = fmin(fmax(spent_s * CLOCKS_PER_SEC / ((double)clock() + 1.0), 1.0), SLOWER_MOST);
    double writing_s = slower * WRITING_S * count_triangles(asset) + WRITING_OF_READING * read_s;
    return limit_s > 0.0 ? fmax(limit_s - spent_s - writing_s, LEAST_TIME) : limit_s;
}

/* A mesh that a thousand nodes show is a thousand in the bake: a file of a megabyte asks for gigabytes, and for days.
 */
static hemi_result check_triangles(const gltf_asset *asset, const options *o, console *c) {
    double most = TRIANGLES_OF_AN_ELEMENT * fmax((double)o->bake.max_elements, LIMIT_TRIANGLES_DEFAULT);
    double sum = count_triangles(asset);
    if (sum <= most) return HEMI_OK;
    console_error(c,
                  "its nodes show %.0f triangles, more than %.0f; show fewer or simpler meshes, or raise "
                  "--max-elements to %.0f",
                  sum, most, ceil(sum / TRIANGLES_OF_AN_ELEMENT));
    return HEMI_ERROR_LIMIT;
}

/* What leaves its level to the host. */
static void set_level(hemi_mesh_desc *mesh, const options *o, uint32_t level, hemi_subdivision_desc *own) {
    if (!mesh->subdivision) return;
    *own = *mesh->subdivision;
    own->level = o->subdivide > 0 ? (uint32_t)o->subdivide : level;
    if (o->subdivide_adaptive) own->tessellation = HEMI_TESSELLATION_ADAPTIVE;
    if (own->level == 0) own->scheme = HEMI_SUBDIVISION_NONE;
    mesh->subdivision = own;
}

/* What is unlit stands in the way of light, which it neither takes nor gives; see add_materials. What blends lets as
 * much past as is seen through it. */
static void take_unlit(const gltf_asset *asset, uint32_t index, hemi_mesh_desc *mesh) {
    hemi_material_desc own;
    gltf_asset_material(asset, mesh->material, &own);
    if (!(own.transmission[0] > 0.0)) {
        mesh->material = gltf_asset_material_count(asset);
        mesh->texture = NULL;
    }
    mesh->subdivision = NULL;
    mesh->keep_vertices = false;
    if (!gltf_asset_mesh_blocks(asset, index)) mesh->triangle_count = 0;
}

static void take_steering(const gltf_asset *asset, uint32_t index, hemi_mesh_desc *mesh) {
    gltf_mesh_steering own;
    gltf_asset_mesh_steering(asset, index, &own);
    mesh->element_size = own.element_size;
    if (own.facets) mesh->normals = NULL;
    if (own.is_left_out) mesh->triangle_count = 0;
}

/* Which group the light of a mesh is in, if it gives any. */
static uint32_t light_group_of(const lights_from *from, uint32_t index, const char *name, light_names *groups) {
    gltf_mesh_steering steering;
    uint32_t of;
    if (!lights_from_emits(from, index, &of)) return 0;
    gltf_asset_mesh_steering(from->asset, of, &steering);
    return light_names_group(groups, steering.group ? steering.group : name, "mesh", index);
}

static hemi_result add_meshes(hemi_scene *scene, lights_from *from, const asset_colors *colors, const options *o,
                              light_names *groups, console *c) {
    const gltf_asset *asset = from->input;
    if (check_triangles(asset, o, c) != HEMI_OK) return HEMI_ERROR_LIMIT;
    uint32_t *levels = cage_levels_make(asset, o);
    hemi_result result = levels ? HEMI_OK : HEMI_ERROR_MEMORY;
    bool knows_cages = usd_is_input(o->inputs[0]);
    double triangles = 0.0;
    for (uint32_t i = 0; result == HEMI_OK && i < gltf_asset_mesh_count(asset); i++) {
        hemi_mesh_desc mesh;
        hemi_subdivision_desc subdivision;
        gltf_asset_mesh(asset, i, &mesh);
        gltf_asset_texture(asset, i, &mesh);
        if (o->ao) mesh.texture = NULL;
        if (gltf_asset_mesh_is_unlit(asset, i)) {
            take_unlit(asset, i, &mesh);
        } else {
            mesh.light_group = light_group_of(from, i, mesh.name, groups);
            result = lights_from_set(from, colors, i, scene, c, &mesh);
        }
        take_steering(asset, i, &mesh);
        set_subdivision(&mesh, o, knows_cages, &subdivision);
        if (gltf_asset_mesh_level_is_auto(asset, i)) set_level(&mesh, o, levels[i], &subdivision);
        if (result == HEMI_OK) result = check_subdivision(&mesh, o, &triangles, c);
        if (result == HEMI_OK) result = hemi_scene_add_mesh(scene, &mesh, NULL);
    }
    free(levels);
    return result;
}

static bool any_lit(const gltf_asset *asset) {
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++)
        if (!gltf_asset_mesh_is_left(asset, i)) return true;
    return false;
}

int asset_scene_create(hemi_context *context, lights_from *from, const asset_colors *colors, const options *o,
                       light_names *groups, console *c, hemi_scene **out) {
    const gltf_asset *asset = from->input;
    for (size_t i = 0; i < gltf_asset_skipped_count(asset); i++) console_note(c, "%s", gltf_asset_skipped(asset, i));
    if (!any_lit(asset)) {
        const char *first = NULL;
        for (size_t i = 0; !first && i < gltf_asset_skipped_count(asset); i++)
            if (strstr(gltf_asset_skipped(asset, i), "not baked")) first = gltf_asset_skipped(asset, i);
        return console_error(c, "it has no triangles that can be baked: %s", first ? first : "its scene shows no mesh");
    }
    hemi_result result = hemi_scene_create(context, out);
    if (result == HEMI_OK) result = add_materials(*out, asset, colors, o, c);
    if (result == HEMI_OK) result = add_meshes(*out, from, colors, o, groups, c);
    if (result == HEMI_ERROR_MEMORY) console_error(c, "out of memory");
    return result == HEMI_OK ? asset_lights_add(*out, from->asset, colors, o, groups, c) : EXIT_BAD_INPUT;
}
