/* SPDX-License-Identifier: MIT
 * Do the form factors that a point receives add up to 1? In a closed room they must: sum_j F_sj = 1 at every sample.
 * Columns are found one by one and scaled so that each shooter gives away what it has; that leaves rows a percent or so
 * off where shooters are near. Each row is corrected in proportion to its factors,
 *
 *     F'_sj = F_sj (1 + k_s w_j),   sum_j F'_sj = 1,
 *
 * with small w for emitters, whose factors are the surer ones. In a white furnace this makes B = M / (1 - rho) exact at
 * every sample; without it an error d of a row is one of d rho / (1 - rho) in B.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_CLOSURE_H
#define HEMIBAKE_CORE_SOLVER_ROW_CLOSURE_H

#include "formfactor/column.h"

typedef struct row_closure {
    float *correction; /* k_s, 0 where the row is not corrected */
} row_closure;

/* k of a sample from the sum of all its factors and that of emitters; 0 where the row is far off. */
double row_closure_correction(double row_sum, double row_sum_emitters);

/* What a factor is multiplied with. */
double row_closure_factor(double correction, bool emitter);

/* row_sum[s]: sum of all factors of sample s, row_sum_emitters[s]: those of emitters. Rows that are far off, as of
 * samples inside something, stay. False when out of memory. */
bool row_closure_find(const mesh *m, const double *row_sum, const double *row_sum_emitters, row_closure *out);
void row_closure_free(row_closure *r);

/* Corrects the factors of a column, and the patch averages and the total with them. */
void row_closure_apply(const row_closure *r, const column_setup *setup, uint32_t shooting_patch, column *c);

#endif
