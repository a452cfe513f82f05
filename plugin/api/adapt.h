/* SPDX-License-Identifier: MIT
 * How fine must elements be, and where? Once the light has settled on coarse elements, those over which it is not
 * linear are cut, and what their parts receive is gathered; again, until what is left is below the goal or the budget
 * is used up. Or all are cut alike: elements of one size that are many to a patch.
 */
#ifndef HEMIBAKE_API_ADAPT_H
#define HEMIBAKE_API_ADAPT_H

#include "build_scene.h"
#include "scene_light.h"

#include "solver/progressive.h"

typedef struct adapt_setup {
    const hemi_scene *in;
    const hemi_bake_desc *desc; /* resolved */
    uint32_t even_levels;       /* how often all elements are cut, whatever their light; 0: by their light */
    bool (*progress)(void *user, double fraction); /* may be NULL; false: stop */
    void *progress_user;
} adapt_setup;

/* Replaces the mesh of f by that of the leaves, and what scene_light and light have at its samples. HEMI_CANCELLED. */
hemi_result adapt(const adapt_setup *setup, bake_scene *f, scene_light *lit, progressive_result *light,
                  hemi_statistics *s);

#endif
