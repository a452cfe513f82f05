/* SPDX-License-Identifier: MIT
 * See jobs.h. The caller sleeps while the pool works, so it can report progress and nothing runs on its stack.
 */
#include "base/jobs.h"

#include <pthread.h>
#include <time.h>
#include <unistd.h>

enum { WORKERS_MAX = 256, WAIT_MS = 50 };

typedef struct worker {
    jobs *pool;
    pthread_t thread;
    unsigned index;
} worker;

struct jobs {
    allocator *memory;
    kept_results *kept;
    ranks *ranks;
    pthread_mutex_t mutex;
    pthread_cond_t work, done;
    worker *workers;
    unsigned worker_count;
    unsigned running;    /* workers that have not finished the present run */
    unsigned generation; /* counts runs, so that a worker takes part in each once */
    bool quit;
    bool each_worker; /* one item for each worker, its own */
    jobs_fn fn;
    void *user;
    size_t count;
    atomic_size_t next;
};

static void work_on_items(jobs *j, unsigned index) {
    if (j->each_worker) {
        j->fn(j->user, index, index);
        return;
    }
    for (;;) {
        size_t item = atomic_fetch_add(&j->next, 1);
        if (item >= j->count) return;
        j->fn(j->user, item, index);
    }
}

static void *worker_main(void *argument) {
    worker *w = argument;
    jobs *j = w->pool;
    unsigned seen = 0;
    pthread_mutex_lock(&j->mutex);
    for (;;) {
        while (!j->quit && j->generation == seen) pthread_cond_wait(&j->work, &j->mutex);
        if (j->quit) break;
        seen = j->generation;
        pthread_mutex_unlock(&j->mutex);
        work_on_items(j, w->index);
        pthread_mutex_lock(&j->mutex);
        if (--j->running == 0) pthread_cond_signal(&j->done);
    }
    pthread_mutex_unlock(&j->mutex);
    return NULL;
}

jobs *jobs_create_from(allocator *memory, unsigned threads) {
    jobs *j = block_zeroed(memory, 1, sizeof *j);
    if (!j) return NULL;
    j->memory = memory;
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    if (threads == 0) threads = online < 1 ? 1 : online > WORKERS_MAX ? WORKERS_MAX : (unsigned)online;
    if (threads > WORKERS_MAX) threads = WORKERS_MAX;
    pthread_mutex_init(&j->mutex, NULL);
    pthread_cond_init(&j->work, NULL);
    pthread_cond_init(&j->done, NULL);
    j->workers = block_zeroed(memory, threads, sizeof *j->workers);
    for (unsigned i = 0; j->workers && i < threads; i++) {
        j->workers[i] = (worker){ .pool = j, .index = i };
        if (pthread_create(&j->workers[i].thread, NULL, worker_main, &j->workers[i]) != 0) break;
        j->worker_count++;
    }
    if (j->worker_count > 0) return j;
    jobs_destroy(j);
    return NULL;
}

jobs *jobs_create(unsigned threads) {
    return jobs_create_from(NULL, threads);
}

void jobs_destroy(jobs *j) {
    if (!j) return;
    pthread_mutex_lock(&j->mutex);
    j->quit = true;
    pthread_cond_broadcast(&j->work);
    pthread_mutex_unlock(&j->mutex);
    for (unsigned i = 0; i < j->worker_count; i++) pthread_join(j->workers[i].thread, NULL);
    pthread_cond_destroy(&j->work);
    pthread_cond_destroy(&j->done);
    pthread_mutex_destroy(&j->mutex);
    block_free_all(j->workers, j);
}

unsigned jobs_worker_count(const jobs *j) {
    return j->worker_count;
}

allocator *jobs_memory(const jobs *j) {
    return j->memory;
}

void jobs_set_kept(jobs *j, kept_results *kept) {
    j->kept = kept;
}

void jobs_set_ranks(jobs *j, ranks *r) {
    j->ranks = r;
}

ranks *jobs_ranks(const jobs *j) {
    return j->ranks;
}

kept_pass jobs_begin_pass(jobs *j) {
    return kept_pass_begin(j ? j->kept : NULL, j ? j->memory : NULL);
}

static void wait_a_moment(pthread_cond_t *done, pthread_mutex_t *mutex) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += WAIT_MS * 1000000L;
    if (until.tv_nsec >= 1000000000L) until.tv_sec++, until.tv_nsec -= 1000000000L;
    pthread_cond_timedwait(done, mutex, &until);
}

static bool run(jobs *j, size_t count, bool each_worker, jobs_fn fn, jobs_wait_fn wait, void *user) {
    bool go_on = true;
    pthread_mutex_lock(&j->mutex);
    j->each_worker = each_worker;
    j->fn = fn;
    j->user = user;
    j->count = count;
    atomic_store(&j->next, 0);
    j->running = j->worker_count;
    j->generation++;
    pthread_cond_broadcast(&j->work);
    while (j->running > 0) {
        wait_a_moment(&j->done, &j->mutex);
        if (j->running == 0 || !wait || !go_on) continue;
        pthread_mutex_unlock(&j->mutex);
        go_on = wait(user);
        pthread_mutex_lock(&j->mutex);
        if (!go_on) atomic_store(&j->next, count);
    }
    pthread_mutex_unlock(&j->mutex);
    return go_on && (!wait || wait(user));
}

bool jobs_run(jobs *j, size_t count, jobs_fn fn, jobs_wait_fn wait, void *user) {
    if (j) return run(j, count, false, fn, wait, user);
    for (size_t i = 0; i < count; i++) fn(user, i, 0);
    return !wait || wait(user);
}

/* ---- work in order ---- */

typedef struct alone {
    void (*fn)(void *user);
    void *user;
    pthread_mutex_t mutex;
    pthread_cond_t done;
    bool is_done;
} alone;

static void *alone_main(void *argument) {
    alone *a = argument;
    a->fn(a->user);
    pthread_mutex_lock(&a->mutex);
    a->is_done = true;
    pthread_cond_signal(&a->done);
    pthread_mutex_unlock(&a->mutex);
    return NULL;
}

/* Without a thread more the caller does the work, and nobody watches. */
static bool run_here(void (*fn)(void *user), jobs_wait_fn wait, void *user) {
    fn(user);
    return !wait || wait(user);
}

bool jobs_run_alone(void (*fn)(void *user), jobs_wait_fn wait, void *user) {
    alone a = { .fn = fn, .user = user };
    pthread_t thread;
    bool go_on = true;
    pthread_mutex_init(&a.mutex, NULL);
    pthread_cond_init(&a.done, NULL);
    bool has_thread = pthread_create(&thread, NULL, alone_main, &a) == 0;
    pthread_mutex_lock(&a.mutex);
    while (has_thread && !a.is_done) {
        wait_a_moment(&a.done, &a.mutex);
        if (a.is_done || !wait || !go_on) continue;
        pthread_mutex_unlock(&a.mutex);
        go_on = wait(user);
        pthread_mutex_lock(&a.mutex);
    }
    pthread_mutex_unlock(&a.mutex);
    if (has_thread) pthread_join(thread, NULL);
    pthread_cond_destroy(&a.done);
    pthread_mutex_destroy(&a.mutex);
    if (!has_thread) return run_here(fn, wait, user);
    return go_on && (!wait || wait(user));
}

void jobs_run_on_each_worker(jobs *j, jobs_fn fn, void *user) {
    run(j, 0, true, fn, NULL, user);
}
