/* SPDX-License-Identifier: MIT
 * See row_kept.h.
 */
#include "solver/row_kept.h"

enum { CORNERS_MAX = 4, PARTS_OF_AN_ELEMENT = CORNERS_MAX + 3 };

/* Weights of a row are brought to 1 in floats. */
static const double SUM_MOST = 1.0 + 1e-3;

typedef struct kept_parts {
    kept_part all[PARTS_OF_AN_ELEMENT * ROW_KEPT_ELEMENTS];
    size_t count;
} kept_parts;

static void add_part(kept_parts *to, void *bytes, size_t size) {
    to->all[to->count++] = (kept_part){ bytes, size };
}

static void list(const row_kept_job *job, kept_parts *out) {
    row_rays *r = job->rays;
    out->count = 0;
    for (size_t e = job->begin; e < job->end; e++) {
        size_t corners = (size_t)element_corner_count(&r->mesh->elements[e]), count = row_count(r, e);
        size_t s = r->mesh->elements[e].first_sample, first = job->first[e - job->begin];
        for (size_t k = 0; k < corners; k++)
            add_part(out, r->hit + row_begin(r, e, (int)k) + first, (count - first) * sizeof *r->hit);
        add_part(out, r->weight + r->begin[e], corners * count * sizeof *r->weight);
        add_part(out, r->row_sum + s, corners * sizeof *r->row_sum);
        add_part(out, r->sky + 6 * s, 6 * corners * sizeof *r->sky);
    }
}

/* Those of one row. */
static bool are_weights(const float *all, size_t count) {
    double sum = 0.0;
    bool ok = true;
    for (size_t i = 0; i < count; sum += (double)all[i++]) ok &= all[i] >= 0.0f && all[i] <= 1.0f;
    return ok && sum <= SUM_MOST;
}

/* What is kept may be anybody's bytes. */
static bool is_valid(const row_kept_job *job, size_t e) {
    const row_rays *r = job->rays;
    size_t corners = (size_t)element_corner_count(&r->mesh->elements[e]), count = row_count(r, e);
    size_t s = r->mesh->elements[e].first_sample, begin = r->begin[e];
    bool ok = true;
    for (size_t i = begin; i < begin + corners * count; i++)
        ok &= r->hit[i] < job->hit_count || r->hit[i] == ROW_HIT_BACK || r->hit[i] == ROW_HIT_SKY;
    for (size_t k = 0; ok && k < corners; k++) ok = are_weights(r->weight + begin + k * count, count);
    return ok && kept_are_numbers(r->row_sum + s, corners, 0.0) && kept_are_numbers(r->sky + 6 * s, 6 * corners, 0.0);
}

bool row_kept_take(const row_kept_job *job) {
    kept_parts parts;
    if (!job->pass->in || job->rays->panes.of_sample) return false;
    list(job, &parts);
    bool ok = kept_take(job->pass, job->begin, parts.all, parts.count);
    for (size_t e = job->begin; ok && e < job->end; e++) ok = is_valid(job, e);
    return ok;
}

void row_kept_give(const row_kept_job *job) {
    kept_parts parts;
    if (!job->pass->in || job->rays->panes.of_sample) return;
    list(job, &parts);
    kept_give(job->pass, job->begin, parts.all, parts.count);
}
