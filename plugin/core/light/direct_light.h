/* SPDX-License-Identifier: MIT
 * How much light does every sample get before anything is shot? From punctual lights and from the sky, past whatever
 * stands between.
 *
 * If time runs out, the directions of the sky that were looked in, which are spread over it then, stand for all.
 *
 * Every direction to look in is a light sample: a face of the cube around a light, a direction to the sun, a patch of
 * the sky. Light samples are drawn by any worker; the mesh's samples add them up in their order, so the sums have the
 * same bits for any number of threads.
 */
#ifndef HEMIBAKE_CORE_LIGHT_DIRECT_LIGHT_H
#define HEMIBAKE_CORE_LIGHT_DIRECT_LIGHT_H

#include "base/jobs.h"
#include "light/punctual.h"
#include "light/shadow_view.h"
#include "light/sky.h"
#include "mesh/mesh.h"

/* How finely the sky is divided (sky.h), how many pixels across are looked at, and how many directions to a disc. */
typedef struct direct_light_quality {
    int fineness, resolution, resolution_sky, sun_directions;
} direct_light_quality;

typedef struct direct_light_setup {
    const scene *scene;
    const mesh *mesh;
    const item_geometry *items;
    const uint32_t *triangle_surface; /* of the item geometry */
    const punctual *lights;
    size_t light_count;
    bool only_parallel;             /* what has a place among the lights is left out */
    const sky *sky;                 /* NULL: none */
    int resolution, resolution_sky; /* pixels across the view of a light, and of a patch of the sky */
    int sun_directions;             /* over a directional light's disc, or places if it has none; 2^n */
    jobs *jobs;
    double deadline_s;                             /* by clock; past it, so much of the sky is enough; 0: none */
    double (*clock)(void);                         /* seconds; for deadline_s */
    bool (*progress)(void *user, double fraction); /* may be NULL; false: stop */
    void *progress_user;
} direct_light_setup;

typedef struct direct_light {
    double *irradiance; /* irradiance[3*s+c] of sample s, W/m2; from block_new */
    float *row_sum; /* row_sum[s]: cosine-weighted share of the sky that is seen, and 1 for each light; a block too */
    float *uneven;  /* uneven[s], (W/m2)2: variance of the irradiance by lights, mean of the bands, over what sample s
                       stands for, which has its mean; of a few pairs of places, so that it may be below 0 where it is
                       small; a block; NULL: lights are looked for at samples' own places */
    double punctual_w, sky_w; /* what arrived at fronts, W ... */
    double crowd_w;           /* ... of punctual_w from lights that rows drew among; theirs to say */
    double seconds;           /* that it took; the caller's */
    bool cancelled;
} direct_light;

/* NULL on success, else why it failed. */
const char *direct_light_compute(const direct_light_setup *setup, direct_light *out, char *message,
                                 size_t message_size);
void direct_light_free(direct_light *a);

#endif
