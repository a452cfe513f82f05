/* SPDX-License-Identifier: MIT */
#include "light/lights.h"

bool lights_open(allocator *memory, bool surfaces_emit, int fineness, lights *l) {
    static const double one[3] = { 1, 1, 1 };
    l->sky_is_default = !l->sky_is_given && l->punctual_count == 0 && !surfaces_emit;
    l->has_sky = l->sky_is_given || l->sky_is_default;
    if (!l->has_sky) return true;
    return sky_create(memory, l->sky_is_given ? l->sky_radiance : one, l->sky_image.radiance ? &l->sky_image : NULL,
                      fineness, &l->sky);
}

void lights_free(lights *l) {
    sky_free(&l->sky);
    l->has_sky = l->sky_is_default = false;
}

const char *lights_arrive(const lights *l, bool with_sky, const direct_light_setup *setup, direct_light *out,
                          char *message, size_t message_size) {
    direct_light_setup all = *setup;
    all.lights = l->punctual;
    all.light_count = l->punctual_count;
    all.sky = with_sky && l->has_sky ? &l->sky : NULL;
    return direct_light_compute(&all, out, message, message_size);
}
