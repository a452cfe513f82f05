/* SPDX-License-Identifier: MIT
 * What does the slope of a shooter's radiosity give to those near it? A shooter is taken to be as bright all over as it
 * is in the mean. From afar nobody sees the difference; a floor near the wall does: it sees more of the wall's lower
 * edge. There each element of the shooter shoots what it has more than the mean, past what the shooter's column says
 * stands between:
 *
 *     dE(s) = v sum_e c_e F_se B_e - F_si B_i,   v = F_si / (k sum_e c_e F_se)
 *
 * over the elements e of shooter i, a patch or the members of a cluster: c_e is the share of an element that nothing
 * stands on, B_e its radiosity there, k what the column was scaled with to make up for what is covered, and v the share
 * that the sample sees. What is given so is reflected again by what is near: in a slot of 8 mm light goes to and fro
 * where patches of a decimetre know only its mean. So it is found anew, B_e as it then is and B_i as it was shot,
 * until it changes little.
 */
#ifndef HEMIBAKE_CORE_SOLVER_SHOOTER_GRADIENT_H
#define HEMIBAKE_CORE_SOLVER_SHOOTER_GRADIENT_H

#include "solver/column_store.h"

typedef struct shooter_gradient {
    const scene *scene;
    const mesh *mesh; /* that was solved with */
    double *B;        /* B[3*e+c] of the elements, where they are clear, W/m2 */
    float *clear;     /* c_e */
    float *coverage;  /* share of the element that is no hole */
    double *shot;     /* shot[3*p+c]: what the shooter that goes by patch p shot, over its whole area, W/m2 */
    bool *even;       /* even[p]: nothing of it is worth it */
} shooter_gradient;

/* irradiance[3*s+c] and row_sum[s] (sum of form factors) of the mesh's samples; crossed[p]: something stands on patch
 * p; shot: as in shooter_gradient, NULL: the mean of what is reflected now. False when out of memory. */
bool shooter_gradient_create(const scene *s, const mesh *m, const double *irradiance, const double *row_sum,
                             const bool *crossed, const double *shot, shooter_gradient *out);
void shooter_gradient_free(shooter_gradient *n);

/* Is the receiver so near to a shooter that its slope counts? */
bool shooter_gradient_reaches(const shooter_gradient *n, const subpatch *from, const column_receiver *r);

/* How far it is from the shooter's nearest element, about, m. */
double shooter_gradient_gap(const shooter_gradient *n, const subpatch *from, const column_receiver *r);

/* excess[3*k+c]: by how much the shooter is brighter than its mean as sample k of the receiver sees it where nothing
 * stands between, so that dE = F_si excess; W/m2, 0 where it sees none of it. True if all see some. scratch: room for
 * two numbers a sample. */
bool shooter_gradient_excess(const shooter_gradient *n, const column *c, const subpatch *from, const mesh *receiving,
                             const column_receiver *r, double *scratch, double *excess);

/* E[3*k+c] += dE of sample k of the receiver, whose factors from the shooter are factors[k] in its column c. scratch:
 * room for SHOOTER_GRADIENT_SCRATCH numbers a sample. */
enum { SHOOTER_GRADIENT_SCRATCH = 5 };

void shooter_gradient_add(const shooter_gradient *n, const column *c, const subpatch *from, const mesh *receiving,
                          const column_receiver *r, const float *factors, double *scratch, double *E);

/* irradiance += dE at all samples of the mesh that was solved with, from all shooters that had columns, until it
 * changes little; n is then of the light before that. False when out of memory. */
bool shooter_gradient_correct(shooter_gradient *n, column_store *from, const double *row_sum, const bool *crossed,
                              double *irradiance);

#endif
