/* SPDX-License-Identifier: MIT
 * What arrives in a bake_scene scene from lights and sky, before anything is shot?
 */
#ifndef HEMIBAKE_API_SCENE_LIGHT_H
#define HEMIBAKE_API_SCENE_LIGHT_H

#include "build_scene.h"

#include "light/direct_light.h"

typedef struct scene_light {
    punctual *lights;
    sky sky;
    bool has_sky, sky_by_default;
    direct_light direct_light;
    double seconds;
} scene_light;

/* Does any patch emit? */
bool scene_light_surfaces_emit(const bake_scene *f);

/* Looks for the light of in's lights and sky, or of a sky of radiance 1 where nothing else gives any. deadline_s: of
 * monotonic_seconds, past which the sky is looked at less finely; 0: none. progress may be NULL. HEMI_ERROR_NO_LIGHT:
 * no light reaches a front. */
hemi_result scene_light_compute(const hemi_scene *in, hemi_quality quality, double deadline_s, const bake_scene *f,
                                bool (*progress)(void *user, double fraction), void *user, scene_light *out);

/* What lights alone give to other samples of the same scene, of a mesh of f's surfaces, once scene_light has been
 * computed.
 */
hemi_result scene_light_punctual(const hemi_scene *in, hemi_quality quality, const bake_scene *f, const mesh *receiving,
                                 scene_light *l, direct_light *out);

/* arrived[3*s+c] for the solver; NULL if there are neither lights nor a sky. */
const double *scene_light_irradiance(const scene_light *l);

void scene_light_free(scene_light *l);

#endif
