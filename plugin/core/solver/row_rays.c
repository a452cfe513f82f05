/* SPDX-License-Identifier: MIT
 * See row_rays.h.
 */
#include "solver/row_rays.h"

#include "base/sobol.h"
#include "base/splitmix.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "scene/contact_lines.h"

#include <math.h>
#include <string.h>

/* So many elements that follow each other in a patch share one net, and each has room for four samples in it. */
enum { ELEMENTS_OF_A_NET = 4, SAMPLES_OF_AN_ELEMENT = 4 };

/* ---- memory ---- */

/* Where the rays of each element begin, and how many there are in all. */
static size_t set_begins(const row_rays *r, size_t *begin, const row_counts *counts) {
    size_t total = 0;
    for (size_t e = 0; e < r->mesh->element_count; e++) {
        const row_counts *n = &counts[e];
        begin[e] = total;
        if (!row_sharing_is_own(r->sharing, e)) continue;
        total += ((size_t)n->initial + n->cosine + n->guided) * (size_t)element_corner_count(&r->mesh->elements[e]);
    }
    return total;
}

bool row_rays_open(row_rays *r, row_counts *counts) {
    allocator *memory = r->mesh->memory;
    r->counts = counts;
    r->begin = block_new(memory, (r->mesh->element_count + 1) * sizeof *r->begin);
    size_t total = r->begin ? set_begins(r, r->begin, counts) : 0;
    r->hit = block_new(memory, (total + 1) * sizeof *r->hit);
    r->weight = block_new(memory, (total + 1) * sizeof *r->weight);
    return r->begin && r->hit && r->weight;
}

bool row_rays_create(row_rays *r, uint16_t count) {
    row_counts *counts = block_zeroed(r->mesh->memory, r->mesh->element_count + 1, sizeof *counts);
    for (size_t e = 0; counts && e < r->mesh->element_count; e++) counts[e].initial = count;
    return counts && row_rays_open(r, counts);
}

void row_rays_free(row_rays *r) {
    block_free_all(r->counts, r->begin, r->hit, r->weight);
    r->counts = NULL, r->begin = NULL, r->hit = NULL, r->weight = NULL;
}

bool row_rays_extend(row_rays *r, row_counts *counts) {
    allocator *memory = r->mesh->memory;
    row_rays next = *r;
    next.counts = counts;
    next.begin = block_new(memory, (r->mesh->element_count + 1) * sizeof *next.begin);
    size_t total = next.begin ? set_begins(r, next.begin, counts) : 0;
    next.hit = block_new(memory, (total + 1) * sizeof *next.hit);
    next.weight = block_new(memory, (total + 1) * sizeof *next.weight);
    if (!next.begin || !next.hit || !next.weight) {
        block_free_all(next.begin, next.hit, next.weight);
        return false;
    }
    for (size_t e = 0; e < r->mesh->element_count; e++)
        for (int k = 0; row_sharing_is_own(r->sharing, e) && k < element_corner_count(&r->mesh->elements[e]); k++)
            memcpy(next.hit + row_begin(&next, e, k), r->hit + row_begin(r, e, k), counts[e].initial * sizeof *r->hit);
    row_rays_free(r);
    *r = next;
    return true;
}

void row_rays_truncate(row_rays *r, uint32_t element_index, uint16_t initial) {
    size_t begin = r->begin[element_index], before = row_count(r, element_index);
    r->counts[element_index] = (row_counts){ .initial = initial };
    for (size_t k = 1; k < (size_t)element_corner_count(&r->mesh->elements[element_index]); k++)
        memmove(r->hit + begin + k * initial, r->hit + begin + k * before, initial * sizeof *r->hit);
}

/* ---- directions ---- */

row_sampler row_sampler_of(const row_rays *r, uint32_t element_index, int corner) {
    const mesh *m = r->mesh;
    const element *e = &m->elements[element_index];
    const surface *f = &r->scene->surfaces[m->patches[e->patch].surface];
    size_t s = e->first_sample + (size_t)corner;
    const double place[3] = { m->x[s], m->y[s], m->z[s] };
    uint32_t in_patch = element_index - m->patches[e->patch].first_element, in_net = in_patch % ELEMENTS_OF_A_NET;
    uint64_t net = splitmix(r->seed ^ splitmix(((uint64_t)e->patch << 32) + in_patch / ELEMENTS_OF_A_NET));
    row_sampler at = { .element = element_index,
                       .corner = corner,
                       .net = net,
                       .own = splitmix(net + 1 + in_net),
                       .row_of_net = in_net * SAMPLES_OF_AN_ELEMENT + (uint32_t)corner,
                       .front = f->normal };
    vec3_copy(at.axes[2], mesh_sample_normal(m, f, s));
    vec3_tangents(at.axes[2], at.axes[0], at.axes[1]);
    vec3_add_scaled(at.from, place, TOLERANCE_EYE_LIFT * r->scene->radius, f->normal);
    return at;
}

