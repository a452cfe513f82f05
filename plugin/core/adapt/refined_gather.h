/* SPDX-License-Identifier: MIT
 * What do fine elements receive, once the light has settled on coarse ones? A shooter that is far from a coarse element
 * and wholly seen, or wholly hidden, gives its parts nearly the same: what it gives to the coarse samples is
 * interpolated, all such shooters at once. From a near one, or one whose visibility changes around the element, the
 * fine samples are received one by one, through the same hemi-cubes. So the cost follows the light, and not the number
 * of elements.
 *
 * For a sample s of a part of coarse element e, with B_i what shooter i has shot:
 *
 *     E(s) = sum over near or partly seen i of F_si B_i  +  interpolated sum over the others of F_ei B_i
 *
 * Rows are closed at the fine samples as they were at the coarse ones (row_closure.h).
 */
#ifndef HEMIBAKE_CORE_ADAPT_REFINED_GATHER_H
#define HEMIBAKE_CORE_ADAPT_REFINED_GATHER_H

#include "adapt/refined_elements.h"
#include "solver/shooter_gradient.h"

typedef struct refined_gather_setup {
    column_store *store;              /* the shooters of the coarse mesh, and their columns */
    const double *irradiance;         /* irradiance[3*s+c] of the coarse samples: what a shooter's share is taken of */
    const double *row_sum;            /* row_sum[s] of the coarse samples: sum of form factors */
    const shooter_gradient *gradient; /* NULL: shooters are even */
    const mesh *fine;                 /* its elements are parts of coarse ones, those of one beside each other */
    const fine_place *places;         /* of the fine elements */
    double tolerance;         /* of the irradiance: what one shooter may be off by before it is received finely */
    bool emitters_are_fine;   /* what emits is received finely, whatever it may be off by */
    bool (*wait)(void *user); /* as jobs_wait_fn; may be NULL */
    void *wait_user;
} refined_gather_setup;

typedef struct refined_gather_result {
    double *irradiance;      /* irradiance[3*s+c] of the fine samples from surfaces, W/m2; from malloc */
    double *row_sum;         /* row_sum[s]: sum of form factors; from malloc */
    double *half_difference; /* of rows, as in leaf_light; NULL: by columns */
    uint64_t fine, pairs;    /* shooter and coarse element: received finely, all */
    double done;             /* share of the shooters so far */
    bool cancelled;
} refined_gather_result;

/* NULL on success, else why it failed. */
const char *refined_gather(const refined_gather_setup *setup, refined_gather_result *out, char *message,
                           size_t message_size);
void refined_gather_free(refined_gather_result *r);

#endif
