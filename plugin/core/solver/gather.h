/* SPDX-License-Identifier: MIT
 * How much light has each sample received? E_s = sum_j F_sj B_j over what the shooters have shot [Baum89, eq. 4].
 * Columns that are kept are gathered once at the end; one that is let go delivers before.
 */
#ifndef HEMIBAKE_CORE_SOLVER_GATHER_H
#define HEMIBAKE_CORE_SOLVER_GATHER_H

#include "base/jobs.h"
#include "solver/shooters.h"

/* irradiance[3*s+c] += what all kept columns still deliver, in shooter order whatever the thread. False when out of
 * memory. */
bool gather_all(const shooters *s, jobs *j, double *irradiance);

/* The same for one column, which has then delivered. */
void gather_deliver(shooters *s, uint32_t index, double *irradiance);

/* E[3*k+c] of sample k of one patch so far. irradiance: what has been delivered. */
void gather_patch(const shooters *s, uint32_t patch_index, const double *irradiance, double *E);

#endif
