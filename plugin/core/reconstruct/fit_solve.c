/* SPDX-License-Identifier: MIT
 * See fit_solve.h.
 */
#include "reconstruct/fit_solve.h"

#include <string.h>

/* Of the first residual. Errors of rooms and an apartment differ from those at 1e-7 by 2e-5, for half the iterations.
 */
static const double RESIDUAL_TARGET = 1e-5;
enum { ITERATIONS_MAX = 400, NODES_A_JOB = 4096 };

typedef struct solving {
    fit_matrix *a;
    jobs *jobs;
    double alpha[3], beta[3]; /* how far along the direction, and how much of it stays */
} solving;

/* ---- the matrix ---- */

static bool reserve(allocator *memory, size_t count, size_t entries, fit_matrix *a) {
    size_t shares = (count + NODES_A_JOB - 1) / NODES_A_JOB, three = 3 * count * sizeof *a->r;
    return block_reserve(memory, (void **)&a->first, &a->nodes_room, count, sizeof *a->first) &&
           block_reserve(memory, (void **)&a->length, &a->length_room, count, sizeof *a->length) &&
           block_reserve(memory, (void **)&a->column, &a->entries_room, entries, sizeof *a->column) &&
           block_reserve(memory, (void **)&a->value, &a->values_room, entries, sizeof *a->value) &&
           block_reserve(memory, (void **)&a->r, &a->r_room, three, 1) &&
           block_reserve(memory, (void **)&a->x, &a->x_room, three, 1) &&
           block_reserve(memory, (void **)&a->p, &a->p_room, three, 1) &&
           block_reserve(memory, (void **)&a->q, &a->q_room, three, 1) &&
           block_reserve(memory, (void **)&a->sums, &a->sums_room, 3 * shares, sizeof *a->sums);
}

bool fit_matrix_begin(allocator *memory, size_t count, const uint32_t *room, fit_matrix *a) {
    size_t entries = 0;
    for (size_t v = 0; v < count; v++) entries += room[v];
    if (!reserve(memory, count, entries, a)) return false;
    a->count = count;
    entries = 0;
    for (size_t v = 0; v < count; v++) {
        a->first[v] = entries, a->length[v] = 1;
        a->column[entries] = (uint32_t)v, a->value[entries] = 0.0;
        entries += room[v];
    }
    for (double *const *of = (double *const[]){ a->r, a->x, a->p, a->q, NULL }; *of; of++)
        memset(*of, 0, 3 * count * sizeof **of);
    return true;
}

void fit_matrix_free(fit_matrix *a) {
    block_free_all(a->first, a->length, a->column, a->value, a->r, a->x, a->p, a->q, a->sums);
    *a = (fit_matrix){ 0 };
}

void fit_matrix_add(fit_matrix *a, uint32_t row, uint32_t column, double value) {
    uint32_t *columns = a->column + a->first[row], i = 0;
    while (i < a->length[row] && columns[i] != column) i++;
    if (i == a->length[row]) {
        a->length[row]++;
        columns[i] = column;
        a->value[a->first[row] + i] = 0.0;
    }
    a->value[a->first[row] + i] += value;
}

/* ---- a job's share ---- */

static size_t end_of(const solving *s, size_t job) {
    size_t end = (job + 1) * NODES_A_JOB;
    return end < s->a->count ? end : s->a->count;
}

static double inverse_of(const fit_matrix *a, size_t v) {
    double diagonal = a->value[a->first[v]];
    return diagonal > 0.0 ? 1.0 / diagonal : 0.0;
}

/* p = r / diagonal + beta p */
static void direct_job(void *user, size_t job, unsigned worker) {
    solving *s = user;
    (void)worker;
    for (size_t v = job * NODES_A_JOB; v < end_of(s, job); v++) {
        const double inverse = inverse_of(s->a, v);
        for (size_t c = 0; c < 3; c++)
            s->a->p[3 * v + c] = s->a->r[3 * v + c] * inverse + s->beta[c] * s->a->p[3 * v + c];
    }
}

/* q = matrix p; sums: p q */
static void multiply_job(void *user, size_t job, unsigned worker) {
    const solving *s = user;
    const fit_matrix *a = s->a;
    double sum[3] = { 0, 0, 0 };
    (void)worker;
    for (size_t v = job * NODES_A_JOB; v < end_of(s, job); v++) {
        double q[3] = { 0, 0, 0 };
        for (size_t i = a->first[v]; i < a->first[v] + a->length[v]; i++) {
            const double *p = s->a->p + 3 * (size_t)a->column[i];
            for (int c = 0; c < 3; c++) q[c] += a->value[i] * p[c];
        }
        for (size_t c = 0; c < 3; c++) {
            s->a->q[3 * v + c] = q[c];
            sum[c] += s->a->p[3 * v + c] * q[c];
        }
    }
    memcpy(s->a->sums + 3 * job, sum, sizeof sum);
}

/* x and r after a step of alpha; sums: r r / diagonal */
static void step_job(void *user, size_t job, unsigned worker) {
    const solving *s = user;
    fit_matrix *a = s->a;
    double sum[3] = { 0, 0, 0 };
    (void)worker;
    for (size_t v = job * NODES_A_JOB; v < end_of(s, job); v++) {
        const double inverse = inverse_of(a, v);
        for (size_t c = 0; c < 3; c++) {
            a->x[3 * v + c] += s->alpha[c] * s->a->p[3 * v + c];
            double r = a->r[3 * v + c] -= s->alpha[c] * s->a->q[3 * v + c];
            sum[c] += r * r * inverse;
        }
    }
    memcpy(s->a->sums + 3 * job, sum, sizeof sum);
}

/* ---- all of it ---- */

/* Runs one of these over all nodes, and adds up its sums. */
static void run(solving *s, jobs_fn fn, double out[3]) {
    size_t count = (s->a->count + NODES_A_JOB - 1) / NODES_A_JOB;
    jobs_run(s->jobs, count, fn, NULL, s);
    out[0] = out[1] = out[2] = 0.0;
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) out[c] += s->a->sums[3 * i + c];
}

int fit_solve(fit_matrix *a, jobs *j, const watcher *watch) {
    solving s = { .a = a, .jobs = j };
    double rz[3], first[3], pq[3], next[3];
    run(&s, step_job, first); /* of no length */
    memcpy(rz, first, sizeof rz);
    for (int i = 1;; i++) {
        bool done = true;
        run(&s, direct_job, next);
        run(&s, multiply_job, pq);
        for (int c = 0; c < 3; c++) s.alpha[c] = pq[c] > 0.0 ? rz[c] / pq[c] : 0.0;
        run(&s, step_job, next);
        for (int c = 0; c < 3; c++) {
            s.beta[c] = rz[c] > 0.0 ? next[c] / rz[c] : 0.0;
            rz[c] = next[c];
            done = done && next[c] <= RESIDUAL_TARGET * RESIDUAL_TARGET * first[c];
        }
        if (done || i == ITERATIONS_MAX || (watch && watcher_over(watch))) return i;
    }
}
