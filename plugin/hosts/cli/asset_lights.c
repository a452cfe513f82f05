/* SPDX-License-Identifier: MIT
 * See asset_lights.h. y is up, north is -z, east is +x.
 */
#include "asset_lights.h"

#include "file_read.h"
#include "occlusion.h"
#include "panorama_decode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static double largest(const double rgb[3]) {
    return fmax(rgb[0], fmax(rgb[1], rgb[2]));
}

static hemi_result add_light(hemi_scene *scene, const asset_colors *colors, hemi_light_desc *light) {
    hemi_result result = asset_colors_light(colors, largest(light->intensity), light->intensity);
    return result == HEMI_OK ? hemi_scene_add_light(scene, light, NULL) : result;
}

static hemi_result add_sun(hemi_scene *scene, const asset_colors *colors, const double sun[4], uint32_t group) {
    double azimuth = sun[0] * PI / 180, elevation = sun[1] * PI / 180;
    hemi_light_desc light = { .struct_size = sizeof light,
                              .kind = HEMI_LIGHT_DIRECTIONAL,
                              .name = "--sun",
                              .intensity = { sun[2], sun[2], sun[2] },
                              .direction = { -cos(elevation) * sin(azimuth), -sin(elevation),
                                             cos(elevation) * cos(azimuth) },
                              .angular_diameter = sun[3] * PI / 180,
                              .light_group = group };
    return add_light(scene, colors, &light);
}

/* ---- sky ---- */

static bool parse_rgb(const char *text, double rgb[3]) {
    int end = 0;
    if (sscanf(text, "%lf,%lf,%lf%n", &rgb[0], &rgb[1], &rgb[2], &end) != 3 || text[end]) return false;
    return rgb[0] >= 0.0 && rgb[1] >= 0.0 && rgb[2] >= 0.0 && largest(rgb) <= 1e30;
}

enum { FILE_SIZE_MAX = 1 << 30 };

static int read_panorama(const char *path, const char *root, hdr_image *image, console *c) {
    char note[PANORAMA_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE], reason[FILE_MESSAGE_SIZE];
    size_t size;
    uint8_t *bytes;
    hemi_result read = file_read_bytes(path, root, FILE_SIZE_MAX, &bytes, &size, reason);
    hemi_result result = read == HEMI_OK ? panorama_decode(bytes, size, image, note, message) : read;
    free(bytes);
    if (result == HEMI_OK && note[0]) console_note(c, "--environment %.120s: %s", path, note);
    if (result == HEMI_OK) return EXIT_DONE;
    c->file = path;
    return console_error(c, "--environment: %s; it takes R,G,B or a panorama as .hdr or .exr",
                         read == HEMI_OK ? message : reason);
}

static hemi_result set_panorama(hemi_scene *scene, const asset_colors *colors, const hemi_sky_desc *sky) {
    size_t count = (size_t)sky->width * sky->height;
    float *rgb = malloc(3 * count * sizeof *rgb);
    hemi_result result = rgb ? HEMI_OK : HEMI_ERROR_MEMORY;
    if (rgb) memcpy(rgb, sky->image, 3 * count * sizeof *rgb);
    if (rgb) result = asset_colors_panorama(colors, rgb, count);
    hemi_sky_desc converted = *sky;
    converted.image = rgb;
    if (result == HEMI_OK) result = hemi_scene_set_sky(scene, &converted);
    free(rgb);
    return result;
}

static int add_environment(hemi_scene *scene, const asset_colors *colors, const options *o, uint32_t group,
                           console *c) {
    hemi_sky_desc sky = { .struct_size = sizeof sky, .radiance = { 1, 1, 1 }, .light_group = group };
    hdr_image image = { 0 };
    hemi_result result;
    bool is_even = parse_rgb(o->environment, sky.radiance);
    int status = is_even ? EXIT_DONE : read_panorama(o->environment, o->root, &image, c);
    if (status != EXIT_DONE) return status;
    if (!is_even && (uint64_t)image.width * image.height == 1) { /* the same everywhere needs no picture */
        for (int k = 0; k < 3; k++) sky.radiance[k] = (double)image.rgb[k];
        is_even = true;
    }
    if (is_even) {
        result = asset_colors_light(colors, largest(sky.radiance), sky.radiance);
        if (result == HEMI_OK) result = hemi_scene_set_sky(scene, &sky);
    } else {
        sky.image = image.rgb;
        sky.width = image.width;
        sky.height = image.height;
        result = asset_colors_panorama(colors, image.rgb, (size_t)image.width * image.height);
        if (result == HEMI_OK) result = hemi_scene_set_sky(scene, &sky);
    }
    hdr_image_free(&image);
    return result == HEMI_OK ? EXIT_DONE : EXIT_BAD_INPUT;
}

int asset_lights_add(hemi_scene *scene, const gltf_asset *asset, const asset_colors *colors, const options *o,
                     light_names *groups, console *c) {
    hemi_result result = HEMI_OK;
    hemi_light_desc light;
    hemi_sky_desc sky;
    if (o->ao) return occlusion_sky(scene);
    for (uint32_t i = 0; result == HEMI_OK && gltf_asset_light(asset, i, &light); i++) {
        light.light_group = light_names_group(groups, light.name, "light", i);
        result = add_light(scene, colors, &light);
    }
    if (result == HEMI_OK && o->sun.is_given)
        result = add_sun(scene, colors, o->sun.values, light_names_group(groups, "sun", "", 0));
    if (result == HEMI_OK && !o->environment && gltf_asset_sky(asset, &sky)) {
        sky.light_group = light_names_group(groups, "sky", "", 0);
        result = set_panorama(scene, colors, &sky);
    }
    if (result == HEMI_ERROR_MEMORY) console_error(c, "out of memory");
    if (result != HEMI_OK) return EXIT_BAD_INPUT;
    if (!o->environment) return EXIT_DONE;
    return add_environment(scene, colors, o, light_names_group(groups, "sky", "", 0), c);
}

void asset_lights_name_lost(const gltf_asset *asset, console *c) {
    for (size_t i = 0; i < gltf_asset_skipped_count(asset); i++)
        if (strstr(gltf_asset_skipped(asset, i), "its light is left out"))
            console_error(c, "%s", gltf_asset_skipped(asset, i));
}
