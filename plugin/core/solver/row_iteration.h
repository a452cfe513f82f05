/* SPDX-License-Identifier: MIT
 * How often is light gathered by rows until it has settled? Each iteration is one more bounce [Baum89, eq. 1 and 4].
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_ITERATION_H
#define HEMIBAKE_CORE_SOLVER_ROW_ITERATION_H

#include "base/jobs.h"
#include "mesh/mesh.h"

/* Iterations end when what those to come would change is less than a share of the light, and of that a smaller share
 * where light settles fast. What is outside a house in the sun has a thousand times the light of a room behind its
 * window, which is to settle too; insides of closed white things, which nobody sees, take a thousand iterations to. */
typedef struct row_tolerance {
    double all, fast;
} row_tolerance;
static const row_tolerance ROW_ITERATION_CONVERGED = { 1e-4, 1e-5 };

typedef struct row_iteration {
    allocator *memory;
    jobs *jobs;              /* that compare iterations; NULL: the caller does */
    const element *elements; /* that reflect, for their areas */
    size_t element_count;
    double *B, *next; /* B[3*e+c]: what element e reflects, by the last iteration; swapped by each */
    double *kept;     /* the same before the last extrapolation */
    float *change;    /* change[3*e+c]: what the last iteration changed */
    double *sums;     /* of its changes, by blocks of elements */
    /* Gathers B into samples, and what these reflect into next. */
    void (*gather)(void *user, const double *B, double *next);
    double worth; /* of an iteration, in those by which all gather at once, where light settles slowly; 0: 1 */
    bool (*go_on)(void *user); /* false: somebody cancels */
    void *user;
    int count;         /* iterations so far */
    double residual_w; /* what the last one changed, or what the last bounce would carry on ... */
    double residual;   /* ... of what is reflected; 1 before the first */
} row_iteration;

/* With no light yet. The caller's fields are set before. False when out of memory; to be freed all the same. */
bool row_iteration_open(row_iteration *r);
void row_iteration_free(row_iteration *r);

/* Until what iterations to come would change is less than this. */
void row_iteration_settle(row_iteration *r, row_tolerance tolerance);

/* From none: what is direct, and so many bounces more, or fewer where may_go_on says no. What was found on the way
 * there is of no use. */
void row_iteration_bounces(row_iteration *r, int further, bool (*may_go_on)(void *user));

#endif
