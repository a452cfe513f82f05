/* SPDX-License-Identifier: MIT */
#include "asset_colors.h"

#include "file_read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *config_path(const options *o) {
    const char *from_environment = getenv("OCIO");
    if (o->ocio) return o->ocio;
    return from_environment && *from_environment ? from_environment : NULL;
}

static bool may_read(void *user, const char *path, char *reason) {
    return file_is_plain(path, user, reason);
}

static hemi_result load(const options *o, asset_colors *out, char *message) {
    const char *config = config_path(o);
    if (config && strncmp(config, "ocio://", strlen("ocio://")) != 0 && !file_is_plain(config, o->root, message))
        return HEMI_ERROR_FILE;
    const color_transform_desc view = { .config = config,
                                        .display = o->display,
                                        .view = o->view,
                                        .look = o->look,
                                        .working_space = o->working_space,
                                        .may_read = o->root ? may_read : NULL,
                                        .may_read_user = (void *)(uintptr_t)o->root };
    const color_input_desc input = { .origin = COLOR_ORIGIN_FACTOR, .space = o->input_space, .file = o->inputs[0] };
    out->input_space = o->input_space;
    hemi_result result = color_transform_create(&view, &out->transform, message);
    return result == HEMI_OK ? color_input_create(out->transform, &input, &out->factors, message) : result;
}

int asset_colors_load(const options *o, console *c, asset_colors *out) {
    char message[COLOR_MESSAGE_SIZE] = "";
    float black[3] = { 0 };
    hemi_result result = load(o, out, message);
    if (result == HEMI_OK && (!o->scene_linear || color_transform_apply_rec709(out->transform, black, 1) == HEMI_OK))
        return EXIT_DONE;
    if (config_path(o)) c->file = config_path(o);
    if (result != HEMI_OK) return console_error(c, "%s", *message ? message : hemi_result_text(result));
    return console_error(c,
                         "--scene-linear writes linear Rec.709, and the configuration does not say what that is; bake "
                         "through one of its views, or give it the role aces_interchange");
}

void asset_colors_free(asset_colors *colors) {
    color_input_destroy(colors->factors);
    color_transform_destroy(colors->transform);
}

/* rgb is weight times a colour factor. */
static hemi_result convert(const color_input *input, double weight, double rgb[3], size_t *outside) {
    float color[3];
    size_t found = 0;
    if (color_input_is_identity(input) || !(weight > 0.0)) return HEMI_OK;
    for (int c = 0; c < 3; c++) color[c] = (float)(rgb[c] / weight);
    hemi_result result = color_input_apply(input, color, 1, &found);
    for (int c = 0; c < 3; c++) rgb[c] = weight * color[c];
    *outside += found;
    return result;
}

hemi_result asset_colors_material(const asset_colors *colors, const gltf_asset *asset, uint32_t material, console *c,
                                  hemi_material_desc *out) {
    double reflectance, emission;
    size_t outside = 0;
    gltf_asset_material(asset, material, out);
    gltf_asset_material_weights(asset, material, &reflectance, &emission);
    hemi_result result = convert(colors->factors, reflectance, out->reflectance, &outside);
    if (result == HEMI_OK) result = convert(colors->factors, emission, out->emission, &outside);
    if (outside)
        console_note(c, "warning: material '%s' has a colour outside the primaries of %s; its negative bands become 0",
                     out->name, color_transform_name(colors->transform, COLOR_PART_WORKING_SPACE));
    return result;
}

hemi_result asset_colors_light(const asset_colors *colors, double intensity, double rgb[3]) {
    size_t outside = 0;
    return convert(colors->factors, intensity, rgb, &outside);
}

hemi_result asset_colors_panorama(const asset_colors *colors, float *rgb, size_t count) {
    if (color_input_is_identity(colors->factors)) return HEMI_OK;
    return color_input_apply(colors->factors, rgb, count, NULL);
}

hemi_result asset_colors_convert(void *user, bool texels, const char *file, float *rgb, size_t count) {
    const asset_colors *colors = user;
    char message[COLOR_MESSAGE_SIZE];
    color_input *input = NULL;
    if (!texels) return asset_colors_panorama(colors, rgb, count);
    const color_input_desc desc = { .origin = COLOR_ORIGIN_TEXTURE, .space = colors->input_space, .file = file };
    hemi_result result = color_input_create(colors->transform, &desc, &input, message);
    if (result == HEMI_OK) result = color_input_apply(input, rgb, count, NULL);
    color_input_destroy(input);
    return result;
}
