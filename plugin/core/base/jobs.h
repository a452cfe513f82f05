/* SPDX-License-Identifier: MIT
 * How does work spread over threads without its result depending on them? Items are claimed in any order by any
 * worker, and each writes only to its own place; whoever sums does so afterwards, in index order.
 */
#ifndef HEMIBAKE_CORE_BASE_JOBS_H
#define HEMIBAKE_CORE_BASE_JOBS_H

#include "base/kept_results.h"
#include "base/ranks.h"

typedef struct jobs jobs;

/* item in [0, count); worker in [0, jobs_worker_count): the same worker is always the same thread. */
typedef void (*jobs_fn)(void *user, size_t item, unsigned worker);

/* Runs on the calling thread about every 50 ms while the workers work, and once at the end. False: items that no
 * worker has begun are dropped. */
typedef bool (*jobs_wait_fn)(void *user);

/* threads = 0: one for each online core. NULL when out of memory or threads. The second takes memory from an allocator,
 * the first from the C library. */
jobs *jobs_create(unsigned threads);
jobs *jobs_create_from(allocator *memory, unsigned threads);
void jobs_destroy(jobs *j);
unsigned jobs_worker_count(const jobs *j);

/* Where whoever works with these jobs takes memory from. */
allocator *jobs_memory(const jobs *j);

/* Who keeps results of what is done with these jobs; NULL, as at first: nobody. */
void jobs_set_kept(jobs *j, kept_results *kept);

/* Begins a pass of theirs. j may be NULL. */
kept_pass jobs_begin_pass(jobs *j);

/* Which processes share what is done with these jobs; NULL, as at first: this one is alone. */
void jobs_set_ranks(jobs *j, ranks *r);
ranks *jobs_ranks(const jobs *j);

/* Blocks until every item is done. wait may be NULL. False if wait returned false. Without jobs (NULL) the caller does
 * all of them. */
bool jobs_run(jobs *j, size_t count, jobs_fn fn, jobs_wait_fn wait, void *user);

/* The same for work that has an order: the caller watches, and a thread of its own does it, which may run jobs where
 * parts of it have none. */
bool jobs_run_alone(void (*fn)(void *user), jobs_wait_fn wait, void *user);

/* Who waits for work that takes long, and how long still. */
typedef struct watcher {
    jobs_wait_fn wait; /* as in jobs_run; may be NULL */
    void *user;
    const atomic_bool *over; /* set: what there is is made the best of, soon; any thread may ask; NULL: never */
} watcher;

static inline bool watcher_over(const watcher *w) {
    return w->over && atomic_load_explicit(w->over, memory_order_relaxed);
}

/* Calls fn(user, w, w) once on every worker w: for what belongs to a thread, such as its OpenGL context. */
void jobs_run_on_each_worker(jobs *j, jobs_fn fn, void *user);

#endif