row_sampler row_sampler_guided(const row_rays *r, const row_guiding *guiding, uint32_t element_index, int corner,
                               row_lobes *lobes) {
    row_sampler at = row_sampler_of(r, element_index, corner);
    if (r->counts[element_index].guided == 0) return at;
    row_guiding_lobes(guiding, element_index, at.from, at.axes[2], lobes);
    at.lobes = lobes;
    return at;
}

/* Sine and cosine of up to an eighth of a turn, by the series: to 4e-7, and of one direction exactly. */
static void turn(double angle, double *sine, double *cosine) {
    double square = angle * angle;
    *sine = angle * (1 - square / 6 * (1 - square / 20 * (1 - square / 42)));
    *cosine = sqrt(1 - *sine * *sine);
}

/* By the cosine about the normal: evenly over the disc under the hemisphere, onto which the square is mapped by squares
 * of growing size [Shirley97]. */
static void cosine_direction(const row_sampler *at, const double point[2], double out[3]) {
    double a = 2 * point[0] - 1, b = 2 * point[1] - 1, x, y;
    if (fabs(a) > fabs(b)) {
        turn(PI / 4 * (b / a), &y, &x);
        x *= a, y *= a;
    } else {
        turn(PI / 4 * (b != 0.0 ? a / b : 0.0), &x, &y);
        x *= b, y *= b;
    }
    double z = sqrt(fmax(1.0 - x * x - y * y, 0.0));
    for (int k = 0; k < 3; k++) out[k] = x * at->axes[0][k] + y * at->axes[1][k] + z * at->axes[2][k];
    /* Where facets are shaded smooth, some directions would go into the surface itself: they are mirrored by it, so
     * that a sample still has all of its rays. */
    double height = vec3_dot(out, at->front);
    if (height < 0.0) vec3_add_scaled(out, out, -2.0 * height, at->front);
}

void row_direction(const row_rays *r, const row_sampler *at, size_t i, double out[3]) {
    const row_counts *n = &r->counts[at->element];
    uint32_t corner = (uint32_t)at->corner, adaptive = (uint32_t)i - n->initial;
    double point[2];
    bool is_guided = i >= (size_t)n->initial + n->cosine && at->lobes && row_lobes_any(at->lobes);
    if (is_guided) {
        uint32_t index = corner * n->guided + adaptive - n->cosine;
        sobol_2d(index, splitmix(at->own + 1), point);
        row_lobes_direction(at->lobes, point, out);
        return;
    }
    if (i < n->initial)
        sobol_2d(at->row_of_net * n->initial + (uint32_t)i, at->net, point);
    else
        sobol_2d(corner * ((uint32_t)n->cosine + n->guided) + adaptive, at->own, point);
    cosine_direction(at, point, out);
}

void row_sky(const row_rays *r, const row_sampler *at, size_t i, double L[3]) {
    double direction[3] = { 0, 0, 0 };
    if (!row_sky_is_even(r)) row_direction(r, at, i, direction);
    lights_sky_radiance(r->lights, direction, L);
}

/* ---- casting ---- */

/* What a ray along a direction weighs, before the row's weights are brought to 1: a share of the cosine. */
static double weight_of(const row_sampler *at, const row_counts *n, const double direction[3]) {
    double cosine = vec3_dot(direction, at->axes[2]);
    if (!at->lobes || !row_lobes_any(at->lobes)) return 1.0;
    if (cosine <= 0.0 || vec3_dot(direction, at->front) <= 0.0) return 0.0;
    return cosine / ((n->initial + n->cosine) * cosine + n->guided * PI * row_lobes_pdf(at->lobes, direction));
}

