/* SPDX-License-Identifier: MIT */
#include "light/lights.h"

#include "geometry/vec3.h"
#include "light/sky_suns.h"

#include <math.h>
#include <string.h>

/* Up to so many lights that have a place are each looked from: six pictures of the whole scene. */
enum { FEW = 96 };

static bool are_crowd(const lights *l) {
    size_t placed = 0;
    for (size_t i = 0; i < l->punctual_count; i++) placed += l->punctual[i].kind != PUNCTUAL_DIRECTIONAL;
    return placed > FEW;
}

/* Suns of the panorama become lights. False when out of memory. */
static bool take_suns(allocator *memory, lights *l) {
    punctual suns[SKY_IMAGE_SUNS];
    size_t count = 0;
    l->given_count = l->punctual_count;
    if (!l->sky_is_given || !l->sky_image.radiance) return true;
    if (!sky_suns_find(memory, l->sky_radiance, &l->sky_image, suns, &count)) return false;
    if (count == 0) return true;
    l->with_suns = block_new(memory, (l->given_count + count) * sizeof *l->with_suns);
    if (!l->with_suns) return false;
    if (l->given_count > 0) memcpy(l->with_suns, l->punctual, l->given_count * sizeof *l->with_suns);
    memcpy(l->with_suns + l->given_count, suns, count * sizeof *suns);
    l->punctual = l->with_suns, l->punctual_count += count;
    return true;
}

bool lights_open(allocator *memory, bool surfaces_emit, bool by_rows, int fineness, lights *l) {
    static const double one[3] = { 1, 1, 1 };
    l->sky_is_default = !l->sky_is_given && l->punctual_count == 0 && !surfaces_emit;
    l->has_sky = l->sky_is_given || l->sky_is_default;
    l->is_crowd = by_rows && are_crowd(l);
    if (!take_suns(memory, l)) return false;
    if (!l->has_sky) return true;
    const bool has_image = l->sky_is_given && l->sky_image.radiance;
    if (has_image && !sky_image_reduce(memory, &l->sky_image, &l->texels)) return false;
    if (by_rows && has_image && !sky_glow_find(memory, &l->sky_image, &l->glow)) return false;
    return sky_create(memory, l->sky_is_given ? l->sky_radiance : one, l->sky_image.radiance ? &l->sky_image : NULL,
                      fineness, &l->sky);
}

void lights_free(lights *l) {
    sky_free(&l->sky);
    block_free_all(l->with_suns, l->glow, l->texels);
    l->with_suns = NULL, l->glow = NULL, l->texels = NULL;
    l->has_sky = l->sky_is_default = false;
}

size_t lights_sun_count(const lights *l) {
    size_t count = 0;
    for (size_t i = 0; i < l->punctual_count; i++) count += l->punctual[i].kind == PUNCTUAL_DIRECTIONAL;
    return count;
}

void lights_sky_radiance(const lights *l, const double direction[3], double L[3]) {
    const sky_image *image = &l->sky_image;
    for (int c = 0; c < 3; c++) L[c] = !l->has_sky ? 0.0 : l->sky_is_given ? l->sky_radiance[c] : 1.0;
    if (!l->has_sky || !l->sky_is_given || !image->radiance) return;
    double of_image[3];
    sky_image_radiance_toward(image, direction, of_image);
    for (int c = 0; c < 3; c++) L[c] *= of_image[c];
}

const char *lights_arrive(const lights *l, bool with_sky, const direct_light_setup *setup, direct_light *out,
                          char *message, size_t message_size) {
    direct_light_setup all = *setup;
    all.lights = l->punctual;
    all.light_count = l->punctual_count;
    all.only_parallel = l->is_crowd;
    all.sky = with_sky && l->has_sky ? &l->sky : NULL;
    return direct_light_compute(&all, out, message, message_size);
}
