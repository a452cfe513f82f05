/* SPDX-License-Identifier: MIT
 * What do parts of elements receive, once the light has settled by rows? Rows of their own, of rays that meet the
 * elements that the light has settled on, as many and aimed as those of the element that they are parts of. Nothing is
 * iterated: what the elements reflect is known.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROWS_SETTLED_H
#define HEMIBAKE_CORE_SOLVER_ROWS_SETTLED_H

#include "base/jobs.h"
#include "light/lights.h"
#include "solver/row_rays.h"

/* What is left of rows that were solved. */
typedef struct rows_settled {
    const scene *scene;
    const mesh *mesh;
    const lights *lights;
    jobs *jobs;
    uint64_t seed;
    int emitter_rays;
    arena memory; /* of the items */
    mesh_items items;
    rays *rays;
    row_aims aims;
    row_counts *counts; /* of the rays of each element */
    double *B;          /* B[3*e+c]: what element e reflects */
} rows_settled;

void rows_settled_free(rows_settled *r); /* NULL is fine */

typedef struct rows_received {
    double *irradiance, *row_sum, *halves; /* as in rows_result, without punctual lights */
    bool cut;                              /* wait said false: there is nothing */
} rows_received;

/* fine: parts of elements; roots[e]: of which. False when out of memory. */
bool rows_receive(const rows_settled *r, const mesh *fine, const uint32_t *roots, bool (*wait)(void *user), void *user,
                  rows_received *out);
void rows_received_free(rows_received *r);

#endif
