/* SPDX-License-Identifier: MIT */
#include "occlusion.h"

#include <math.h>
#include <string.h>

/* Of the diagonal: corners and what stands on a floor darken, and a room stays open. */
static const double NEAR_SHARE = 0.1;

void occlusion_options(options *o) {
    if (!o->ao) return;
    o->bake.bounces = -1;
    o->scene_linear = true;
}

double occlusion_distance(const gltf_asset *asset) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, square = 0.0;
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        hemi_mesh_desc mesh;
        gltf_asset_mesh(asset, i, &mesh);
        if (!gltf_asset_mesh_blocks(asset, i)) continue;
        for (uint32_t v = 0; v < mesh.vertex_count; v++)
            for (int k = 0; k < 3; k++) {
                double x = mesh.transform[12 + k];
                for (int c = 0; c < 3; c++) x += mesh.transform[4 * c + k] * (double)mesh.positions[3 * v + c];
                low[k] = fmin(low[k], x), high[k] = fmax(high[k], x);
            }
    }
    for (int k = 0; k < 3; k++) square += (high[k] - low[k]) * (high[k] - low[k]);
    return isfinite(square) ? NEAR_SHARE * sqrt(square) : 0.0;
}

void occlusion_material(hemi_material_desc *material) {
    for (int c = 0; c < 3; c++) {
        material->reflectance[c] = 0.5;
        material->emission[c] = material->transmission[c] = material->diffuse_transmission[c] = 0.0;
    }
}

int occlusion_sky(hemi_scene *scene) {
    const hemi_sky_desc sky = { .struct_size = sizeof sky, .radiance = { 2, 2, 2 } };
    return hemi_scene_set_sky(scene, &sky) == HEMI_OK ? EXIT_DONE : EXIT_BAD_INPUT;
}
