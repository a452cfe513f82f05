/* SPDX-License-Identifier: MIT
 * What do parts of elements receive, once rows have converged on the elements? A final gather: rows of their own, of
 * rays that hit the elements, as many and guided as those of the element that they are parts of. Nothing is iterated:
 * what the elements reflect is known.
 */
#ifndef HEMIBAKE_CORE_SOLVER_FINAL_GATHER_H
#define HEMIBAKE_CORE_SOLVER_FINAL_GATHER_H

#include "base/jobs.h"
#include "light/lights.h"
#include "mesh/refinement.h"
#include "solver/row_rays.h"

/* What is left of rows that have converged. */
typedef struct final_gather {
    const scene *scene;
    const mesh *mesh; /* that rows converged on */
    mesh own;         /* what of it stays when its elements are split: elements and patches' numbers */
    const lights *lights;
    jobs *jobs;
    uint64_t seed;
    int emitter_rays;
    arena memory; /* of the items */
    mesh_items items;
    rays *rays;
    row_guiding guiding;
    row_counts *counts; /* of the rays of each element */
    double *B;          /* B[3*e+c]: what element e reflects */
    uint32_t *roots;    /* of the parts that took the place of the elements: which each is of; NULL: none did */
} final_gather;

/* From now on its mesh may become that of parts of its elements. False when out of memory. */
bool final_gather_own_elements(final_gather *r);

/* The leaves take the place of the elements. r may be NULL. False when out of memory. */
bool final_gather_keep_roots(final_gather *r, const leaf *leaves, uint32_t count);

void final_gather_free(final_gather *r); /* NULL is fine */

typedef struct final_gather_result {
    double *irradiance, *row_sum, *half_difference; /* as in rows_result, without punctual lights */
    bool cut;                                       /* wait said false: there is nothing */
} final_gather_result;

/* fine: parts of elements; roots[e]: of which. False when out of memory. */
bool final_gather_solve(const final_gather *r, const mesh *fine, const uint32_t *roots, bool (*wait)(void *user),
                        void *user, final_gather_result *out);
void final_gather_result_free(final_gather_result *r);

#endif
