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

/* Which leaves were split, pass by pass, so that they can be again. */
typedef struct split_record {
    uint32_t *counts; /* counts[i]: leaves before pass i, each with a mark of its own: 1, it was split */
    uint8_t *marks;
    size_t pass_count, pass_capacity, mark_count, mark_capacity;
} split_record;

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
    split_record splits;
    uint64_t geometry; /* the caller's, of the elements */
    uint32_t *roots;   /* of the parts that took the place of the elements: which each is of; NULL: none did */
} final_gather;

/* Without guiding, counts and light: what rays are cast in, with elements of its own. NULL: message says why, or
 * nothing when out of memory. open_distance: as in rows_setup. */
final_gather *final_gather_open(const scene *s, const mesh *m, jobs *j, double open_distance, char *message,
                                size_t message_size);

/* From now on its mesh may become that of parts of its elements. False when out of memory. */
bool final_gather_own_elements(final_gather *r);

/* Keeps the marks of one more pass; r may be NULL. False when out of memory. */
bool final_gather_keep_split(final_gather *r, const bool *marks, uint32_t count);

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
