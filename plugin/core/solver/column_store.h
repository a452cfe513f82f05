/* SPDX-License-Identifier: MIT
 * Where do columns come from, and how long are they kept? They are computed in batches, one a worker thread at a time,
 * the ones first that will be wanted soonest; they are kept while they fit the memory limit and computed again past it.
 * Whoever works with columns, or receives through them, gets columns and workers here.
 *
 * Same bits for any number of threads: which columns are computed together depends on the state of the solution alone,
 * and each column on its piece alone.
 */
#ifndef HEMIBAKE_CORE_SOLVER_COLUMN_STORE_H
#define HEMIBAKE_CORE_SOLVER_COLUMN_STORE_H

#include "base/jobs.h"
#include "solver/shooters.h"

/* Of all columns, each counted once however often it was computed. */
typedef struct column_statistics {
    uint32_t columns, hemicubes, split, clipped;
    uint64_t analytic, evaluations;
    double closure_min, closure_max, closure_sum; /* of total over the front fraction of the hemi-cube */
} column_statistics;

enum { COLUMN_BATCH = 32, COLUMN_MESSAGE_SIZE = 128 };

typedef struct column_store {
    column_setup setup; /* shoot is set here, and near_diameters if it is 0 */
    jobs *jobs;
    shooters *shooters;
    uint64_t memory_limit, bytes;
    double (*clock)(void);
    bool (*wait)(void *user); /* as jobs_wait_fn; may be NULL */
    void *wait_user;
    double *row_sum;          /* row_sum[s]: sum of the form factors of all columns at sample s, each counted once */
    double *row_sum_emitters; /* the same of emitters alone */
    /* delivered[3*s+c]: what columns that were let go have given to sample s, and what arrived */
    const double *delivered;
    bool *crossed;  /* crossed[p]: something stands on patch p */
    kept_pass kept; /* set here */
    bool lit_only;  /* compute ahead only what has something to shoot */
    column_statistics statistics;
    double seconds;          /* spent computing */
    column_worker **workers; /* of each worker thread of the jobs; NULL: not needed yet */
    char (*messages)[COLUMN_MESSAGE_SIZE];
} column_store;

/* The fields above statistics have been set; row_sum and crossed are the caller's. False when out of memory. */
bool column_store_open(column_store *s);
/* After column_store_rest. */
void column_store_close(column_store *s);

/* In a job: the column worker of a worker thread. NULL: s->messages[worker] says why. */
column_worker *column_store_worker(column_store *s, unsigned worker);

/* Between jobs: lets go of the column workers and their item buffers until one is wanted again. */
void column_store_rest(column_store *s);

/* Makes sure that shooter `wanted` has a column, and others on the way. NULL, or why it failed; when waiting was ended
 * early, or `wanted` was a cluster that had to be dissolved, there is no failure and maybe no column. */
const char *column_store_fetch(column_store *s, uint32_t wanted);

/* Some shooters, and their columns for as long as the batch is held. */
typedef struct column_batch {
    uint32_t shooters[COLUMN_BATCH];
    const column *columns[COLUMN_BATCH];
    size_t count;
    column *again[COLUMN_BATCH]; /* that had been let go; NULL: the shooter has its column */
} column_batch;

/* Finds the columns of the shooters of a batch; those that were let go are computed again. False when out of memory or
 * of OpenGL, or when waiting was ended early; the batch is to be released all the same. wait may be NULL. */
bool column_store_hold(column_store *s, column_batch *b, jobs_wait_fn wait, void *user);
void column_store_release(column_batch *b);

/* Takes a column that was found otherwise; NULL is nothing. False when out of memory. */
bool column_store_put(column_store *s, uint32_t index, column *c);

/* Finds what rows are closed with from the sums of the columns so far, and the closed averages of those that are kept.
 * False when out of memory. */
bool column_store_close_rows(column_store *s);

/* Adds a column to the row sums and the statistics, unless it is there already. What was computed ahead and never shot
 * is in neither, since that hangs on the memory limit. */
void column_store_count(column_store *s, uint32_t index);

/* Past the memory limit, lets a column go. */
bool column_store_is_full(const column_store *s);
void column_store_drop(column_store *s, uint32_t index);

#endif
