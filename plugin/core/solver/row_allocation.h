/* SPDX-License-Identifier: MIT
 * Which samples need more rays? Those whose initial rays hit the most different light: n rays of a sample are off by
 * sigma / sqrt(n), so the error of all is least for n in proportion to rho sigma sqrt(A), Neyman's allocation. A share
 * of the adaptive rays is guided where what is hit differs by more than itself. Shadow rays are shared out alike: where
 * lamps are seen in part, and most where that is bright, since all that such elements light would be off with them.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_ALLOCATION_H
#define HEMIBAKE_CORE_SOLVER_ROW_ALLOCATION_H

#include "solver/row_rays.h"

/* Pilot rays, guided to where initial rays found what is bright, so that the rest is guided better; false: nowhere. */
bool row_allocation_pilot(const row_rays *r, const row_guiding *guiding, row_counts *counts);

/* counts[e] of about so many adaptive rays in all, from counts of initial ones. False when out of memory. */
bool row_allocation_share(const row_rays *r, const row_guiding *guiding, double total, row_counts *counts);

/* times[e]: by how many times what its samples had so far the rays of element e are to grow, so that all grow by about
 * `share`: most where the halves of its rays, and of its neighbours', differ most. False when out of memory. */
bool row_allocation_repeat(const mesh *m, const double *half_difference, double share, uint16_t *times);

#endif
