/* SPDX-License-Identifier: MIT
 * Where do columns come from, and how long are they kept? They are computed in batches, one a worker thread at a time,
 * the ones first that will be wanted soonest; they are kept while they fit the memory limit and computed again past it.
 *
 * Same bits for any number of threads: which columns are computed together depends on the state of the solution alone,
 * and each column on its piece alone.
 */
#ifndef HEMIBAKE_CORE_SOLVER_COLUMN_STORE_H
#define HEMIBAKE_CORE_SOLVER_COLUMN_STORE_H

#include "base/jobs.h"
#include "solver/row_closure.h"
#include "solver/shooters.h"

/* Of all columns, each counted once however often it was computed. */
typedef struct column_statistics {
    uint32_t columns, hemicubes, split, clipped;
    uint64_t analytic, evaluations;
    double closure_min, closure_max, closure_sum; /* of total over the front fraction of the hemi-cube */
    uint32_t recomputed;
} column_statistics;

typedef struct column_store {
    const column_setup *setup;
    jobs *jobs;
    shooters *shooters;
    uint64_t memory_limit, bytes;
    double (*clock)(void);
    bool (*wait)(void *user); /* as jobs_wait_fn; may be NULL */
    void *wait_user;
    double *row_sum;          /* row_sum[s]: sum of the form factors of all columns at sample s, each counted once */
    double *row_sum_emitters; /* the same of emitters alone */
    row_closure *rows;        /* when set, applied to every column that is computed */
    const double
        *delivered; /* delivered[3*s+c]: what columns that were let go have given to sample s, and what arrived */
    bool *crossed;  /* crossed[p]: something stands on patch p */
    bool lit_only;  /* compute ahead only what has something to shoot */
    column_statistics statistics;
    double seconds; /* spent computing */
    column_worker **workers;
    char (*messages)[128];
} column_store;

/* The fields above statistics have been set; row_sum and crossed are the caller's. False when out of memory. */
bool column_store_open(column_store *s);
void column_store_close(column_store *s);

/* Makes sure that shooter `wanted` has a column, and others on the way. NULL, or why it failed; when waiting was ended
 * early, or `wanted` was a cluster that had to be dissolved, there is no failure and maybe no column. */
const char *column_store_fetch(column_store *s, uint32_t wanted);

/* Takes a column that was found otherwise; NULL is nothing. */
void column_store_put(column_store *s, uint32_t index, column *c);

/* Past the memory limit, lets a column go. True if it did. */
bool column_store_is_full(const column_store *s);
void column_store_drop(column_store *s, uint32_t index);

#endif
