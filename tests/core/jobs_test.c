/* SPDX-License-Identifier: MIT
 * Is every item done once, does a run stop when it is told to, does every worker come when all are called, and may work
 * in order ask for jobs?
 */
#include "base/jobs.h"
#include "check.h"

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

enum { ITEMS = 10000, THREADS = 4 };

typedef struct tally {
    atomic_int done[ITEMS];
    pthread_t thread[THREADS];
    atomic_int visits[THREADS];
    atomic_int strangers; /* calls from a worker or a thread that should not be */
    atomic_int begun, waits;
    pthread_t caller;
} tally;

static void pause_ms(long ms) {
    nanosleep(&(struct timespec){ .tv_nsec = ms * 1000000L }, NULL);
}

static void count_item(void *user, size_t item, unsigned worker) {
    tally *t = user;
    if (item >= ITEMS || worker >= THREADS) {
        atomic_fetch_add(&t->strangers, 1);
        return;
    }
    atomic_fetch_add(&t->done[item], 1);
}

static void every_item_is_done_once(void) {
    static tally t;
    for (unsigned threads = 1; threads <= THREADS; threads++) {
        jobs *j = jobs_create(threads);
        CHECK(j != NULL);
        if (!j) return;
        CHECK_EQUAL(jobs_worker_count(j), threads);
        memset(&t, 0, sizeof t);
        CHECK(jobs_run(j, ITEMS, count_item, NULL, &t));
        int wrong = 0;
        for (int i = 0; i < ITEMS; i++) wrong += t.done[i] != 1;
        CHECK_EQUAL(wrong, 0);
        CHECK_EQUAL(t.strangers, 0);
        jobs_destroy(j);
    }
}

static void a_pool_runs_again_and_again(void) {
    static tally t;
    jobs *j = jobs_create(3);
    memset(&t, 0, sizeof t);
    for (int round = 0; j && round < 300; round++) jobs_run(j, 7, count_item, NULL, &t);
    for (int i = 0; i < 7; i++) CHECK_EQUAL(t.done[i], 300);
    CHECK_EQUAL(t.done[7], 0);
    jobs_destroy(j);
}

static void a_run_of_nothing_ends(void) {
    static tally t;
    jobs *j = jobs_create(2);
    memset(&t, 0, sizeof t);
    CHECK(j && jobs_run(j, 0, count_item, NULL, &t));
    CHECK_EQUAL(t.done[0], 0);
    jobs_destroy(j);
    jobs_destroy(NULL);
}

static void no_count_asks_for_one_thread_a_core(void) {
    jobs *j = jobs_create(0);
    CHECK(j && jobs_worker_count(j) >= 1);
    jobs_destroy(j);
}

/* ---- the same worker is always the same thread ---- */

static void meet(void *user, size_t item, unsigned worker) {
    tally *t = user;
    if (worker >= THREADS || item != worker) {
        atomic_fetch_add(&t->strangers, 1);
        return;
    }
    if (atomic_fetch_add(&t->visits[worker], 1) == 0)
        t->thread[worker] = pthread_self();
    else if (!pthread_equal(t->thread[worker], pthread_self()))
        atomic_fetch_add(&t->strangers, 1);
}

static void every_worker_comes_once_when_all_are_called(void) {
    static tally t;
    jobs *j = jobs_create(THREADS);
    if (!j) return;
    memset(&t, 0, sizeof t);
    for (int round = 1; round <= 50; round++) {
        jobs_run_on_each_worker(j, meet, &t);
        for (int w = 0; w < THREADS; w++) CHECK_EQUAL(t.visits[w], round);
        /* Items between must not shift who is who. */
        jobs_run(j, 5, count_item, NULL, &t);
    }
    CHECK_EQUAL(t.strangers, 0);
    for (int w = 1; w < THREADS; w++) CHECK(!pthread_equal(t.thread[w], t.thread[0]));
    jobs_destroy(j);
}

/* ---- waiting and cancelling ---- */

static void work_slowly(void *user, size_t item, unsigned worker) {
    tally *t = user;
    (void)item, (void)worker;
    atomic_fetch_add(&t->begun, 1);
    pause_ms(5);
}

