/* SPDX-License-Identifier: MIT
 * See row_emitters.h.
 */
#include "solver/row_emitters.h"

#include "base/sobol.h"
#include "base/splitmix.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "scene/contact_lines.h"
#include "solver/emitter_tree.h"
#include "solver/row_sharing.h"
#include "visibility/panes.h"

#include <math.h>
#include <string.h>

/* Up to so many are each sampled: a closed form costs as much as a ray or two. */
enum { FEW = 96, ELEMENTS_A_JOB = 64 };

/* Where each ray is for one of many, so many times as many rays. */
enum { MANY_TIMES = 4 };

/* Rays of a sample where there is no time for more. */
enum { LEAST_RAYS = 2 };

/* Further away than this many of its own radii an emitter is a point: by less than 1 % (formfactor/near_distance.h). */
static const double FAR_RADII = 8.0;

/* A ray sees what it was sent to when it gets this far. */
static const double ARRIVED = 1.0 - 1e-4;

typedef struct emitter_gather {
    const row_emitters_setup *setup;
    int ray_count;
    bool *done; /* done[e] */
    kept_pass kept;
    row_sharing sharing;
    atomic_bool *failed; /* out of memory */
    emitter_tree tree;
} emitter_gather;

/* A sample, and which way it looks. */
typedef struct receiver {
    double from[3];
    const double *normal, *front;
    double plane; /* of its surface */
    uint64_t seed;
    uint32_t first; /* of its points in the net of its element */
    uint32_t sheet; /* of its surface */
    pane_crossings *crossings;
} receiver;

/* ---- one emitter ---- */

static bool may_see(const tree_emitter *one, const receiver *r) {
    double to[3];
    vec3_sub(to, one->center, r->from);
    double reach = one->radius;
    return vec3_dot(one->normal, to) < 0.0 && vec3_dot(r->normal, to) > -reach && vec3_dot(r->front, to) > -reach;
}

static double factor_of(const emitter_gather *g, const tree_emitter *one, const receiver *r) {
    const mesh *m = g->setup->mesh;
    const patch *p = &m->patches[one->patch];
    double to[3];
    if (!may_see(one, r)) return 0.0;
    vec3_sub(to, one->center, r->from);
    double square = vec3_dot(to, to);
    if (square > FAR_RADII * FAR_RADII * one->radius * one->radius) {
        double received = vec3_dot(r->normal, to), emitted = -vec3_dot(one->normal, to);
        return received > 0.0 ? received * emitted * one->area / (PI * square * square) : 0.0;
    }
    const polygon whole = mesh_polygon(m, p->corner);
    polygon above;
    polygon_clip(&above, &whole, r->front, r->plane + TOLERANCE_PLANE * g->setup->scene->radius);
    return fmax(polygon_factor(&above, r->from, r->normal), 0.0) * p->coverage;
}

/* A point of an emitter for a point of the square: a quad is two triangles, by their areas. */
static void point_of(const mesh *m, const patch *p, const double square[2], double out[3]) {
    const double *a = m->vertices + 3 * (size_t)p->corner[0], *b = m->vertices + 3 * (size_t)p->corner[1];
    const double *c = m->vertices + 3 * (size_t)p->corner[2];
    double u = square[0], root, v = square[1];
    if (p->corner[3] != NO_INDEX) {
        const double *d = m->vertices + 3 * (size_t)p->corner[3];
        double ab[3], ac[3], ad[3], first[3], second[3];
        vec3_sub(ab, b, a), vec3_sub(ac, c, a), vec3_sub(ad, d, a);
        vec3_cross(first, ab, ac), vec3_cross(second, ac, ad);
        double share = vec3_length(first) / fmax(vec3_length(first) + vec3_length(second), 1e-300);
        if (u < share)
            u /= share;
        else
            u = (u - share) / (1.0 - share), b = c, c = d;
    }
    root = sqrt(u);
    for (int k = 0; k < 3; k++) out[k] = (1 - root) * a[k] + root * ((1 - v) * b[k] + v * c[k]);
}

