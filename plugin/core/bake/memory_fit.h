/* SPDX-License-Identifier: MIT
 * How much memory does a bake take at its peak, and what of it is left out where less is allowed? Fewer rays, fewer
 * columns that are kept, fewer elements by refinement, in this order; what the scene takes as it is cut cannot be less.
 * Found by what is solved alone, never by what a machine has, so that the bytes of the result are the same everywhere.
 */
#ifndef HEMIBAKE_CORE_BAKE_MEMORY_FIT_H
#define HEMIBAKE_CORE_BAKE_MEMORY_FIT_H

#include "bake/quality.h"
#include "mesh/mesh.h"
#include "scene/scene.h"

/* Bytes of the process at its peak, as the options are; without what refinement adds. */
double memory_of_bake(const bake_options *o, const scene *s, const mesh *m);

/* How many elements can be in what is allowed, at most: for who has not cut the scene yet. */
uint32_t memory_most_elements(const bake_options *o);

/* Lowers what the options allow until the bake fits. False where it cannot: message says so with the figures, else it
 * says what a full matrix takes, or nothing. */
bool memory_fit(bake_options *o, const scene *s, const mesh *m, char *message, size_t message_size);

#endif
