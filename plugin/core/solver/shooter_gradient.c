/* SPDX-License-Identifier: MIT */
#include "solver/shooter_gradient.h"

#include "base/tolerance.h"
#include "formfactor/sample_factors.h"

#include <string.h>

/* In edges of the shooter, between its border and the receiver's. Measured on the rooms of tests/accuracy: 1 leaves a
 * tenth of the effect out, 4 costs twice the time for 0.02 % of error. */
static const double REACH = 2.0;

/* Of a shooter's radiosity: slopes below this are not worth it. */
static const double EVEN = 0.01;

/* Light between near shooters has settled when a pass changes it by less than this, rms, of all there is. */
static const double SETTLED = 4e-3;
enum { PASSES_MAX = 8 };

/* A sample on a patch that something stands on is inside it if it gets less than this share of what there is. */
static const double REACH_INSIDE = 0.1;

static void set_element(shooter_gradient *n, size_t index, const double *irradiance, const double *row_sum,
                        bool crossed) {
    const element *e = &n->mesh->elements[index];
    int count = element_corner_count(e), clear = 0;
    double sum[3] = { 0, 0, 0 };
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)count; s++) {
        if (crossed && row_sum[s] < REACH_INSIDE) continue;
        clear++;
        vec3_add_scaled(sum, sum, 1.0, irradiance + 3 * s);
    }
    n->clear[index] = (float)clear / (float)count;
    for (int c = 0; c < 3; c++)
        n->B[3 * index + (size_t)c] = clear ? e->material->M[c] + e->material->rho[c] * sum[c] / clear : 0.0;
}

/* 1, or less where the patch's surface has holes, which areas do not count. */
static double coverage_of(const shooter_gradient *n, const element *e) {
    double whole[3];
    if (!n->scene->surfaces[n->mesh->patches[e->patch].surface].holes) return 1.0;
    const polygon shape = mesh_polygon(n->mesh, e->corner);
    polygon_vector_area(&shape, whole);
    return fmin(e->area / vec3_length(whole), 1.0);
}

static void set_shooter(shooter_gradient *n, uint32_t index, const double *shot) {
    uint32_t count;
    const uint32_t *members = mesh_members(n->mesh, &index, &count);
    double *mean = n->shot + 3 * (size_t)index, area = subpatch_of_patch(n->scene, n->mesh, index).area, most = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const patch *p = &n->mesh->patches[members[i]];
        for (size_t e = p->first_element; e < (size_t)p->first_element + p->element_count; e++)
            vec3_add_scaled(mean, mean, n->clear[e] * n->mesh->elements[e].area / area, n->B + 3 * e);
    }
    if (shot) vec3_copy(mean, shot + 3 * (size_t)index);
    for (uint32_t i = 0; i < count; i++) {
        const patch *p = &n->mesh->patches[members[i]];
        for (size_t e = p->first_element; e < (size_t)p->first_element + p->element_count; e++)
            for (size_t c = 0; c < 3; c++) most = fmax(most, fabs(n->clear[e] * n->B[3 * e + c] - mean[c]));
    }
    n->even[index] =
        most <= EVEN * fmax(mean[0], fmax(mean[1], mean[2])) || material_emits(&n->mesh->patches[index].material);
}

bool shooter_gradient_create(const scene *s, const mesh *m, const double *irradiance, const double *row_sum,
                             const bool *crossed, const double *shot, shooter_gradient *out) {
    *out = (shooter_gradient){ .scene = s,
                               .mesh = m,
                               .B = block_new(m->memory, (3 * m->element_count + 1) * sizeof *out->B),
                               .clear = block_new(m->memory, (m->element_count + 1) * sizeof *out->clear),
                               .coverage = block_new(m->memory, (m->element_count + 1) * sizeof *out->coverage),
                               .shot = block_zeroed(m->memory, 3 * m->patch_count + 1, sizeof *out->shot),
                               .even = block_new(m->memory, m->patch_count + 1) };
    bool ok = out->B && out->clear && out->coverage && out->shot && out->even;
    for (size_t e = 0; ok && e < m->element_count; e++) {
        set_element(out, e, irradiance, row_sum, crossed[m->elements[e].patch]);
        out->coverage[e] = (float)coverage_of(out, &m->elements[e]);
    }
    for (uint32_t p = 0; ok && p < m->patch_count; p++)
        if (mesh_lead(m, p) == p) set_shooter(out, p, shot);
    return ok;
}

void shooter_gradient_free(shooter_gradient *n) {
    block_free_all(n->B, n->clear, n->coverage, n->shot, n->even);
    memset(n, 0, sizeof *n);
}

