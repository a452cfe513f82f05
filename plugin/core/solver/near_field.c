/* SPDX-License-Identifier: MIT
 * See near_field.h.
 */
#include "solver/near_field.h"

#include "base/block.h"
#include "base/tolerance.h"
#include "base/vec3.h"

#include <math.h>
#include <string.h>

/* In edges of the shooter, between its border and the receiver's. Measured on the rooms of tests/accuracy: 1 leaves a
 * tenth of the effect out, 4 costs twice the time for 0.02 % of error. */
static const double REACH = 2.0;

/* Of a shooter's radiosity: slopes below this are not worth it. */
static const double EVEN = 0.01;

/* A sample on a patch that something stands on is inside it if it gets less than this share of what there is. */
static const double REACH_INSIDE = 0.1;

static void set_element(near_field *n, size_t index, const double *irradiance, const double *reach, bool crossed) {
    const element *e = &n->mesh->elements[index];
    int count = element_corner_count(e), clear = 0;
    double sum[3] = { 0, 0, 0 };
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)count; s++) {
        if (crossed && reach[s] < REACH_INSIDE) continue;
        clear++;
        vec3_add_scaled(sum, sum, 1.0, irradiance + 3 * s);
    }
    n->clear[index] = (float)clear / (float)count;
    for (int c = 0; c < 3; c++)
        n->B[3 * index + (size_t)c] = clear ? e->finish.M[c] + e->finish.rho[c] * sum[c] / clear : 0.0;
}

static void shape_of(const mesh *m, const element *e, polygon *out) {
    out->count = element_corner_count(e);
    for (int i = 0; i < out->count; i++) vec3_copy(out->corner[i], m->vertices + 3 * (size_t)e->corner[i]);
}

/* 1, or less where the patch's surface has holes, which areas do not count. */
static double coverage_of(const near_field *n, const element *e) {
    polygon shape;
    double whole[3];
    if (!n->scene->surfaces[n->mesh->patches[e->patch].surface].holes) return 1.0;
    shape_of(n->mesh, e, &shape);
    polygon_vector_area(&shape, whole);
    return fmin(e->area / vec3_length(whole), 1.0);
}

static void set_patch(near_field *n, uint32_t index, const double *irradiance, const double *reach, bool crossed) {
    const patch *p = &n->mesh->patches[index];
    double *mean = n->mean + 3 * (size_t)index, level = 0.0, most = 0.0;
    for (size_t e = p->first_element; e < (size_t)p->first_element + p->element_count; e++) {
        set_element(n, e, irradiance, reach, crossed);
        n->coverage[e] = (float)coverage_of(n, &n->mesh->elements[e]);
        vec3_add_scaled(mean, mean, n->clear[e] * n->mesh->elements[e].area / p->area, n->B + 3 * e);
    }
    for (size_t e = p->first_element; e < (size_t)p->first_element + p->element_count; e++)
        for (size_t c = 0; c < 3; c++) {
            most = fmax(most, fabs(n->clear[e] * n->B[3 * e + c] - mean[c]));
            level = fmax(level, mean[c]);
        }
    n->even[index] = most <= EVEN * level || material_emits(&p->finish);
}

bool near_field_create(const scene *s, const mesh *m, const double *irradiance, const double *reach,
                       const bool *crossed, near_field *out) {
    *out = (near_field){ .scene = s,
                         .mesh = m,
                         .B = block_new(m->memory, (3 * m->element_count + 1) * sizeof *out->B),
                         .clear = block_new(m->memory, (m->element_count + 1) * sizeof *out->clear),
                         .coverage = block_new(m->memory, (m->element_count + 1) * sizeof *out->coverage),
                         .mean = block_zeroed(m->memory, 3 * m->patch_count + 1, sizeof *out->mean),
                         .even = block_new(m->memory, m->patch_count + 1) };
    bool ok = out->B && out->clear && out->coverage && out->mean && out->even;
    for (uint32_t p = 0; ok && p < m->patch_count; p++) set_patch(out, p, irradiance, reach, crossed[p]);
    return ok;
}

void near_field_free(near_field *n) {
    block_free(n->B);
    block_free(n->clear);
    block_free(n->coverage);
    block_free(n->mean);
    block_free(n->even);
    memset(n, 0, sizeof *n);
}

bool near_field_reaches(const near_field *n, uint32_t patch_index, const column_receiver *r) {
    const patch *p = &n->mesh->patches[patch_index];
    if (n->even[patch_index]) return false;
    double gap = vec3_distance(p->center, r->center) - 0.5 * p->diameter - 0.5 * r->diameter;
    return gap < REACH * sqrt(p->area);
}

