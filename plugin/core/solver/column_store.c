/* SPDX-License-Identifier: MIT */
#include "solver/column_store.h"

#include "base/tolerance.h"
#include "formfactor/column_kept.h"
#include "formfactor/near_distance.h"
#include "solver/gather.h"
#include "solver/subdivision.h"

#include <stdlib.h>
#include <string.h>

typedef struct candidate {
    uint32_t shooter;
    double unshot, potential; /* W, m2 */
} candidate;

/* Columns that are being computed. */
typedef struct computation {
    column_store *store;
    column_batch *batch;
    jobs_wait_fn wait;
    void *wait_user;
} computation;

/* ---- workers ---- */

bool column_store_open(column_store *s) {
    unsigned workers = jobs_worker_count(s->jobs);
    s->setup.shoot = subdivision_shoot;
    s->kept = jobs_begin_pass(s->jobs);
    if (!(s->setup.near_diameters > 0.0)) s->setup.near_diameters = near_distance(TOLERANCE_POINT_FACTOR);
    memset(&s->statistics, 0, sizeof s->statistics);
    s->workers = block_zeroed(jobs_memory(s->jobs), workers, sizeof *s->workers);
    s->messages = block_zeroed(jobs_memory(s->jobs), workers, sizeof *s->messages);
    return s->workers && s->messages;
}

column_worker *column_store_worker(column_store *s, unsigned worker) {
    if (!s->workers[worker])
        s->workers[worker] = column_worker_create(&s->setup, s->messages[worker], sizeof *s->messages);
    return s->workers[worker];
}

/* GL contexts belong to the threads that made them, so each worker lets go of its own. */
static void close_worker(void *user, size_t item, unsigned worker) {
    column_store *s = user;
    (void)item;
    column_worker_destroy(s->workers[worker]);
    s->workers[worker] = NULL;
}

void column_store_rest(column_store *s) {
    if (s->workers) jobs_run_on_each_worker(s->jobs, close_worker, s);
}

void column_store_close(column_store *s) {
    block_free_all(s->workers, s->messages);
    s->workers = NULL;
    s->messages = NULL;
}

/* ---- batches ---- */

static void compute_item(void *user, size_t item, unsigned worker) {
    computation *c = user;
    column_store *s = c->store;
    const shooter *from = &s->shooters->all[c->batch->shooters[item]];
    if (from->column) return;
    column *made = column_kept_take(&s->kept, &s->setup, &from->subpatch);
    c->batch->again[item] = made;
    if (made) item_pool_count_as_used(s->setup.items.pool, s->setup.backend);
    column_worker *w = made ? NULL : column_store_worker(s, worker);
    if (!w) return;
    made = c->batch->again[item] = column_compute(w, &from->subpatch);
    if (made) column_kept_give(&s->kept, &from->subpatch, made);
}

static bool wait(void *user) {
    const computation *c = user;
    return !c->wait || c->wait(c->wait_user);
}

/* Fills again[] where shooters have no column; NULL where that fails. False when waiting was ended early. */
static bool compute(column_store *s, column_batch *b, jobs_wait_fn wait_fn, void *wait_user) {
    computation c = { s, b, wait_fn, wait_user };
    memset(b->again, 0, sizeof b->again);
    double before = s->clock();
    bool all = jobs_run(s->jobs, b->count, compute_item, wait, &c);
    s->seconds += s->clock() - before;
    return all;
}

bool column_store_hold(column_store *s, column_batch *b, jobs_wait_fn wait_fn, void *user) {
    bool all = true;
    memset(b->again, 0, sizeof b->again);
    for (size_t i = 0; i < b->count; i++) all = all && s->shooters->all[b->shooters[i]].column;
    if (!all) all = compute(s, b, wait_fn, user);
    for (size_t i = 0; i < b->count; i++) {
        b->columns[i] = b->again[i] ? b->again[i] : s->shooters->all[b->shooters[i]].column;
        all = all && b->columns[i];
    }
    return all;
}

void column_store_release(column_batch *b) {
    for (size_t i = 0; i < b->count; i++) column_destroy(b->again[i]);
    b->count = 0;
}

/* ---- columns that are kept ---- */

static int compare_candidates(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    if (x->unshot != y->unshot) return x->unshot < y->unshot ? 1 : -1;
    if (x->potential != y->potential) return x->potential < y->potential ? 1 : -1;
    return (x->shooter > y->shooter) - (x->shooter < y->shooter);
}

/* The shooters without a column that will want one soonest: those with the most unshot power, then those that can
 * reflect most. False when out of memory. */