static bool wait_on_caller(void *user) {
    tally *t = user;
    atomic_fetch_add(&t->waits, 1);
    if (!pthread_equal(t->caller, pthread_self())) atomic_fetch_add(&t->strangers, 1);
    return true;
}

static bool refuse(void *user) {
    atomic_fetch_add(&((tally *)user)->waits, 1);
    return false;
}

static void the_caller_hears_of_progress_on_its_own_thread(void) {
    static tally t;
    jobs *j = jobs_create(2);
    if (!j) return;
    memset(&t, 0, sizeof t);
    t.caller = pthread_self();
    CHECK(jobs_run(j, 100, work_slowly, wait_on_caller, &t));
    CHECK_EQUAL(t.begun, 100);
    /* 100 items of 5 ms on two threads take 250 ms at least: the callback comes once at the end, and before that. */
    CHECK(t.waits >= 2);
    CHECK_EQUAL(t.strangers, 0);
    memset(&t, 0, sizeof t);
    t.caller = pthread_self();
    CHECK(jobs_run(j, 0, work_slowly, wait_on_caller, &t));
    CHECK(t.waits >= 1);
    jobs_destroy(j);
}

static void a_cancelled_run_drops_what_was_not_begun(void) {
    static tally t;
    jobs *j = jobs_create(2);
    if (!j) return;
    memset(&t, 0, sizeof t);
    CHECK(!jobs_run(j, 2000, work_slowly, refuse, &t));
    CHECK(t.begun < 2000);
    CHECK_EQUAL(t.waits, 1);
    /* And the pool is as good as new. */
    memset(&t, 0, sizeof t);
    CHECK(jobs_run(j, 50, count_item, NULL, &t));
    for (int i = 0; i < 50; i++) CHECK_EQUAL(t.done[i], 1);
    jobs_destroy(j);
}

/* ---- work in order ---- */

typedef struct ordered {
    tally *tally;
    jobs *pool;
    bool done;
} ordered;

static void run_parts(void *user) {
    ordered *o = user;
    for (int round = 0; round < 3; round++) o->done = jobs_run(o->pool, ITEMS, count_item, NULL, o->tally);
    pause_ms(120);
    if (pthread_equal(o->tally->caller, pthread_self())) atomic_fetch_add(&o->tally->strangers, 1);
}

static bool watch_ordered(void *user) {
    return wait_on_caller(((ordered *)user)->tally);
}

static void work_in_order_may_ask_for_jobs_while_the_caller_watches(void) {
    static tally t;
    ordered o = { &t, jobs_create(2), false };
    if (!o.pool) return;
    memset(&t, 0, sizeof t);
    t.caller = pthread_self();
    CHECK(jobs_run_alone(run_parts, watch_ordered, &o));
    CHECK(o.done);
    int wrong = 0;
    for (int i = 0; i < ITEMS; i++) wrong += t.done[i] != 3;
    CHECK_EQUAL(wrong, 0);
    CHECK(t.waits >= 1);
    CHECK_EQUAL(t.strangers, 0);
    jobs_destroy(o.pool);
}

static void without_jobs_the_caller_does_every_item(void) {
    static tally t;
    memset(&t, 0, sizeof t);
    CHECK(jobs_run(NULL, ITEMS, count_item, NULL, &t));
    int wrong = 0;
    for (int i = 0; i < ITEMS; i++) wrong += t.done[i] != 1;
    CHECK_EQUAL(wrong, 0);
    CHECK_EQUAL(t.strangers, 0);
}

int main(void) {
    RUN(every_item_is_done_once);
    RUN(a_pool_runs_again_and_again);
    RUN(a_run_of_nothing_ends);
    RUN(no_count_asks_for_one_thread_a_core);
    RUN(every_worker_comes_once_when_all_are_called);
    RUN(the_caller_hears_of_progress_on_its_own_thread);
    RUN(a_cancelled_run_drops_what_was_not_begun);
    RUN(work_in_order_may_ask_for_jobs_while_the_caller_watches);
    RUN(without_jobs_the_caller_does_every_item);
    return check_end();
}
