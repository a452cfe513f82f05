/* SPDX-License-Identifier: MIT
 * Which rows are this process's own, where several share a bake (base/ranks.h)? Rows are independent of each other: who
 * has cast one keeps it, gathers by it, and gives what its samples received, or its element reflects, to the others.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_SHARING_H
#define HEMIBAKE_CORE_SOLVER_ROW_SHARING_H

#include "base/ranks.h"
#include "mesh/mesh.h"

typedef struct row_sharing {
    ranks *ranks;
    const mesh *mesh;
    uint32_t *owner; /* owner[e]; NULL: there are no others */
} row_sharing;

/* Elements of a run of so many are together, by their numbers or, where of_element is not NULL, by of_element[e].
 * r: NULL where there are no others. False when out of memory. */
bool row_sharing_open(ranks *r, const mesh *m, const uint32_t *of_element, uint32_t together, row_sharing *out);
void row_sharing_free(row_sharing *s);

/* s may be NULL: all are. */
static inline bool row_sharing_is_own(const row_sharing *s, size_t e) {
    return !s || !s->owner || s->owner[e] == s->ranks->rank;
}

/* Gives all what their owners have: so many bytes an element, or a sample. s may be NULL. False: out of memory, or the
 * others are lost. */
bool row_sharing_give_elements(const row_sharing *s, void *all, size_t size);
bool row_sharing_give_samples(const row_sharing *s, void *all, size_t size);

#endif
