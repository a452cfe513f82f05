/* SPDX-License-Identifier: MIT */
#include "baked_glb.h"

#include "path_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool baked_glb_hides(const gltf_asset *asset, const options *o, uint32_t mesh) {
    return !o->keep_lamps && gltf_asset_mesh_is_lamp(asset, mesh);
}

/* A mesh without triangles is left out. */
static void gather_meshes(const baked_glb *g, const hemi_mesh_view *nothing, gltf_baked_mesh *meshes) {
    const bool with_radiance = g->for_usd || g->o->scene_linear || g->o->keep_pbr;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(g->asset); i++) {
        const hemi_mesh_view *view = gltf_asset_mesh_is_left(g->asset, i) ? NULL : &g->colors->views[i];
        meshes[i] = (gltf_baked_mesh){ baked_glb_hides(g->asset, g->o, i) ? nothing : view,
                                       g->for_usd ? g->colors->seen[i] : g->colors->colors[i],
                                       with_radiance ? g->colors->views[i].radiance : NULL,
                                       g->o->bake.vertex_errors ? g->colors->views[i].errors : NULL };
    }
}

static gltf_write_desc describe(const baked_glb *g) {
    const options *o = g->o;
    gltf_write_desc desc = { .binary = !g->bin_path,
                             .bin_name = g->bin_path ? path_name(g->bin_path) : NULL,
                             .mesh_count = gltf_asset_mesh_count(g->asset),
                             .threads = o->threads,
                             .draco = !g->for_usd && !o->no_draco,
                             .draco_level = (int)o->draco_level,
                             .keep_materials = !g->for_usd && o->keep_pbr,
                             .whole_colors = g->for_usd,
                             .float_colors = g->for_usd,
                             .drop_lights = g->is_stage && !o->keep_lamps,
                             .keep_instances = o->keep_instances,
                             .extras_json = g->extras };
    memcpy(desc.draco_bits, o->draco_bits, sizeof desc.draco_bits);
    return desc;
}

int baked_glb_make(const baked_glb *g, console *c, gltf_output *out) {
    char message[GLTF_MESSAGE_SIZE], generator[64];
    const hemi_mesh_view nothing = { .struct_size = sizeof nothing };
    gltf_baked_mesh *meshes = calloc(gltf_asset_mesh_count(g->asset) + 1, sizeof *meshes);
    if (!meshes) return EXIT_BAD_INPUT;
    gather_meshes(g, &nothing, meshes);
    snprintf(generator, sizeof generator, "hemibake %s", hemi_version());
    gltf_write_desc desc = describe(g);
    const char *names[LIGHT_NAMES_MAX];
    for (uint32_t i = 0; i < g->groups->count; i++) names[i] = g->groups->all[i];
    desc.lights = g->groups->count > 0 ? (const float *const *)g->colors->lights : NULL;
    desc.light_names = names, desc.light_count = g->groups->count;
    desc.meshes = meshes;
    desc.generator = generator;
    hemi_result result = gltf_asset_write(g->asset, &desc, out, message);
    free(meshes);
    return result == HEMI_OK ? EXIT_DONE : console_error(c, "%s", message);
}
