/* SPDX-License-Identifier: MIT
 * How fine must elements be, and where? Once the light has settled on coarse elements, those over which it is not
 * linear are cut, and what their parts receive is gathered; again, until what is left is below the goal or the budget
 * is used up. Or all are cut alike: elements of one size that are many to a patch.
 */
#ifndef HEMIBAKE_API_ADAPT_H
#define HEMIBAKE_API_ADAPT_H

#include "build_scene.h"

#include "light/lights.h"

#include "solver/progressive.h"

typedef struct adapt_setup {
    const hemi_scene *in;
    const bake_options *options; /* resolved */
    const lights *lights;
    direct_light_setup arriving;                   /* of light on samples that there were not before */
    bool (*progress)(void *user, double fraction); /* may be NULL; false: stop */
    void *progress_user;
} adapt_setup;

/* Replaces the mesh of f by that of the leaves, and what direct and light have at its samples. HEMI_CANCELLED.
 * *fine_share: of shooters and adapted elements, the pairs that were received finely. */
hemi_result adapt(const adapt_setup *setup, bake_scene *f, direct_light *direct, progressive_result *light,
                  double *fine_share);

#endif
