/* SPDX-License-Identifier: MIT
 * Which elements are to be split? Those that are off by most, until what is left is below the goal.
 */
#ifndef HEMIBAKE_CORE_ADAPT_WORST_ELEMENTS_H
#define HEMIBAKE_CORE_ADAPT_WORST_ELEMENTS_H

#include "mesh/refinement.h"

/* What the leaves of a refinement are off by, and which of them are marked. */
typedef struct worst_elements {
    double *errors, *levels, *areas; /* of leaves: squares, of radiance too, integrated over them; m2 */
    double level, area;              /* of all */
    struct worst_candidate *candidates;
    bool *marks;
    size_t count;
} worst_elements;

/* False when out of memory; to be freed all the same. */
bool worst_elements_create(allocator *memory, size_t leaves, worst_elements *out);
void worst_elements_free(worst_elements *w);

/* Takes the areas of the elements of a mesh of the leaves, once errors and levels, which are the caller's, are set.
 * What lies far out in surroundings that are far larger than what is among them counts for nothing: it would count for
 * all. by_rows: elements were small before any was split; where they were not, those of smooth surfaces count for more.
 */
void worst_elements_weigh(worst_elements *w, const scene *s, const mesh *m, bool by_rows);

/* How many splits, of three more leaves each, make up to so many leaves. */
static inline size_t worst_elements_splits(const worst_elements *w, uint32_t leaves_max) {
    return leaves_max > w->count ? (leaves_max - w->count) / 3 : 0;
}

/* Marks the worst leaves of less than `levels` levels until what is left is below the goal, a relative error, or `most`
 * are marked; up to `far` until what is left is no more than some times the goal. Returns how many are. */
size_t worst_elements_mark(worst_elements *w, const leaf *leaves, int levels, double goal, size_t most, size_t far);

#endif
