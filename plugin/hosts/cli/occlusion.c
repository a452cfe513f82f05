/* SPDX-License-Identifier: MIT */
#include "occlusion.h"

#include "asset_box.h"

/* Of the diagonal: corners and what stands on a floor darken, and a room stays open. */
static const double NEAR_SHARE = 0.1;

void occlusion_options(options *o) {
    if (!o->ao) return;
    o->bake.bounces = -1;
    o->scene_linear = true;
}

double occlusion_distance(const gltf_asset *asset) {
    double middle[3];
    return NEAR_SHARE * asset_box(asset, middle);
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
