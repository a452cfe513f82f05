/* SPDX-License-Identifier: MIT
 * How fine must elements be, and where? Once the light has settled on coarse elements, those over which it is not
 * linear are split, and what their parts receive is gathered; again, until what is left is below the goal or the budget
 * is used up. Or all are split alike: elements of one size that are many to a patch.
 */
#ifndef HEMIBAKE_CORE_ADAPT_ADAPT_H
#define HEMIBAKE_CORE_ADAPT_ADAPT_H

#include "adapt/leaf_light.h"
#include "light/lights.h"
#include "solver/progressive.h"

typedef struct adapt_setup {
    refinement_setup refinement; /* of the mesh that was solved with */
    arena *memory;               /* of the mesh of leaves */
    int levels;                  /* how often an element may be split by its light */
    double error;                /* relative, by the size of elements: what is aimed at */
    uint32_t max_elements;
    uint32_t max_elements_far; /* the same where the goal is far off */
    uint32_t even_levels;      /* how often all elements are split, whatever their light; 0: by their light */
    const lights *lights;
    direct_light_setup arriving; /* of light on samples that there were not before */
    /* Estimates what linear interpolation of what will be shown is off by on a mesh of leaves with this light (errors
     * and levels: error_indicator.h). False when out of memory. */
    bool (*indicate)(const mesh *leaves, const leaf_light *light, const bool *crossed, jobs *j, double *errors,
                     double *levels);
    material *const *demodulated;     /* (*demodulated)[e]: element e without the texture that stays on it, or NULL */
    const char *(*shade)(void *user); /* gives the elements of the mesh the materials that textures make */
    void *shade_user;
    watcher watch; /* over: parts that have not received by then have what the coarse element has there */
} adapt_setup;

typedef struct adapt_result {
    uint64_t fine, pairs; /* of shooters and elements that were split: received finely, all */
    double done;          /* share of the work so far, about; does not fall */
    bool cancelled;
} adapt_result;

/* Makes the mesh that of the leaves, and puts what direct and solution have at its samples. NULL on success, else why
 * it failed. */
const char *adapt(const adapt_setup *setup, direct_light *direct, progressive_result *solution, adapt_result *out,
                  char *message, size_t message_size);

#endif