bool shooter_gradient_reaches(const shooter_gradient *n, const subpatch *from, const column_receiver *r) {
    if (n->even[from->patch]) return false;
    double gap = vec3_distance(from->center, r->center) - 0.5 * from->diameter - 0.5 * r->diameter;
    return gap < REACH * sqrt(from->area);
}

/* Of the elements of one patch. */
static double patch_gap(const shooter_gradient *n, const patch *p, const column_receiver *r) {
    double gap = INFINITY;
    for (uint32_t e = p->first_element; e < p->first_element + p->element_count; e++) {
        const polygon shape = mesh_polygon(n->mesh, n->mesh->elements[e].corner);
        double center[3];
        polygon_centroid(&shape, center);
        gap = fmin(gap, vec3_distance(center, r->center) - sqrt(n->mesh->elements[e].area));
    }
    return gap;
}

double shooter_gradient_gap(const shooter_gradient *n, const subpatch *from, const column_receiver *r) {
    uint32_t count;
    const uint32_t *members = mesh_members(n->mesh, &from->patch, &count);
    double gap = INFINITY;
    for (uint32_t i = 0; i < count; i++) gap = fmin(gap, patch_gap(n, &n->mesh->patches[members[i]], r));
    return gap - 0.5 * r->diameter;
}

/* What the samples of a receiver get from the elements of a patch, as if nothing stood between. */
typedef struct direct {
    const mesh *receiving;
    const column_receiver *r;
    double *one, *sum, *gain; /* of one element; of all: one[k], sum[k], gain[3*k+c] */
} direct;

static void add_patch(const shooter_gradient *n, const patch *p, const direct *d) {
    const surface *facing = &n->scene->surfaces[d->r->surface];
    size_t count = d->r->sample_count, first = d->r->first_sample;
    double margin = TOLERANCE_PLANE * n->scene->radius;
    for (uint32_t e = p->first_element; e < p->first_element + p->element_count; e++) {
        const polygon shape = mesh_polygon(n->mesh, n->mesh->elements[e].corner);
        polygon above;
        polygon_clip(&above, &shape, facing->normal, facing->plane + margin);
        if (above.count < 3 || n->clear[e] <= 0.0f) continue;
        memset(d->one, 0, count * sizeof *d->one);
        sample_factors_add(d->receiving, facing, d->r->is_smooth, &above, first, count, d->one);
        for (size_t k = 0; k < count; k++) {
            double F = n->clear[e] * d->one[k];
            if (F <= 0.0) continue;
            d->sum[k] += p->coverage * F;
            vec3_add_scaled(d->gain + 3 * k, d->gain + 3 * k, n->coverage[e] * F, n->B + 3 * (size_t)e);
        }
    }
}

bool shooter_gradient_excess(const shooter_gradient *n, const column *c, const subpatch *from, const mesh *receiving,
                             const column_receiver *r, double *scratch, double *excess) {
    size_t count = r->sample_count;
    uint32_t member_count;
    const uint32_t *members = mesh_members(n->mesh, &from->patch, &member_count);
    const direct d = { receiving, r, scratch, scratch + count, excess };
    bool all = true;
    memset(d.sum, 0, count * sizeof *d.sum);
    memset(excess, 0, 3 * count * sizeof *excess);
    for (uint32_t i = 0; i < member_count; i++) add_patch(n, &n->mesh->patches[members[i]], &d);
    for (size_t k = 0; k < count; k++) {
        all = all && d.sum[k] > 0.0;
        for (size_t band = 0; band < 3 && d.sum[k] > 0.0; band++)
            excess[3 * k + band] =
                excess[3 * k + band] / (c->subpatch_scale * d.sum[k]) - n->shot[3 * (size_t)from->patch + band];
    }
    return all;
}

void shooter_gradient_add(const shooter_gradient *n, const column *c, const subpatch *from, const mesh *receiving,
                          const column_receiver *r, const float *factors, double *scratch, double *E) {
    double *excess = scratch + 2 * (size_t)r->sample_count;
    shooter_gradient_excess(n, c, from, receiving, r, scratch, excess);
    for (size_t k = 0; k < 3 * (size_t)r->sample_count; k++) E[k] += factors[k / 3] * excess[k];
}

/* ---- all samples of the mesh ---- */

/* Of one patch. */
typedef struct gradient_worker {
    double *scratch;
    float *factors; /* as rows are closed */
} gradient_worker;

typedef struct correction {
    const shooter_gradient *n;
    column_store *store;
    column_batch batch;
    double *irradiance;
    gradient_worker *workers; /* of each thread */
    bool ended;               /* on the way */
} correction;

