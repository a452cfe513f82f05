/* SPDX-License-Identifier: MIT
 * Do the form factors that a point receives add up to 1? In a closed room they must: sum_j F_sj = 1 at every sample.
 * Columns are found one by one and scaled so that each shooter gives away what it has; that leaves rows a percent or so
 * off where shooters are near. Each row is corrected in proportion to its factors,
 *
 *     F'_sj = F_sj (1 + k_s w_j),   sum_j F'_sj = 1,
 *
 * with small w for emitters, whose factors are the surer ones. In a white furnace this makes B = M / (1 - rho) exact at
 * every sample; without it an error d of a row is one of d rho / (1 - rho) in B.
 *
 * Columns stay as they were found: factors are closed where they are summed.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_CLOSURE_H
#define HEMIBAKE_CORE_SOLVER_ROW_CLOSURE_H

#include "formfactor/column.h"

typedef struct row_closure {
    float *correction; /* k_s, 0 where the row is not corrected; NULL: rows are as they come */
} row_closure;

/* How much of a row's error is looked for in the factors of emitters: they are quartered until their parts agree, and
 * always closed forms, so an order of magnitude better than the rest. */
#define ROW_CLOSURE_EMITTER_SHARE 0.1

/* k of a sample from the sum of all its factors and that of emitters; 0 where the row is far off. */
double row_closure_correction(double row_sum, double row_sum_emitters);

/* What a factor is multiplied with. */
static inline double row_closure_factor(double correction, bool emitter) {
    return 1.0 + (emitter ? ROW_CLOSURE_EMITTER_SHARE : 1.0) * correction;
}

/* F' of a sample; a float as F is. */
static inline float row_closure_close(const row_closure *r, uint32_t sample, bool emitter, float F) {
    return r->correction ? (float)(F * row_closure_factor(r->correction[sample], emitter)) : F;
}

/* row_sum[s]: sum of all factors of sample s, row_sum_emitters[s]: those of emitters. Rows that are far off, as of
 * samples inside something, stay. False when out of memory. */
bool row_closure_find(const mesh *m, const double *row_sum, const double *row_sum_emitters, row_closure *out);
void row_closure_free(row_closure *r);

/* averages[i]: of F' over the patch of run i of a column, as column_run.factor is of F; NULL when out of memory. */
double *row_closure_averages(const row_closure *r, const mesh *m, bool emitter, const column *c);

#endif
