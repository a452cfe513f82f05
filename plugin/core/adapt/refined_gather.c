/* SPDX-License-Identifier: MIT
 * See refined_gather.h. Shooters are taken in batches: each worker decides for one shooter at a time what it gives
 * finely and computes that; then the sums of all coarse elements grow by the batch, in shooter order, so that they have
 * the same bits for any number of threads.
 */
#include "adapt/refined_gather.h"

#include "geometry/vec3.h"

#include <stdio.h>
#include <string.h>

enum { ELEMENTS_A_JOB = 64 };

/* Linear interpolation over an edge h of what falls with the square of the distance r is off by about this, times
 * (h / r)^2. */
static const double CURVATURE = 0.4;

/* Edges of a coarse element: nearer than this to a shooter's nearest element what its slope gives is not linear over
 * it. */
static const double NEAREST = 1.0;

/* A corner of the coarse mesh, as a shooter sees the samples around it. */
enum { SEEN = 1, HIDDEN = 2 };

/* What samples have received: from emitters and others, and their form factors. */
typedef struct sums {
    double emitters[3], others[3], row_sum_emitters, row_sum;
} sums;

/* What one shooter of a batch gives. */
typedef struct contribution {
    const shooter *from;
    const column *column;
    uint32_t *first; /* first[i]: the factors of element i in factors, NO_INDEX where the coarse ones do */
    float *factors;
    double *gradient; /* gradient[3*k+c]: light of the k-th of all factors by the slope of the shooter; NULL: none */
    bool failed;
} contribution;

typedef struct gather_worker {
    uint8_t *corners; /* of the coarse mesh */
    column_receiver *receivers;
    uint32_t *chosen; /* chosen[i]: the element of receivers[i] */
} gather_worker;

typedef struct gathering {
    const refined_gather_setup *setup;
    refined_gather_result *out;
    refined_elements elements;
    sums *coarse; /* coarse[4*t+k]: of sample k of refined element t */
    sums *fine;
    gather_worker *workers;
    column_batch batch;
    contribution contributions[COLUMN_BATCH]; /* of its shooters */
} gathering;

static const mesh *coarse_mesh(const gathering *l) {
    return l->setup->store->setup.mesh;
}

/* ---- what is received finely ---- */

static void classify_patch(const mesh *m, const patch *p, const float *factors, uint8_t *corners) {
    for (uint32_t i = p->first_element; i < p->first_element + p->element_count; i++) {
        const element *e = &m->elements[i];
        uint8_t seen = 0;
        for (int k = 0; k < element_corner_count(e); k++)
            seen |= factors && factors[e->first_sample - p->first_sample + (uint32_t)k] > 0.0f ? SEEN : HIDDEN;
        for (int k = 0; k < element_corner_count(e); k++) corners[e->corner[k]] |= seen;
    }
}

static void classify_corners(const gathering *l, const column *c, uint8_t *corners) {
    const mesh *m = coarse_mesh(l);
    size_t next = 0;
    memset(corners, 0, m->vertex_count);
    for (uint32_t p = 0; p < m->patch_count; p++) {
        bool reached = next < c->run_count && c->runs[next].patch == p;
        classify_patch(m, &m->patches[p], reached ? c->factors + c->runs[next].first : NULL, corners);
        next += reached;
    }
}

/* Would the element be off by more than the tolerance, if it took what its coarse samples got? */
static bool needs_fine(const gathering *l, const contribution *g, const refined_element *t, const uint8_t *corners) {
    const mesh *m = coarse_mesh(l);
    const element *e = &m->elements[t->coarse];
    const subpatch *from = &g->from->subpatch;
    uint8_t seen = 0;
    double B = 0.0;
    for (int k = 0; k < element_corner_count(e); k++) seen |= corners[e->corner[k]];
    for (int c = 0; c < 3; c++) B += fabs(g->from->shot_in_all[c]);
    if (B <= 0.0) return false;
    if (l->setup->emitters_are_fine && material_emits(&m->patches[from->patch].material)) return true;
    if (!(seen & SEEN)) return false;
    if (seen == (SEEN | HIDDEN) && t->in_contact) return true;
    if (l->setup->gradient && shooter_gradient_reaches(l->setup->gradient, &g->from->subpatch, &t->receiver))
        return true;
    const double *at = m->vertices + 3 * (size_t)e->corner[0];
    double r = fmax(vec3_distance(at, from->center) - 0.5 * from->diameter, 0.0) + 1e-9 * from->diameter;
    double fault = B * fmin(from->area / (PI * r * r), 1.0), ratio = t->size / r;
    if (seen == SEEN) fault *= fmin(CURVATURE * ratio * ratio, 1.0);
    return fault > l->setup->tolerance * t->irradiance;
}

