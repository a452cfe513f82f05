/* SPDX-License-Identifier: MIT
 * See column_store.h.
 */
#include "solver/column_store.h"

#include "base/block.h"
#include "geometry/vec3.h"
#include "solver/gather.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 32 };

typedef struct candidate {
    uint32_t shooter;
    double unshot, potential; /* W, m2 */
} candidate;

typedef struct batch {
    column_store *store;
    uint32_t shooters[BATCH];
    size_t count;
} batch;

bool column_store_open(column_store *s) {
    unsigned workers = jobs_worker_count(s->jobs);
    memset(&s->statistics, 0, sizeof s->statistics);
    s->workers = block_zeroed(jobs_memory(s->jobs), workers, sizeof *s->workers);
    s->messages = block_zeroed(jobs_memory(s->jobs), workers, sizeof *s->messages);
    return s->workers && s->messages;
}

/* GL contexts belong to the threads that made them, so each worker lets go of its own. */
static void close_worker(void *user, size_t item, unsigned worker) {
    column_store *s = user;
    (void)item;
    column_worker_destroy(s->workers[worker]);
    s->workers[worker] = NULL;
}

void column_store_close(column_store *s) {
    if (s->workers) jobs_run_on_each_worker(s->jobs, close_worker, s);
    block_free(s->workers);
    block_free(s->messages);
    s->workers = NULL;
    s->messages = NULL;
}

static void compute_item(void *user, size_t item, unsigned worker) {
    batch *b = user;
    column_store *s = b->store;
    shooter *one = &s->shooters->all[b->shooters[item]];
    if (!s->workers[worker])
        s->workers[worker] = column_worker_create(s->setup, s->messages[worker], sizeof *s->messages);
    if (s->workers[worker]) one->column = column_compute_subpatch(s->workers[worker], &one->piece);
    if (one->column && s->rows) row_closure_apply(s->rows, s->setup, one->piece.patch, one->column);
}

static bool wait(void *user) {
    batch *b = user;
    return !b->store->wait || b->store->wait(b->store->wait_user);
}

static int compare_candidates(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    if (x->unshot != y->unshot) return x->unshot < y->unshot ? 1 : -1;
    if (x->potential != y->potential) return x->potential < y->potential ? 1 : -1;
    return (x->shooter > y->shooter) - (x->shooter < y->shooter);
}

/* The shooters without a column that will want one soonest: those with the most unshot power, then those that can
 * reflect most. False when out of memory. */
static bool choose(column_store *s, size_t limit, batch *b) {
    candidate *all = block_new(jobs_memory(s->jobs), (s->shooters->count + 1) * sizeof *all);
    size_t count = 0;
    if (!all) return false;
    for (size_t i = 0; i < s->shooters->count; i++) {
        const shooter *one = &s->shooters->all[i];
        const double *rho = shooter_material(s->shooters, i)->rho;
        double unshot = shooter_unshot_power(one),
               potential = s->lit_only ? 0.0 : one->piece.area * fmax(rho[0], fmax(rho[1], rho[2]));
        if (one->column || !shooter_is_whole(one) || !shooter_leads(s->shooters, i) ||
            (unshot <= 0.0 && potential <= 0.0))
            continue;
        all[count++] = (candidate){ (uint32_t)i, unshot, potential };
    }
    qsort(all, count, sizeof *all, compare_candidates);
    b->count = count < limit ? count : limit;
    for (size_t i = 0; i < b->count; i++) b->shooters[i] = all[i].shooter;
    block_free(all);
    return true;
}

static void add_to_row_sums(const column_store *s, const column *c, bool emitter) {
    for (size_t i = 0; i < c->run_count; i++) {
        const patch *p = &s->setup->mesh->patches[c->runs[i].patch];
        for (uint32_t k = 0; k < p->sample_count; k++) {
            double F = c->factors[c->runs[i].first + k];
            s->row_sum[p->first_sample + k] += F;
            if (emitter) s->row_sum_emitters[p->first_sample + k] += F;
        }
    }
}

