/* SPDX-License-Identifier: MIT
 * Which values meet the normal equations of a fit best? A sparse symmetric matrix of the nodes of one part, and
 * conjugate gradients with a diagonal preconditioner, three bands at a time. Large parts are worked on by all threads,
 * a few thousand nodes each; sums run over these in order, so that the result does not depend on the threads.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_FIT_SOLVE_H
#define HEMIBAKE_CORE_RECONSTRUCT_FIT_SOLVE_H

#include "base/jobs.h"

#include <stdint.h>

/* Row v has the entries first[v] to first[v] + length[v] - 1, the first of which is the diagonal's. All zero at first;
 * one may be used for many parts, one after another. */
typedef struct fit_matrix {
    size_t count;
    size_t *first;
    uint32_t *length, *column;
    double *value;
    double *r, *x; /* [3*v+c]: the right side, which solving uses up, and the solution */
    double *p, *q; /* direction, and matrix times direction */
    double *sums;  /* of the shares of jobs: sums[3*job+c] */
    size_t nodes_room, length_room, entries_room, values_room;
    size_t r_room, x_room, p_room, q_room, sums_room;
} fit_matrix;

/* Begins a part of so many nodes, all zero. room[v]: entries that row v is to have room for, at least 1. False when out
 * of memory. */
bool fit_matrix_begin(allocator *memory, size_t count, const uint32_t *room, fit_matrix *a);
void fit_matrix_free(fit_matrix *a);

/* Adds to the entry (row, column); there must be room for it. */
void fit_matrix_add(fit_matrix *a, uint32_t row, uint32_t column, double value);

/* x of matrix x = r; how many iterations it took. jobs NULL: the caller does all of it. */
int fit_solve(fit_matrix *a, jobs *j, const watcher *watch);

#endif