static size_t choose_elements(const gathering *l, gather_worker *w, contribution *g) {
    size_t count = 0, samples = 0;
    classify_corners(l, g->column, w->corners);
    for (size_t t = 0; t < l->elements.count; t++) {
        g->first[t] = NO_INDEX;
        if (!needs_fine(l, g, &l->elements.all[t], w->corners)) continue;
        g->first[t] = (uint32_t)samples;
        w->chosen[count] = (uint32_t)t;
        w->receivers[count++] = l->elements.all[t].receiver;
        samples += l->elements.all[t].sample_count;
    }
    g->factors = block_new(coarse_mesh(l)->memory, (samples + 1) * sizeof *g->factors);
    return count;
}

static bool open_worker(const gathering *l, gather_worker *w) {
    if (w->corners && w->receivers && w->chosen) return true;
    w->corners = block_new(coarse_mesh(l)->memory, coarse_mesh(l)->vertex_count + 1);
    w->receivers = block_new(coarse_mesh(l)->memory, (l->elements.count + 1) * sizeof *w->receivers);
    w->chosen = block_new(coarse_mesh(l)->memory, (l->elements.count + 1) * sizeof *w->chosen);
    return w->corners && w->receivers && w->chosen;
}

/* How much brighter than its mean a shooter looks changes over lengths of the distance to it, so what the coarse
 * samples see does for the fine ones. False where that is too near, or some see none of it. */
static bool add_gradient_linearly(const gathering *l, const refined_element *t, const contribution *g,
                                  const float *factors, double *E) {
    const element *e = &coarse_mesh(l)->elements[t->coarse];
    const subpatch *from = &g->from->subpatch;
    uint32_t corners = (uint32_t)element_corner_count(e), sample = 0;
    double scratch[8], excess[12];
    column_receiver coarse = t->receiver;
    coarse.first_sample = e->first_sample, coarse.sample_count = corners;
    if (shooter_gradient_gap(l->setup->gradient, from, &coarse) < NEAREST * t->size ||
        !shooter_gradient_excess(l->setup->gradient, g->column, from, coarse_mesh(l), &coarse, scratch, excess))
        return false;
    for (size_t i = t->first_fine; sample < t->sample_count; i++)
        for (uint32_t k = 0; k < corners; k++, sample++) {
            double w[4];
            fine_place_weights(&l->setup->places[i], (int)corners, (int)k, w);
            for (size_t j = 0; j < 3 * (size_t)corners; j++)
                E[3 * sample + j % 3] += factors[sample] * w[j / 3] * excess[j];
        }
    return true;
}

/* What the slope of the shooter gives to what is received finely. */
static bool add_gradient(const gathering *l, const gather_worker *w, size_t count, contribution *g) {
    const shooter_gradient *gradient = l->setup->gradient;
    const subpatch *from = &g->from->subpatch;
    size_t samples = 0, longest = 0, next = 0;
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        any = any || shooter_gradient_reaches(gradient, from, &w->receivers[i]);
        samples += w->receivers[i].sample_count;
        if (w->receivers[i].sample_count > longest) longest = w->receivers[i].sample_count;
    }
    if (!any) return true;
    double *scratch = block_new(coarse_mesh(l)->memory, (SHOOTER_GRADIENT_SCRATCH * longest + 1) * sizeof *scratch);
    g->gradient = block_zeroed(coarse_mesh(l)->memory, 3 * samples + 1, sizeof *g->gradient);
    for (size_t i = 0; scratch && g->gradient && i < count; next += w->receivers[i++].sample_count)
        if (shooter_gradient_reaches(gradient, from, &w->receivers[i]) &&
            !add_gradient_linearly(l, &l->elements.all[w->chosen[i]], g, g->factors + next, g->gradient + 3 * next))
            shooter_gradient_add(gradient, g->column, from, l->setup->fine, &w->receivers[i], g->factors + next,
                                 scratch, g->gradient + 3 * next);
    block_free(scratch);
    return scratch && g->gradient;
}

