/* SPDX-License-Identifier: MIT
 * What lights a scene besides its surfaces? Punctual lights, and a sky: the one that was given, or one of radiance 1
 * where nothing else gives light.
 */
#ifndef HEMIBAKE_CORE_LIGHT_LIGHTS_H
#define HEMIBAKE_CORE_LIGHT_LIGHTS_H

#include "light/direct_light.h"
#include "light/sky_glow.h"

typedef struct lights {
    /* The caller's. */
    const punctual *punctual;
    size_t punctual_count;
    bool sky_is_given;
    double sky_radiance[3]; /* times the image's, if there is one */
    sky_image sky_image;    /* radiance NULL: none */
    /* Of lights_open. From given_count on `punctual` are suns of the panorama (sky_suns.h). */
    size_t given_count;
    punctual *with_suns; /* a block; NULL: there are none */
    sky sky;
    float *texels;  /* a block: the panorama's, where it was larger; NULL: it was not */
    sky_glow *glow; /* that rows draw from; NULL: there is none */
    bool has_sky, sky_is_default;
    bool is_crowd; /* those that have a place are so many that rows draw among them (row_emitters.h) */
} lights;

/* surfaces_emit: does any patch? by_rows: may rows draw among them? fineness: of sky.h. False when out of memory. */
bool lights_open(allocator *memory, bool surfaces_emit, bool by_rows, int fineness, lights *l);
void lights_free(lights *l);

static inline bool lights_any(const lights *l) {
    return l->has_sky || l->punctual_count > 0;
}

/* Directional lights, of those that were given. */
size_t lights_sun_count(const lights *l);

/* Radiance of the sky in a unit direction, L[c]; 0 where there is none. */
void lights_sky_radiance(const lights *l, const double direction[3], double L[3]);

/* What arrives from them at the samples of setup->mesh, from all or from the punctual ones alone, but for a crowd;
 * setup says the rest.
 * NULL on success, else why it failed. */
const char *lights_arrive(const lights *l, bool with_sky, const direct_light_setup *setup, direct_light *out,
                          char *message, size_t message_size);

#endif
