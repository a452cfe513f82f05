/* SPDX-License-Identifier: MIT
 * Which rows need more rays? Those whose first rays met the most different light: n rays of a sample are off by
 * sigma / sqrt(n), so the error of all is least for n in proportion to rho sigma sqrt(A). A share of the further rays
 * is aimed where what is met differs by more than itself.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_BUDGET_H
#define HEMIBAKE_CORE_SOLVER_ROW_BUDGET_H

#include "solver/row_rays.h"

/* Rays that go ahead of the rest, aimed where first rays found what is bright, so that the rest is aimed better; false:
 * nowhere. */
bool row_budget_scout(const row_rays *r, const row_aims *aims, row_counts *counts);

/* counts[e] of about so many further rays in all, from counts of first ones. */
void row_budget_share(const row_rays *r, const row_aims *aims, double total, row_counts *counts);

#endif