/* What ray i of a sample meets; scratch: for panes. */
static uint32_t cast(row_rays *r, const row_sampler *at, size_t s, size_t i, const double direction[3],
                     pane_crossings *scratch) {
    uint32_t hit = NO_INDEX;
    double distance = 0.0;
    if (vec3_dot(direction, at->front) <= 0.0) return ROW_HIT_BACK; /* guided below the horizon: weighs nothing */
    if (r->mesh->elements[at->element].is_foot) return ROW_HIT_BACK;
    ray_end end = rays_measure(r->rays, at->from, direction, &hit, &distance);
    static const row_pane_end ends[] = {
        [RAY_FRONT] = ROW_PANE_ELEMENT, [RAY_BACK] = ROW_PANE_BACK, [RAY_SKY] = ROW_PANE_SKY
    };
    bool passes = r->panes.of_sample &&
                  row_panes_trace(&r->panes, scratch, s, (uint32_t)i, at->from, direction, distance, ends[end], hit);
    if (passes && end == RAY_FRONT) return ROW_HIT_PANES;
    return end == RAY_FRONT ? hit : end == RAY_SKY ? ROW_HIT_SKY : ROW_HIT_BACK;
}

/* What a ray of weight w brings from the sky, and to the row's sum. */
static void add_end(row_rays *r, const row_sampler *at, size_t s, size_t i, const double direction[3], double w,
                    size_t *cursor) {
    uint32_t hit = r->hit[row_begin(r, at->element, at->corner) + i];
    double L[3], T[3];
    if (hit == ROW_HIT_BACK) return;
    r->row_sum[s] += w;
    if (hit != ROW_HIT_SKY || !r->lights->has_sky) return;
    lights_sky_radiance(r->lights, direction, L);
    if (r->panes.of_sample) {
        row_panes_sky(&r->panes, s, (uint32_t)i, cursor, T);
        for (int c = 0; c < 3; c++) L[c] *= T[c];
    }
    double *from_sky = r->sky + 6 * s + 3 * (size_t)row_half(&r->counts[at->element], i);
    vec3_add_scaled(from_sky, from_sky, PI * w, L);
}

static void cast_row(row_rays *r, const row_sampler *at, size_t first, pane_crossings *scratch) {
    const row_counts *n = &r->counts[at->element];
    size_t begin = row_begin(r, at->element, at->corner), count = row_count(r, at->element);
    size_t s = r->mesh->elements[at->element].first_sample + (size_t)at->corner;
    size_t cursor = 0;
    double sum = 0.0;
    if (r->panes.of_sample) row_panes_truncate(&r->panes, s, (uint32_t)first);
    r->row_sum[s] = 0.0;
    memset(r->sky + 6 * s, 0, 6 * sizeof *r->sky);
    for (size_t i = 0; i < count; i++) {
        double direction[3] = { 0, 0, 0 };
        if (i >= first || n->guided > 0 || !row_sky_is_even(r)) row_direction(r, at, i, direction);
        double weight = weight_of(at, n, direction);
        if (i >= first) r->hit[begin + i] = cast(r, at, s, i, direction, scratch);
        r->weight[begin + i] = (float)weight;
        sum += weight;
        add_end(r, at, s, i, direction, weight, &cursor);
    }
    /* A sample that looks into its own surface may have no ray that weighs anything: it gets nothing. */
    double share = sum > 0.0 ? 1.0 / sum : 0.0;
    for (size_t i = 0; i < count; i++) r->weight[begin + i] *= (float)share;
    for (size_t k = 0; k < 6; k++) r->sky[6 * s + k] *= share;
    r->row_sum[s] *= share;
}

void row_rays_cast(row_rays *r, uint32_t element_index, size_t first, const row_guiding *guiding) {
    pane_crossings scratch = { 0 };
    for (int k = 0; k < element_corner_count(&r->mesh->elements[element_index]); k++) {
        row_lobes lobes;
        const row_sampler at = row_sampler_guided(r, guiding, element_index, k, &lobes);
        cast_row(r, &at, first, &scratch);
    }
    block_free(scratch.all);
}

double row_escaped_share(const row_rays *r, size_t e) {
    int corners = element_corner_count(&r->mesh->elements[e]);
    size_t begin = r->begin[e], count = row_count(r, e) * (size_t)corners;
    double lost = 0.0;
    for (size_t i = begin; i < begin + count; i++)
        if (r->hit[i] > ROW_HIT_PANES) lost += (double)r->weight[i];
    return lost / corners;
}