/* What panes leave of the light from a point. */
static void pass_panes(const emitter_gather *g, const receiver *r, const double point[3], double T[3]) {
    const scene *s = g->setup->scene;
    T[0] = T[1] = T[2] = 1.0;
    if (s->panes && !panes_transmit(s->panes, r->sheet, r->from, point, r->crossings, T)) *g->failed = true;
}

/* Does a ray to a point of an emitter get there? *weight: the cosines over the squared distance. */
static bool reaches(const emitter_gather *g, const tree_emitter *one, const receiver *r, const double point[3],
                    double *weight) {
    const mesh *m = g->setup->hit ? g->setup->hit : g->setup->mesh;
    double to[3], reached = INFINITY;
    uint32_t hit = NO_INDEX;
    vec3_sub(to, point, r->from);
    double distance = vec3_normalize(to), received = vec3_dot(to, r->normal);
    *weight = 0.0;
    if (received <= 0.0 || vec3_dot(to, r->front) <= 0.0 || !(distance > 0.0)) return false;
    *weight = received * -vec3_dot(to, one->normal) / (distance * distance);
    ray_end end = rays_measure(g->setup->rays, r->from, to, &hit, &reached);
    if (end == RAY_FRONT && m->elements[hit].patch == one->patch) return true;
    return end == RAY_SKY || reached >= ARRIVED * distance;
}

/* The share of the light from a point of an emitter that comes to a receiver, T[c]. */
static void sees(const emitter_gather *g, const tree_emitter *one, const receiver *r, const double point[3],
                 double *weight, double T[3]) {
    T[0] = T[1] = T[2] = 0.0;
    if (reaches(g, one, r, point, weight)) pass_panes(g, r, point, T);
}

/* ---- all, where they are few ---- */

typedef struct shares {
    double E[2][3]; /* by either half */
} shares;

static void add_to(const tree_emitter *one, double factor, double seen[2][3], shares *out) {
    for (int h = 0; h < 2; h++)
        for (int c = 0; c < 3; c++) out->E[h][c] += factor * seen[h][c] * one->M[c];
}

/* The share of one emitter that count rays see, by either half of them. */
static void sample_emitter(const emitter_gather *g, const tree_emitter *one, const receiver *r, uint32_t at,
                           uint32_t count, double seen[2][3]) {
    const patch *p = &g->setup->mesh->patches[one->patch];
    double sum[2][3] = { { 0 }, { 0 } }, weights[2] = { 0, 0 };
    for (uint32_t i = 0; i < count; i++) {
        double square[2], point[3], weight, T[3];
        sobol_2d(r->first + at + i, splitmix(r->seed + one->patch), square);
        point_of(g->setup->mesh, p, square, point);
        sees(g, one, r, point, &weight, T);
        int h = 2 * i >= count;
        vec3_add_scaled(sum[h], sum[h], weight, T);
        weights[h] += weight;
    }
    for (int c = 0; c < 3; c++) {
        double all = weights[0] + weights[1] > 0.0 ? (sum[0][c] + sum[1][c]) / (weights[0] + weights[1]) : 0.0;
        for (int h = 0; h < 2; h++) seen[h][c] = weights[h] > 0.0 ? sum[h][c] / weights[h] : all;
        /* What both halves say together is what counts: the halves only say how sure it is. */
        double middle = 0.5 * (seen[0][c] + seen[1][c]);
        seen[0][c] += all - middle, seen[1][c] += all - middle;
    }
}