/* What one patch gets from the batch. */
static void correct_patch(void *user, size_t item, unsigned worker) {
    const correction *a = user;
    const mesh *m = a->n->mesh;
    const shooters *s = a->store->shooters;
    const gradient_worker *w = &a->workers[worker];
    const column_receiver r = column_patch_receiver(m, (uint32_t)item);
    double *E = a->irradiance + 3 * (size_t)r.first_sample;
    for (size_t i = 0; i < a->batch.count; i++) {
        const shooter *from = &s->all[a->batch.shooters[i]];
        const column *c = a->batch.columns[i];
        if (mesh_lead(m, (uint32_t)item) == from->subpatch.patch ||
            !shooter_gradient_reaches(a->n, &from->subpatch, &r))
            continue;
        const column_run *run = column_run_of_patch(c, (uint32_t)item);
        if (!run) continue;
        for (uint32_t k = 0; k < r.sample_count; k++)
            w->factors[k] =
                row_closure_close(&s->rows, r.first_sample + k, shooter_emits(s, from), c->factors[run->first + k]);
        shooter_gradient_add(a->n, c, &from->subpatch, m, &r, w->factors, w->scratch, E);
    }
}

/* One pass. */
static bool correct(correction *a) {
    const shooters *s = a->store->shooters;
    const mesh *m = a->n->mesh;
    bool ok = true;
    for (size_t i = 0; ok && i < m->patch_count;) {
        a->batch.count = 0;
        for (; i < m->patch_count && a->batch.count < COLUMN_BATCH; i++)
            if (s->all[i].is_counted && !a->n->even[i]) a->batch.shooters[a->batch.count++] = (uint32_t)i;
        bool held = column_store_hold(a->store, &a->batch, a->store->wait, a->store->wait_user);
        if (held) jobs_run(a->store->jobs, m->patch_count, correct_patch, NULL, a);
        column_store_release(&a->batch);
        if (a->store->wait && !a->store->wait(a->store->wait_user)) {
            a->ended = true;
            break;
        }
        ok = held;
    }
    for (size_t k = 0; k < 3 * m->sample_count; k++) a->irradiance[k] = fmax(a->irradiance[k], 0.0);
    return ok;
}

static bool open_workers(correction *a) {
    const mesh *m = a->n->mesh;
    unsigned workers = jobs_worker_count(a->store->jobs);
    size_t longest = mesh_most_samples(m);
    a->workers = block_zeroed(m->memory, workers, sizeof *a->workers);
    bool ok = a->workers;
    for (unsigned w = 0; ok && w < workers; w++) {
        a->workers[w].scratch = block_new(m->memory, SHOOTER_GRADIENT_SCRATCH * (longest + 1) * sizeof(double));
        a->workers[w].factors = block_new(m->memory, (longest + 1) * sizeof(float));
        ok = a->workers[w].scratch && a->workers[w].factors;
    }
    return ok;
}

static void close_workers(correction *a) {
    for (unsigned w = 0; a->workers && w < jobs_worker_count(a->store->jobs); w++)
        block_free_all(a->workers[w].scratch, a->workers[w].factors);
    block_free(a->workers);
}

/* By how much one irradiance is off another, rms over area, relative to it. */
static double change_of(const mesh *m, const double *from, const double *to) {
    double off = 0.0, level = 0.0;
    for (size_t k = 0; k < 3 * m->sample_count; k++) {
        off += m->sample_area[k / 3] * (to[k] - from[k]) * (to[k] - from[k]);
        level += m->sample_area[k / 3] * to[k] * to[k];
    }
    return level > 0.0 ? sqrt(off / level) : 0.0;
}

/* B_e as the light now is. False when out of memory. */
static bool renew(shooter_gradient *n, const double *row_sum, const bool *crossed, const double *irradiance) {
    shooter_gradient next;
    bool ok = shooter_gradient_create(n->scene, n->mesh, irradiance, row_sum, crossed, n->shot, &next);
    shooter_gradient_free(ok ? n : &next);
    if (ok) *n = next;
    return ok;
}

bool shooter_gradient_correct(shooter_gradient *n, column_store *from, const double *row_sum, const bool *crossed,
                              double *irradiance) {
    size_t bytes = 3 * n->mesh->sample_count * sizeof *irradiance;
    double *solved = block_new(n->mesh->memory, bytes + 1), *before = block_new(n->mesh->memory, bytes + 1);
    correction a = { .n = n, .store = from, .irradiance = irradiance };
    bool ok = solved && before && open_workers(&a), settled = false;
    if (ok) memcpy(solved, irradiance, bytes);
    for (int pass = 0; ok && !settled && pass < PASSES_MAX; pass++) {
        if (pass > 0) ok = renew(n, row_sum, crossed, irradiance);
        if (!ok) break;
        memcpy(before, irradiance, bytes);
        memcpy(irradiance, solved, bytes);
        ok = correct(&a);
        settled = a.ended || change_of(n->mesh, before, irradiance) < SETTLED;
    }
    close_workers(&a);
    block_free_all(solved, before);
    return ok;
}
