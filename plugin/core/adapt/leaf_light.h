/* SPDX-License-Identifier: MIT
 * What light is known on the leaves of a refined mesh? All that there is at their samples, leaf by leaf, so that it can
 * follow them when they are split, and be put in the order of a mesh's samples.
 */
#ifndef HEMIBAKE_CORE_ADAPT_LEAF_LIGHT_H
#define HEMIBAKE_CORE_ADAPT_LEAF_LIGHT_H

#include "mesh/refinement.h"

enum { LEAF_SAMPLES_MAX = 4 };

/* At [LEAF_SAMPLES_MAX*leaf+k], times three where it has bands; or at the samples of a mesh. */
typedef struct leaf_light {
    double *irradiance, *row_sum;
    double *arrived; /* of the irradiance: from lights and the sky; NULL: there are none */
    float *direct_row_sum;
} leaf_light;

/* Zeroed; arrives: are there lights or a sky? False when out of memory; to be freed all the same. */
bool leaf_light_create(allocator *memory, size_t leaves, bool arrives, leaf_light *out);
void leaf_light_free(leaf_light *l);

/* Copies samples: those from `from` on there to those from `to` on here, which may be the same arrays. */
void leaf_light_copy(const leaf_light *in, size_t from, size_t count, const leaf_light *out, size_t to);

/* From the samples of a mesh to its elements as leaves, and back; out may be the same arrays when going back, since no
 * sample comes later. */
void leaf_light_take(const mesh *m, const leaf_light *samples, const leaf_light *leaves);
void leaf_light_give(const mesh *m, const leaf_light *leaves, const leaf_light *samples);

/* After a split: what is known of leaves that were not split goes to where they are now; new ones have 0. False when
 * out of memory. */
bool leaf_light_follow(allocator *memory, const leaf *leaves, uint32_t count, bool arrives, leaf_light *l);

#endif
