/* SPDX-License-Identifier: MIT
 * Which rays need not be cast again? Those of a job of elements whose rows are kept (base/kept_results.h): what they
 * hit from ray `first` on, what all of them weigh, and what that makes of the sky and of the row's sum. Rows through
 * panes are not kept.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_KEPT_H
#define HEMIBAKE_CORE_SOLVER_ROW_KEPT_H

#include "base/kept_results.h"
#include "solver/row_rays.h"

/* Elements of a job, begin to end, at most ROW_KEPT_ELEMENTS; first[e - begin]: the first ray that is cast. hit_count:
 * elements that there are to hit. */
enum { ROW_KEPT_ELEMENTS = 64 };

typedef struct row_kept_job {
    row_rays *rays;
    const kept_pass *pass;
    size_t begin, end, hit_count;
    const uint16_t *first;
} row_kept_job;

/* False: the rays are to be cast. */
bool row_kept_take(const row_kept_job *job);
void row_kept_give(const row_kept_job *job);

#endif