/* Emitters of which less than one ray's worth of light comes share rays, each going to one of them by its light. */
static void sample_faint(const emitter_gather *g, const receiver *r, const double *given, double all, double least,
                         uint32_t count, shares *out) {
    double rest = 0.0, next, passed = 0.0;
    for (size_t j = 0; j < g->tree.count; j++)
        if (given[j] < least) rest += given[j];
    if (!(rest > 0.0)) return;
    uint32_t n = 2 * (uint32_t)ceil(0.5 * count * rest / all), k = 0;
    next = rest / n * sobol_1d(r->first, (uint32_t)r->seed);
    for (size_t j = 0; j < g->tree.count; j++) {
        const tree_emitter *one = &g->tree.emitters[j];
        if (!(given[j] > 0.0) || given[j] >= least) continue;
        passed += given[j];
        for (; next < passed && k < n; k++, next += rest / n) {
            double square[2], point[3], weight;
            sobol_2d(r->first + k, splitmix(r->seed + 1), square);
            point_of(g->setup->mesh, &g->setup->mesh->patches[one->patch], square, point);
            double seen[2][3] = { { 0 }, { 0 } }, T[3];
            sees(g, one, r, point, &weight, T);
            vec3_add_scaled(seen[k & 1], seen[k & 1], 2.0 / n, T);
            add_to(one, rest / one->luminance, seen, out);
        }
    }
}

static void sample_each(const emitter_gather *g, const receiver *r, shares *out) {
    double given[FEW], all = 0.0;
    uint32_t count = (uint32_t)g->ray_count;
    for (size_t j = 0; j < g->tree.count; j++) {
        const tree_emitter *one = &g->tree.emitters[j];
        given[j] = factor_of(g, one, r) * one->luminance;
        all += given[j];
    }
    if (!(all > 0.0)) return;
    double least = all / count;
    for (size_t j = 0; j < g->tree.count; j++) {
        if (!(given[j] > 0.0) || given[j] < least) continue;
        const tree_emitter *one = &g->tree.emitters[j];
        double seen[2][3];
        sample_emitter(g, one, r, 0, 2 * (uint32_t)ceil(0.5 * count * given[j] / all), seen);
        add_to(one, given[j] / one->luminance, seen, out);
    }
    sample_faint(g, r, given, all, least, count, out);
}

/* ---- some, where they are many ---- */

static void sample_by_importance(const emitter_gather *g, const receiver *r, shares *out) {
    uint32_t count = MANY_TIMES * (uint32_t)g->ray_count;
    for (uint32_t i = 0; i < count; i++) {
        double square[2], point[3], weight, probability;
        sobol_2d(r->first + i, splitmix(r->seed + 1), square);
        const tree_emitter *one = emitter_tree_sample(&g->tree, r->from, r->normal, &square[0], &probability);
        double factor = one ? factor_of(g, one, r) : 0.0;
        if (!(factor > 0.0)) continue;
        point_of(g->setup->mesh, &g->setup->mesh->patches[one->patch], square, point);
        double seen[2][3] = { { 0 }, { 0 } }, T[3];
        sees(g, one, r, point, &weight, T);
        vec3_add_scaled(seen[2 * i >= count], seen[2 * i >= count], 2.0, T);
        add_to(one, factor / (probability * count), seen, out);
    }
}

static void gather_sample(const emitter_gather *g, uint32_t element_index, int corner, pane_crossings *crossings) {
    const mesh *m = g->setup->mesh;
    const element *e = &m->elements[element_index];
    const surface *f = &g->setup->scene->surfaces[m->patches[e->patch].surface];
    size_t s = e->first_sample + (size_t)corner;
    const double place[3] = { m->x[s], m->y[s], m->z[s] };
    receiver r = { .normal = mesh_sample_normal(m, f, s),
                   .front = f->normal,
                   .plane = f->plane,
                   .seed = splitmix(g->setup->seed ^ splitmix(element_index) ^ 0x9e37u),
                   .first = MANY_TIMES * (uint32_t)(corner * g->ray_count),
                   .sheet = surface_sheet(g->setup->scene, m->patches[e->patch].surface),
                   .crossings = crossings };
    shares found = { { { 0, 0, 0 }, { 0, 0, 0 } } };
    vec3_add_scaled(r.from, place, TOLERANCE_EYE_LIFT * g->setup->scene->radius, f->normal);
    if (g->tree.count <= FEW)
        sample_each(g, &r, &found);
    else
        sample_by_importance(g, &r, &found);
    for (size_t c = 0; c < 3; c++) {
        g->setup->irradiance[3 * s + c] += 0.5 * (found.E[0][c] + found.E[1][c]);
        g->setup->half_difference[3 * s + c] = 0.5 * (found.E[0][c] - found.E[1][c]);
    }
}

