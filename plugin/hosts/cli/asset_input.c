/* SPDX-License-Identifier: MIT */
#include "asset_input.h"

int asset_input_read(const options *o, console *c, usd_files *usd, options *as_read, gltf_asset **asset) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_limits limits = { .root = o->root,
                           .image_pixels = o->max_pixels,
                           .memory_left = console_memory_left,
                           .memory_user = c,
                           .scene = o->scene,
                           .opens_scene = !o->continues,
                           .variant = o->variant,
                           .leaves_moving = o->moving == MOVING_LEAVE };
    const char *path = o->continues ? o->continues : o->inputs[0];
    if (usd_is_input(path)) {
        int status = usd_read(usd, o, c);
        if (status != EXIT_DONE) return status;
        path = usd->scene;
        /* The stage's, not those of what is made of it, which lies elsewhere and names no file. */
        limits.variant = limits.scene = limits.root = NULL;
        if (usd->has_sky && !o->environment) as_read->environment = usd->sky, as_read->root = NULL;
    }
    return gltf_asset_read_within(path, &limits, asset, message) == HEMI_OK ? EXIT_DONE
                                                                            : console_error(c, "%s", message);
}

int asset_input_open(const char *path, const options *o, console *c, gltf_asset **asset) {
    char message[GLTF_MESSAGE_SIZE];
    const gltf_limits limits = { .root = o->root, .scene = o->scene };
    if (gltf_asset_read_within(path, &limits, asset, message) == HEMI_OK) return EXIT_DONE;
    c->file = path;
    return console_error(c, "%s", message);
}

int asset_input_textures(const options *o, const asset_colors *spaces, console *c, gltf_asset *asset) {
    char message[GLTF_MESSAGE_SIZE];
    if (o->metals) gltf_asset_set_metals(asset, (gltf_metals)(o->metals - 1));
    if (!o->keep_lamps) gltf_asset_clear_lamps(asset);
    if (!o->keep_pbr) gltf_asset_show_emission(asset);
    if (o->emissive_scale > 0.0) gltf_asset_scale_emission(asset, o->emissive_scale);
    if (gltf_asset_read_textures(asset, asset_colors_convert, (void *)spaces, message) == HEMI_OK) return EXIT_DONE;
    return console_error(c, "%s", message);
}