static bool choose(column_store *s, size_t limit, column_batch *b) {
    candidate *all = block_new(jobs_memory(s->jobs), (s->shooters->count + 1) * sizeof *all);
    size_t count = 0;
    if (!all) return false;
    for (size_t i = 0; i < s->shooters->count; i++) {
        const shooter *one = &s->shooters->all[i];
        const double *rho = shooter_material(s->shooters, i)->rho;
        double unshot = shooter_unshot_power(one),
               potential = s->lit_only ? 0.0 : one->subpatch.area * fmax(rho[0], fmax(rho[1], rho[2]));
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

/* The averages of a column that is kept, where rows are closed. False when out of memory. */
static bool close_averages(const column_store *s, shooter *one) {
    const shooters *all = s->shooters;
    if (!all->rows.correction) return true;
    one->averages = row_closure_averages(&all->rows, all->mesh, shooter_emits(all, one), one->column);
    return one->averages;
}

static void add_to_row_sums(const column_store *s, const column *c, bool emitter) {
    for (size_t i = 0; i < c->run_count; i++) {
        const patch *p = &s->setup.mesh->patches[c->runs[i].patch];
        for (uint32_t k = 0; k < p->sample_count; k++) {
            double F = c->factors[c->runs[i].first + k];
            s->row_sum[p->first_sample + k] += F;
            if (emitter) s->row_sum_emitters[p->first_sample + k] += F;
        }
    }
}

void column_store_count(column_store *s, uint32_t index) {
    shooter *one = &s->shooters->all[index];
    const column *c = one->column;
    column_statistics *t = &s->statistics;
    uint32_t member_count;
    if (one->is_counted) return;
    const uint32_t *members = mesh_members(s->setup.mesh, &one->subpatch.patch, &member_count);
    one->is_counted = true;
    for (uint32_t i = 0; i < member_count; i++) s->crossed[members[i]] |= c->crossed;
    one->choices = (shooter_choices){ c->hemicubes, c->analytic, c->evaluations, c->split };
    add_to_row_sums(s, c, shooter_emits(s->shooters, one));
    t->hemicubes += c->hemicubes;
    t->analytic += c->analytic;
    t->evaluations += c->evaluations;
    t->split += c->split;
    t->clipped += c->scale < 1.0;
    if (c->closure.front <= 0.0 || c->tints) return; /* a hemi-cube does not know panes */
    double closure = c->total / c->closure.front;
    t->closure_min = t->columns ? fmin(t->closure_min, closure) : closure;
    t->closure_max = t->columns ? fmax(t->closure_max, closure) : closure;
    t->closure_sum += closure;
    t->columns++;
}

/* False when out of memory. */
static bool keep(column_store *s, shooter *one) {
    s->bytes += column_bytes(one->column);
    return close_averages(s, one);
}

/* Each member goes on with its own share of what has come to the cluster, which has not shot yet. */
static bool dissolve(column_store *s, uint32_t lead) {
    const mesh *m = s->setup.mesh;
    uint32_t count;
    const uint32_t *members = mesh_members(m, &lead, &count);
    size_t longest = 0;
    for (uint32_t i = 0; i < count; i++)
        if (m->patches[members[i]].sample_count > longest) longest = m->patches[members[i]].sample_count;
    double *E = block_new(jobs_memory(s->jobs), (3 * longest + 1) * sizeof *E);
    shooter_drop_column(&s->shooters->all[lead]);
    for (uint32_t i = 0; E && i < count; i++) {
        const patch *p = &m->patches[members[i]];
        shooter *one = &s->shooters->all[members[i]];
        double mean[3] = { 0, 0, 0 };
        gather_patch(s->shooters, members[i], s->delivered, E);
        for (uint32_t k = 0; k < p->sample_count; k++)
            vec3_add_scaled(mean, mean, m->sample_area[p->first_sample + k] / p->area, E + 3 * (size_t)k);
        one->subpatch = subpatch_of_single_patch(s->setup.scene, m, members[i]);
        for (int c = 0; c < 3; c++) one->unshot[c] = p->material.M[c] + p->material.rho[c] * mean[c];
    }
    if (E) mesh_dissolve(m, lead);
    block_free(E);
    return E;
}

/* Why a worker failed. */
static const char *failure_of(const column_store *s) {
    for (unsigned w = 0; w < jobs_worker_count(s->jobs); w++)
        if (s->messages[w][0]) return s->messages[w];
    return "out of memory while computing form factors";
}

const char *column_store_fetch(column_store *s, uint32_t wanted) {
    column_batch b;
    if (s->shooters->all[wanted].column) return NULL;
    if (!choose(s, column_store_is_full(s) ? 1 : COLUMN_BATCH, &b)) return "out of memory";
    bool listed = false;
    for (size_t i = 0; i < b.count; i++) listed = listed || b.shooters[i] == wanted;
    if (!listed) b.shooters[b.count < COLUMN_BATCH ? b.count++ : COLUMN_BATCH - 1] = wanted;
    bool all = compute(s, &b, s->wait, s->wait_user), missing = false, ok = true;
    for (size_t i = 0; i < b.count; i++) s->shooters->all[b.shooters[i]].column = b.again[i];
    for (size_t i = 0; ok && i < b.count; i++) {
        if (b.again[i])
            ok = b.again[i]->crowded ? dissolve(s, b.shooters[i]) : keep(s, &s->shooters->all[b.shooters[i]]);
        else
            missing = missing || all;
    }
    return !ok ? "out of memory" : missing ? failure_of(s) : NULL;
}

bool column_store_put(column_store *s, uint32_t index, column *c) {
    s->shooters->all[index].column = c;
    if (c) column_store_count(s, index);
    return !c || keep(s, &s->shooters->all[index]);
}

bool column_store_is_full(const column_store *s) {
    return s->bytes > s->memory_limit;
}

void column_store_drop(column_store *s, uint32_t index) {
    shooter *one = &s->shooters->all[index];
    s->bytes -= column_bytes(one->column);
    shooter_drop_column(one);
}

static void close_item(void *user, size_t item, unsigned worker) {
    const column_store *s = user;
    (void)worker;
    if (s->shooters->all[item].column) close_averages(s, &s->shooters->all[item]);
}

bool column_store_close_rows(column_store *s) {
    shooters *all = s->shooters;
    bool ok = row_closure_find(all->mesh, s->row_sum, s->row_sum_emitters, &all->rows);
    if (ok) jobs_run(s->jobs, all->count, close_item, NULL, s);
    for (size_t i = 0; ok && i < all->count; i++) ok = !all->all[i].column || all->all[i].averages;
    return ok;
}
