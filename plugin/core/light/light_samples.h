/* SPDX-License-Identifier: MIT
 * Where is looked from for the light that no surface emits? Private to this folder.
 */
#ifndef HEMIBAKE_CORE_LIGHT_LIGHT_SAMPLES_H
#define HEMIBAKE_CORE_LIGHT_LIGHT_SAMPLES_H

#include "light/direct_light.h"

/* Somewhere to look from, and what comes that way. */
typedef struct light_sample {
    const punctual *light; /* NULL: a patch of the sky */
    const sky_patch *part;
    double toward[3]; /* unit, where its light is parallel */
    double share;     /* of the light's directions ... */
    int direction;    /* ... of which it is this one, or -1: it is no sun's */
    uint32_t place;   /* of a sun's: by number, where in what a sample stands for */
    bool ends_sun;    /* it is the last direction */
    int face;         /* of the cube around a point, or -1 */
} light_sample;

/* Of suns, each an even number, until parallel, then of what has a place, until lights, then of the sky. */
typedef struct light_samples {
    light_sample *all; /* from block_new */
    size_t parallel, lights, count;
} light_samples;

/* Where it is looked for from a corner's sample of an element of a patch: on the smooth surface that its facet stands
 * for. Each direction of a sun, of one without a disc all the same, is from another place of what the sample stands
 * for, so that of a surface which the edge of a shadow runs across that much is lit which is: slats of a blind that
 * have one element across, and are lit by four fifths, would all be by all or by half of it. An even direction and the
 * next, a quarter of a turn of the disc apart, are from places beside each other. */
void light_sample_place(const light_sample *b, const mesh *m, const surface *f, const element *e, int corner,
                        double out[3]);

/* False when out of memory. */
bool light_samples_list(const direct_light_setup *setup, light_samples *out);

/* What it gives a point of a surface that it reaches, and what is around it as far as a sample of that area stands for;
 * false: nothing. */
bool light_sample_irradiance(const light_sample *b, const double point[3], double area, const double normal[3],
                             double E[3]);

#endif
