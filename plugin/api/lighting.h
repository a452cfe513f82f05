/* SPDX-License-Identifier: MIT
 * What arrives in a frozen scene from lights and sky, before anything is shot?
 */
#ifndef HEMIBAKE_API_LIGHTING_H
#define HEMIBAKE_API_LIGHTING_H

#include "freeze.h"

#include "light/arrival.h"

typedef struct lighting {
    punctual *lights;
    sky sky;
    bool has_sky, sky_by_default;
    arrival arrival;
    double seconds;
} lighting;

/* Does any patch emit? */
bool lighting_surfaces_emit(const frozen *f);

/* Looks for the light of in's lights and sky, or of a sky of radiance 1 where nothing else gives any. deadline_s: of
 * monotonic_seconds, past which the sky is looked at less finely; 0: none. progress may be NULL. HEMI_ERROR_NO_LIGHT:
 * no light reaches a front. */
hemi_result lighting_compute(const hemi_scene *in, hemi_quality quality, double deadline_s, const frozen *f,
                             bool (*progress)(void *user, double fraction), void *user, lighting *out);

/* What lights alone give to other samples of the same scene, of a mesh of f's surfaces, once lighting has been
 * computed.
 */
hemi_result lighting_lights(const hemi_scene *in, hemi_quality quality, const frozen *f, const mesh *receiving,
                            lighting *l, arrival *out);

/* arrived[3*s+c] for the solver; NULL if there are neither lights nor a sky. */
const double *lighting_arrived(const lighting *l);

void lighting_free(lighting *l);

#endif