static bool wait(void *user) {
    const emitter_gather *g = user;
    return !g->setup->wait || g->setup->wait(g->setup->wait_user);
}

/* What the samples of a job have, for whoever keeps it: kept[i] of element begin + i, and as many differences. */
static size_t list_kept(const emitter_gather *g, size_t begin, size_t end, kept_part kept[2 * ELEMENTS_A_JOB]) {
    size_t count = end - begin;
    for (size_t e = begin; e < end; e++) {
        const element *one = &g->setup->mesh->elements[e];
        size_t bands = 3 * (size_t)element_corner_count(one), first = 3 * (size_t)one->first_sample;
        kept[e - begin] = (kept_part){ g->setup->irradiance + first, bands * sizeof(double) };
        kept[count + e - begin] = (kept_part){ g->setup->half_difference + first, bands * sizeof(double) };
    }
    return 2 * count;
}

static void gather_job(void *user, size_t job, unsigned worker) {
    const emitter_gather *g = user;
    const mesh *m = g->setup->mesh;
    pane_crossings crossings = { 0 };
    kept_part kept[2 * ELEMENTS_A_JOB] = { { 0 } };
    size_t begin = job * ELEMENTS_A_JOB, left = m->element_count - begin;
    size_t end = begin + (left < ELEMENTS_A_JOB ? left : ELEMENTS_A_JOB), kept_count = list_kept(g, begin, end, kept);
    (void)worker;
    bool is_kept = kept_take_numbers(&g->kept, job, kept, kept_count, kept_count / 2);
    for (size_t e = begin; e < end; e++) {
        if (g->done[e]) continue;
        g->done[e] = true;
        if (is_kept || !row_sharing_is_own(&g->sharing, e)) continue;
        if (m->elements[e].is_foot) continue;
        for (int k = 0; k < element_corner_count(&m->elements[e]); k++) gather_sample(g, (uint32_t)e, k, &crossings);
    }
    if (!is_kept && !*g->failed) kept_give(&g->kept, job, kept, kept_count);
    block_free(crossings.all);
}

/* False: out of memory, or those who share the samples are lost. */
static bool give(const emitter_gather *g) {
    return row_sharing_give_samples(&g->sharing, g->setup->irradiance, 3 * sizeof(double)) &&
           row_sharing_give_samples(&g->sharing, g->setup->half_difference, 3 * sizeof(double));
}

bool row_emitters_gather(const row_emitters_setup *setup) {
    const mesh *m = setup->mesh;
    atomic_bool failed = false;
    emitter_gather g = { .setup = setup,
                         .failed = &failed,
                         .ray_count = setup->ray_count,
                         .kept = jobs_begin_pass(setup->jobs),
                         .done = block_zeroed(m->memory, m->element_count + 1, sizeof *g.done) };
    bool ok = g.done && row_sharing_open(jobs_ranks(setup->jobs), m, NULL, ELEMENTS_A_JOB, &g.sharing) &&
              emitter_tree_create(m, setup->scene, &g.tree);
    size_t count = (m->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
    if (ok && g.tree.count > 0 && !jobs_run(setup->jobs, count, gather_job, wait, &g)) {
        g.ray_count = LEAST_RAYS, g.kept.in = NULL;
        jobs_run(setup->jobs, count, gather_job, NULL, &g);
    }
    if (ok && !failed && g.tree.count > 0) ok = give(&g);
    emitter_tree_free(&g.tree);
    row_sharing_free(&g.sharing);
    block_free(g.done);
    return ok && !failed;
}
