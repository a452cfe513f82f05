/* SPDX-License-Identifier: MIT
 * Does the library under test have rays? A desc that asks a build without Embree for them is refused, whatever the
 * scene.
 */
#ifndef HEMIBAKE_TESTS_API_RAYS_H
#define HEMIBAKE_TESTS_API_RAYS_H

#include "check.h"

#include <hemibake/hemibake.h>

#include <stdbool.h>

static inline bool has_rays(void) {
    hemi_context *context = NULL;
    hemi_scene *scene = NULL;
    hemi_forecast forecast = { .struct_size = sizeof forecast };
    const hemi_bake_desc desc = { .struct_size = sizeof desc, .visibility = HEMI_VISIBILITY_RAYS };
    CHECK_EQUAL(hemi_context_create(NULL, &context), HEMI_OK);
    CHECK_EQUAL(hemi_scene_create(context, &scene), HEMI_OK);
    bool ok = hemi_scene_forecast(scene, &desc, &forecast) != HEMI_ERROR_ARGUMENT;
    hemi_scene_destroy(scene);
    hemi_context_destroy(context);
    return ok;
}

#endif
