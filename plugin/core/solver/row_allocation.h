/* SPDX-License-Identifier: MIT
 * Which rows need more rays? Those whose initial rays hit the most different light: n rays of a sample are off by
 * sigma / sqrt(n), so the error of all is least for n in proportion to rho sigma sqrt(A), Neyman's allocation. A share
 * of the adaptive rays is guided where what is hit differs by more than itself.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_ALLOCATION_H
#define HEMIBAKE_CORE_SOLVER_ROW_ALLOCATION_H

#include "solver/row_rays.h"

/* Pilot rays, guided to where initial rays found what is bright, so that the rest is guided better; false: nowhere. */
bool row_allocation_pilot(const row_rays *r, const row_guiding *guiding, row_counts *counts);

/* counts[e] of about so many adaptive rays in all, from counts of initial ones. False when out of memory. */
bool row_allocation_share(const row_rays *r, const row_guiding *guiding, double total, row_counts *counts);

#endif