static void compute_contribution(void *user, size_t item, unsigned worker) {
    gathering *l = user;
    contribution *g = &l->contributions[item];
    gather_worker *w = &l->workers[worker];
    column_worker *columns = column_store_worker(l->setup->store, worker);
    *g = (contribution){ .from = &l->setup->store->shooters->all[l->batch.shooters[item]],
                         .column = l->batch.columns[item],
                         .failed = true };
    g->first = block_new(coarse_mesh(l)->memory, (l->elements.count + 1) * sizeof *g->first);
    if (!columns || !open_worker(l, w) || !g->first) return;
    size_t count = choose_elements(l, w, g);
    if (!g->factors) return;
    g->failed = count > 0 && !column_receive(columns, g->column, &g->from->subpatch, l->setup->fine, w->receivers,
                                             count, g->factors);
    if (!g->failed && count > 0 && l->setup->gradient) g->failed = !add_gradient(l, w, count, g);
}

/* ---- sums ---- */

static void add(sums *s, double F, const double B[3], bool emitter) {
    double *E = emitter ? s->emitters : s->others;
    for (int c = 0; c < 3; c++) E[c] += F * B[c];
    s->row_sum += F;
    if (emitter) s->row_sum_emitters += F;
}

static void add_contribution(gathering *l, const contribution *g, size_t t) {
    const mesh *m = coarse_mesh(l);
    const refined_element *to = &l->elements.all[t];
    const row_closure *rows = &l->setup->store->shooters->rows;
    const element *e = &m->elements[to->coarse];
    bool emitter = material_emits(&m->patches[g->from->subpatch.patch].material);
    if (g->first[t] != NO_INDEX) {
        for (uint32_t k = 0; k < to->sample_count; k++) {
            sums *s = &l->fine[to->first_sample + k];
            add(s, g->factors[g->first[t] + k], g->from->shot_in_all, emitter);
            for (size_t c = 0; g->gradient && c < 3; c++)
                s->others[c] += g->gradient[3 * ((size_t)g->first[t] + k) + c];
        }
        return;
    }
    const column_run *run = column_run_of_patch(g->column, e->patch);
    if (!run) return;
    const float *factors = g->column->factors + run->first;
    for (uint32_t k = 0; k < (uint32_t)element_corner_count(e); k++) {
        uint32_t sample = e->first_sample + k;
        double F = factors[sample - m->patches[e->patch].first_sample];
        if (rows->correction)
            F = row_closure_close(rows, sample, emitter, (float)F) /
                row_closure_factor(rows->correction[sample], emitter);
        add(&l->coarse[4 * t + k], F, g->from->shot_in_all, emitter);
    }
}

static void add_batch(void *user, size_t item, unsigned worker) {
    gathering *l = user;
    size_t end = (item + 1) * ELEMENTS_A_JOB < l->elements.count ? (item + 1) * ELEMENTS_A_JOB : l->elements.count;
    (void)worker;
    for (size_t t = item * ELEMENTS_A_JOB; t < end; t++)
        for (size_t i = 0; i < l->batch.count; i++) add_contribution(l, &l->contributions[i], t);
}

static void add_interpolated(const sums *coarse, const double w[4], sums *s) {
    sums interpolated = { 0 };
    for (int i = 0; i < 4 && w; i++) {
        for (int c = 0; c < 3; c++) {
            interpolated.emitters[c] += w[i] * coarse[i].emitters[c];
            interpolated.others[c] += w[i] * coarse[i].others[c];
        }
        interpolated.row_sum_emitters += w[i] * coarse[i].row_sum_emitters;
        interpolated.row_sum += w[i] * coarse[i].row_sum;
    }
    for (int c = 0; c < 3; c++) {
        s->emitters[c] += fmax(interpolated.emitters[c], 0.0);
        s->others[c] += fmax(interpolated.others[c], 0.0);
    }
    s->row_sum_emitters += fmax(interpolated.row_sum_emitters, 0.0);
    s->row_sum += fmax(interpolated.row_sum, 0.0);
}

static void finish_sample(const gathering *l, const sums *s, size_t sample) {
    double emitters = 1.0, others = 1.0;
    if (l->setup->store->shooters->rows.correction) {
        double correction = row_closure_correction(s->row_sum, s->row_sum_emitters);
        emitters = row_closure_factor(correction, true), others = row_closure_factor(correction, false);
    }
    for (int c = 0; c < 3; c++)
        l->out->irradiance[3 * sample + (size_t)c] = fmax(emitters * s->emitters[c] + others * s->others[c], 0.0);
    l->out->row_sum[sample] = s->row_sum;
}

