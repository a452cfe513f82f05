/* SPDX-License-Identifier: MIT
 * What light is known on the leaves of a refined mesh? All that there is at the samples of the mesh of the leaves,
 * which it follows when they are split.
 */
#ifndef HEMIBAKE_CORE_ADAPT_LEAF_LIGHT_H
#define HEMIBAKE_CORE_ADAPT_LEAF_LIGHT_H

#include "mesh/refinement.h"

/* [s], and [3*s+c] where it has bands. */
typedef struct leaf_light {
    double *irradiance, *row_sum;
    double *arrived; /* of the irradiance: from lights and the sky; NULL: there are none */
    float *direct_row_sum;
    float *uneven;           /* as in direct_light; or NULL */
    double *half_difference; /* of rows: an error like that of the irradiance; NULL: by columns */
} leaf_light;

void leaf_light_free(leaf_light *l);

/* Copies samples: those from `from` on there to those from `to` on here. */
void leaf_light_copy(const leaf_light *in, size_t from, size_t count, const leaf_light *out, size_t to);

/* One sample there: the weighted sum of `count` samples from `from` on here, or 0 where that is less. */
void leaf_light_blend(const leaf_light *in, size_t from, const double w[4], int count, const leaf_light *out,
                      size_t to);

/* After a split: next is what was known before of leaves that were not split, where they are now; new ones have 0.
 * False when out of memory; to be freed all the same. */
bool leaf_light_follow(allocator *memory, const leaf *leaves, uint32_t count, const leaf_light *before,
                       leaf_light *next);

#endif