void near_field_add(const near_field *n, const column *c, uint32_t patch_index, const mesh *receiving,
                    const column_receiver *r, const float *factors, double *scratch, double *E) {
    const patch *p = &n->mesh->patches[patch_index];
    const surface *facing = &n->scene->surfaces[r->surface];
    size_t count = r->sample_count, first = r->first_sample;
    double margin = TOLERANCE_PLANE * n->scene->radius, *one = scratch, *sum = scratch + count, *gain = sum + count;
    memset(sum, 0, 4 * count * sizeof *sum);
    for (uint32_t e = p->first_element; e < p->first_element + p->element_count; e++) {
        polygon shape, above;
        shape_of(n->mesh, &n->mesh->elements[e], &shape);
        polygon_clip(&above, &shape, facing->normal, facing->plane + margin);
        if (above.count < 3 || n->clear[e] <= 0.0f) continue;
        memset(one, 0, count * sizeof *one);
        polygon_factor_batch(&above, facing->normal, receiving->x + first, receiving->y + first, receiving->z + first,
                             count, one);
        for (size_t k = 0; k < count; k++) {
            double F = n->clear[e] * one[k];
            if (F <= 0.0) continue;
            sum[k] += p->coverage * F;
            vec3_add_scaled(gain + 3 * k, gain + 3 * k, n->coverage[e] * F, n->B + 3 * (size_t)e);
        }
    }
    for (size_t k = 0; k < count; k++) {
        if (sum[k] <= 0.0 || factors[k] <= 0.0f) continue;
        double seen = factors[k] / (c->piece_scale * sum[k]);
        for (size_t band = 0; band < 3; band++)
            E[3 * k + band] += seen * gain[3 * k + band] - factors[k] * n->mean[3 * (size_t)patch_index + band];
    }
}

/* ---- all samples of the mesh ---------------------------------------------------------------------------------------
 */

typedef struct correction {
    const near_field *n;
    const shooters *from;
    double *irradiance;
    double **scratch; /* of each worker */
    size_t longest;
    bool failed;
} correction;

static const column_run *run_of_patch(const column *c, uint32_t patch_index) {
    size_t low = 0, high = c->run_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (c->runs[middle].patch < patch_index)
            low = middle + 1;
        else
            high = middle;
    }
    return low < c->run_count && c->runs[low].patch == patch_index ? &c->runs[low] : NULL;
}

static void correct_patch(void *user, size_t item, unsigned worker) {
    const correction *a = user;
    const mesh *m = a->n->mesh;
    const column_receiver r = column_patch_receiver(&m->patches[item]);
    double *scratch = a->scratch[worker], *gain = scratch + NEAR_FIELD_SCRATCH * a->longest;
    memset(gain, 0, 3 * (size_t)r.sample_count * sizeof *gain);
    for (size_t i = 0; i < a->from->count; i++) {
        const shooter *one = &a->from->all[i];
        if (!shooter_is_whole(one) || !one->column || i >= m->patch_count) continue;
        if (i == item || !near_field_reaches(a->n, (uint32_t)i, &r)) continue;
        const column_run *run = run_of_patch(one->column, (uint32_t)item);
        if (run)
            near_field_add(a->n, one->column, (uint32_t)i, m, &r, one->column->factors + run->first, scratch, gain);
    }
    for (size_t k = 0; k < 3 * (size_t)r.sample_count; k++) {
        double *E = &a->irradiance[3 * (size_t)r.first_sample + k];
        *E = fmax(*E + gain[k], 0.0);
    }
}

bool near_field_correct(const near_field *n, const shooters *from, jobs *j, double *irradiance) {
    correction a = { .n = n, .from = from, .irradiance = irradiance };
    unsigned workers = jobs_worker_count(j);
    for (size_t p = 0; p < n->mesh->patch_count; p++)
        if (n->mesh->patches[p].sample_count > a.longest) a.longest = n->mesh->patches[p].sample_count;
    a.scratch = block_zeroed(n->mesh->memory, workers, sizeof *a.scratch);
    bool ok = a.scratch;
    for (unsigned w = 0; ok && w < workers; w++) {
        a.scratch[w] = block_new(n->mesh->memory, (NEAR_FIELD_SCRATCH + 3) * (a.longest + 1) * sizeof **a.scratch);
        ok = a.scratch[w];
    }
    if (ok) jobs_run(j, n->mesh->patch_count, correct_patch, NULL, &a);
    for (unsigned w = 0; a.scratch && w < workers; w++) block_free(a.scratch[w]);
    block_free(a.scratch);
    return ok;
}