static void finish_element(gathering *l, size_t t, size_t index) {
    const element *e = &l->setup->fine->elements[index];
    int corners = element_corner_count(e);
    for (int k = 0; k < corners; k++) {
        double w[4];
        sums *s = &l->fine[e->first_sample + (uint32_t)k];
        fine_place_weights(&l->setup->places[index], corners, k, w);
        add_interpolated(&l->coarse[4 * t], w, s);
        finish_sample(l, s, e->first_sample + (size_t)k);
    }
}

static bool wait(void *user) {
    gathering *l = user;
    if (l->setup->wait && !l->setup->wait(l->setup->wait_user)) l->out->cancelled = true;
    return !l->out->cancelled;
}

static const char *gather_batch(gathering *l) {
    size_t jobs_count = (l->elements.count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
    jobs *j = l->setup->store->jobs;
    bool failed = false;
    memset(l->contributions, 0, sizeof l->contributions);
    if (!column_store_hold(l->setup->store, &l->batch, wait, l)) failed = true;
    if (!failed && !jobs_run(j, l->batch.count, compute_contribution, wait, l)) l->out->cancelled = true;
    for (size_t i = 0; i < l->batch.count; i++) failed = failed || l->contributions[i].failed;
    if (!failed && !l->out->cancelled) {
        jobs_run(j, jobs_count, add_batch, NULL, l);
        for (size_t i = 0; i < l->batch.count; i++)
            for (size_t t = 0; t < l->elements.count; t++) l->out->fine += l->contributions[i].first[t] != NO_INDEX;
        l->out->pairs += l->batch.count * l->elements.count;
    }
    for (size_t i = 0; i < l->batch.count; i++) {
        block_free_all(l->contributions[i].first, l->contributions[i].factors, l->contributions[i].gradient);
    }
    column_store_release(&l->batch);
    if (l->out->cancelled || !failed) return NULL;
    return "fine elements could not be received: out of memory, or out of OpenGL";
}

static const char *gather(gathering *l) {
    const shooters *s = l->setup->store->shooters;
    const char *failure = NULL;
    for (size_t i = 0; i < s->count && !failure && !l->out->cancelled;) {
        l->batch.count = 0;
        for (; i < s->count && l->batch.count < COLUMN_BATCH; i++)
            if (s->all[i].is_counted) l->batch.shooters[l->batch.count++] = (uint32_t)i;
        failure = gather_batch(l);
        l->out->done = (double)i / (double)s->count;
    }
    return failure;
}

const char *refined_gather(const refined_gather_setup *setup, refined_gather_result *out, char *message,
                           size_t message_size) {
    gathering l = { .setup = setup, .out = out };
    size_t samples = setup->fine->sample_count;
    allocator *memory = setup->fine->memory;
    const char *failure = "out of memory";
    memset(out, 0, sizeof *out);
    out->irradiance = block_new(memory, (3 * samples + 1) * sizeof *out->irradiance);
    out->row_sum = block_new(memory, (samples + 1) * sizeof *out->row_sum);
    l.fine = block_zeroed(memory, samples + 1, sizeof *l.fine);
    l.workers = block_zeroed(memory, jobs_worker_count(setup->store->jobs), sizeof *l.workers);
    bool ok = out->irradiance && out->row_sum && l.fine && l.workers &&
              refined_elements_find(coarse_mesh(&l), setup->irradiance, setup->row_sum, setup->fine, setup->places,
                                    &l.elements);
    if (ok) l.coarse = block_zeroed(memory, 4 * l.elements.count + 1, sizeof *l.coarse);
    if (ok && l.coarse) failure = gather(&l);
    for (size_t i = 0, t = 0; !failure && i < setup->fine->element_count; i++) {
        if (l.elements.all[t].coarse != setup->places[i].coarse) t++;
        finish_element(&l, t, i);
    }
    column_store_rest(setup->store);
    for (unsigned w = 0; l.workers && w < jobs_worker_count(setup->store->jobs); w++) {
        const gather_worker *worker = &l.workers[w];
        block_free_all(worker->corners, worker->receivers, worker->chosen);
    }
    if (failure) snprintf(message, message_size, "%s", failure);
    refined_elements_free(&l.elements);
    block_free_all(l.coarse, l.fine, l.workers);
    return failure ? message : NULL;
}

void refined_gather_free(refined_gather_result *r) {
    block_free_all(r->irradiance, r->row_sum, r->half_difference);
    memset(r, 0, sizeof *r);
}