static void note(column_store *s, shooter *one) {
    const column *c = one->column;
    column_statistics *t = &s->statistics;
    const patch *p = &s->setup->mesh->patches[one->piece.patch];
    uint32_t member_count;
    s->bytes += column_bytes(c);
    if (one->was_computed) {
        t->recomputed++;
        return;
    }
    one->was_computed = true;
    const uint32_t *members = mesh_members(s->setup->mesh, &one->piece.patch, &member_count);
    for (uint32_t i = 0; i < member_count; i++) s->crossed[members[i]] |= c->crossed;
    one->choices = (shooter_choices){ c->hemicubes, c->analytic, c->evaluations, c->split };
    add_to_row_sums(s, c, material_emits(&p->material));
    t->hemicubes += c->hemicubes;
    t->analytic += c->analytic;
    t->evaluations += c->evaluations;
    t->split += c->split;
    t->clipped += c->scale < 1.0;
    if (c->closure.front <= 0.0) return;
    double closure = c->total / c->closure.front;
    t->closure_min = t->columns ? fmin(t->closure_min, closure) : closure;
    t->closure_max = t->columns ? fmax(t->closure_max, closure) : closure;
    t->closure_sum += closure;
    t->columns++;
}

/* Each member goes on with its own share of what has come to the cluster, which has not shot yet. */
static bool dissolve(column_store *s, uint32_t lead) {
    const mesh *m = s->setup->mesh;
    uint32_t count;
    const uint32_t *members = mesh_members(m, &lead, &count);
    size_t longest = 0;
    for (uint32_t i = 0; i < count; i++)
        if (m->patches[members[i]].sample_count > longest) longest = m->patches[members[i]].sample_count;
    double *E = block_new(jobs_memory(s->jobs), (3 * longest + 1) * sizeof *E);
    column_destroy(s->shooters->all[lead].column);
    s->shooters->all[lead].column = NULL;
    for (uint32_t i = 0; E && i < count; i++) {
        const patch *p = &m->patches[members[i]];
        shooter *one = &s->shooters->all[members[i]];
        double mean[3] = { 0, 0, 0 };
        gather_patch(s->shooters, members[i], s->delivered, E);
        for (uint32_t k = 0; k < p->sample_count; k++)
            vec3_add_scaled(mean, mean, m->sample_area[p->first_sample + k] / p->area, E + 3 * (size_t)k);
        one->piece = subpatch_of_single_patch(m, members[i]);
        for (int c = 0; c < 3; c++) one->unshot[c] = p->material.M[c] + p->material.rho[c] * mean[c];
    }
    if (E) mesh_dissolve(m, lead);
    block_free(E);
    return E;
}

const char *column_store_fetch(column_store *s, uint32_t wanted) {
    batch b = { .store = s };
    if (s->shooters->all[wanted].column) return NULL;
    if (!choose(s, column_store_is_full(s) ? 1 : BATCH, &b)) return "out of memory";
    bool listed = false;
    for (size_t i = 0; i < b.count; i++) listed = listed || b.shooters[i] == wanted;
    if (!listed) b.shooters[b.count < BATCH ? b.count++ : BATCH - 1] = wanted;
    double before = s->clock();
    bool all = jobs_run(s->jobs, b.count, compute_item, wait, &b);
    s->seconds += s->clock() - before;
    for (size_t i = 0; i < b.count; i++) {
        shooter *one = &s->shooters->all[b.shooters[i]];
        if (one->column && one->column->crowded) {
            if (!dissolve(s, b.shooters[i])) return "out of memory";
            continue;
        }
        if (one->column) {
            note(s, one);
            continue;
        }
        if (!all) continue;
        for (unsigned w = 0; w < jobs_worker_count(s->jobs); w++)
            if (s->messages[w][0]) return s->messages[w];
        return "out of memory while computing form factors";
    }
    return NULL;
}

void column_store_put(column_store *s, uint32_t index, column *c) {
    s->shooters->all[index].column = c;
    if (c) note(s, &s->shooters->all[index]);
}

bool column_store_is_full(const column_store *s) {
    return s->bytes > s->memory_limit;
}

void column_store_drop(column_store *s, uint32_t index) {
    shooter *one = &s->shooters->all[index];
    s->bytes -= column_bytes(one->column);
    column_destroy(one->column);
    one->column = NULL;
}
