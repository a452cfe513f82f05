/* SPDX-License-Identifier: MIT
 * Where is looked from for the light that no surface emits? Private to this folder.
 */
#ifndef HEMIBAKE_CORE_LIGHT_LIGHT_SAMPLES_H
#define HEMIBAKE_CORE_LIGHT_LIGHT_SAMPLES_H

#include "base/deadline.h"
#include "light/direct_light.h"

/* Somewhere to look from, and what comes that way. */
typedef struct light_sample {
    const punctual *light; /* NULL: a patch of the sky */
    const sky_patch *part;
    double toward[3]; /* unit, where its light is parallel */
    double share;     /* of the light's directions ... */
    int direction;    /* ... of which it is this one, or this place, or -1: it is looked for at a sample's own place */
    uint32_t place;   /* by number, where in what a sample stands for */
    bool is_repeated; /* its view is that of the one before it, from another place */
    bool ends_light;  /* it is the last of its light */
    int face;         /* of the cube around a point, or -1 */
} light_sample;

/* Of suns, until parallel, then of what has a place, until lights, then of the sky. Where there are several places each
 * light has 2^n. */
typedef struct light_samples {
    light_sample *all; /* from block_new */
    size_t parallel, lights, count;
    size_t each_placed; /* of a light that has a place */
} light_samples;

/* Where it is looked for from a corner's sample of an element of a patch: on the smooth surface that its facet stands
 * for. Each direction of a sun, and where lights are few each of several times that one is looked at, is from another
 * place of what the sample stands for, so that of a surface which the edge of a shadow runs across that much is lit
 * which is: slats of a blind that have one element across, and are lit by four fifths, would all be by all or by half
 * of it. An even direction and the next, a quarter of a turn of the disc apart, are from places beside each other. */
void light_sample_place(const light_sample *b, const mesh *m, const surface *f, const element *e, int corner,
                        double out[3]);

static inline bool light_samples_are_late(const direct_light_setup *setup) {
    return deadline_is_over(&(deadline){ setup->clock, setup->deadline_s });
}

/* False when out of memory. */
bool light_samples_list(const direct_light_setup *setup, light_samples *out);

/* What a sample has of a light so far, and the means of the share that is seen and of its square. */
typedef struct seen_light {
    double E, p, p_squared;
} seen_light;

/* Adds one of several places to what is known of its light; with the last one *uneven grows by what direct_light.h says
 * of it, and there is none so far of the next. was_lit: by the one before it. */
void light_sample_see(const light_sample *b, bool was_lit, bool lit, const double E[3], seen_light *so_far,
                      float *uneven);

/* Where those from `first` on end that have its view, at `end` at the latest. */
size_t light_samples_end_of_view(const light_samples *l, size_t first, size_t end);

/* What those from first to end have of all light, but for what light it is: of a light its intensity, of the sky flux.
 */
double light_samples_flux(const light_samples *l, size_t first, size_t end);

/* What it gives a point of a surface that it reaches, and what is around it as far as a sample of that area stands for;
 * false: nothing. */
bool light_sample_irradiance(const light_sample *b, const double point[3], double area, const double normal[3],
                             double E[3]);

#endif
