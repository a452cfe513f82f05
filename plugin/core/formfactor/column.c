/* SPDX-License-Identifier: MIT
 * See column.h.
 */
#include "formfactor/column.h"

#include "base/tolerance.h"
#include "base/vec3.h"
#include "formfactor/polygon.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* What a part of the shooter gives to all samples, and where its own power goes. */
typedef struct part {
    float *factors; /* factors[sample], 0 where nothing arrives */
    hemicube_closure closure;
    double received; /* sum_s A_s F_s, m2 */
} part;

struct column_worker {
    const column_setup *setup;
    item_buffer *items;
    hemicube cube;
    double *batch;     /* unoccluded factors of one receiving patch */
    double *sum;       /* sum[sample] over the parts of the shooter */
    part parts[4];     /* of the level that is being compared */
    uint32_t *reached; /* patches with a nonzero factor in sum */
    bool *is_reached;  /* of patches */
    size_t reached_count;
    column statistics; /* of the column in work; holds no arrays */
    bool failed;
};

typedef struct shooter {
    uint32_t patch;
    const surface *surface;
    double power_area; /* area of the whole patch */
    bool light;
} shooter;

static size_t longest_run(const mesh *m) {
    size_t longest = 1;
    for (size_t p = 0; p < m->patch_count; p++)
        if (m->patches[p].sample_count > longest) longest = m->patches[p].sample_count;
    return longest;
}

static bool allocate(column_worker *w, const column_setup *s) {
    const mesh *m = s->mesh;
    size_t n = (size_t)(s->resolution > s->resolution_light ? s->resolution : s->resolution_light);
    w->cube.ids = malloc(3 * n * n * sizeof *w->cube.ids);
    w->batch = malloc(longest_run(m) * sizeof *w->batch);
    w->sum = calloc(m->sample_count + 1, sizeof *w->sum);
    w->reached = malloc((m->patch_count + 1) * sizeof *w->reached);
    w->is_reached = calloc(m->patch_count + 1, sizeof *w->is_reached);
    bool all = w->cube.ids && w->batch && w->sum && w->reached && w->is_reached;
    for (int i = 0; i < 4; i++) {
        w->parts[i].factors = calloc(m->sample_count + 1, sizeof *w->parts[i].factors);
        all = all && w->parts[i].factors;
    }
    return all;
}

column_worker *column_worker_create(const column_setup *setup, char *message, size_t message_size) {
    int n = setup->resolution > setup->resolution_light ? setup->resolution : setup->resolution_light;
    column_worker *w = calloc(1, sizeof *w);
    if (!w) return NULL;
    w->setup = setup;
    snprintf(message, message_size, "out of memory");
    const item_buffer_desc desc = { .geometry = &setup->items, .width = n, .height = 3 * n, .backend = setup->backend };
    if (allocate(w, setup)) w->items = item_buffer_open(&desc, message, message_size);
    if (w->items) return w;
    column_worker_destroy(w);
    return NULL;
}

void column_worker_destroy(column_worker *w) {
    if (!w) return;
    item_buffer_destroy(w->items);
    free(w->cube.ids);
    free(w->batch);
    free(w->sum);
    free(w->reached);
    free(w->is_reached);
    for (int i = 0; i < 4; i++) free(w->parts[i].factors);
    free(w);
}

/* splitmix64 (Steele, Lea & Flood 2014): a well-mixed function of its argument alone. */
static uint64_t mix(uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/* The turn of a hemi-cube about its normal, so that the pixel grids of neighbours do not line up to a plaid. */
static double turn_of(const column_worker *w, const shooter *s, uint64_t path) {
    uint64_t bits = mix(mix(w->setup->seed ^ mix(s->patch)) ^ path);
    return (double)(bits >> 11) * 0x1p-53 * 2.0 * PI;
}

static polygon patch_polygon(const mesh *m, const patch *p) {
    polygon out = { .count = patch_corner_count(p) };
    for (int i = 0; i < out.count; i++) vec3_copy(out.corner[i], m->vertices + 3 * (size_t)p->corner[i]);
    return out;
}

static bool any_corner_above(const mesh *m, const patch *p, const surface *plane, double margin) {
    for (int i = 0; i < patch_corner_count(p); i++)
        if (surface_height(plane, m->vertices + 3 * (size_t)p->corner[i]) > margin) return true;
    return false;
}

/* factors[k] = F from sample k of the receiver to a distant small shooter: cos cos A / (pi r2). */
static void point_factors(const mesh *m, const patch *receiver, const surface *facing, const double center[3],
                          const double area_vector[3], double *factors) {
    for (uint32_t k = 0; k < receiver->sample_count; k++) {
        uint32_t s = receiver->first_sample + k;
        double to_sample[3] = { m->x[s] - center[0], m->y[s] - center[1], m->z[s] - center[2] };
        double r2 = vec3_dot(to_sample, to_sample);
        double emitted = vec3_dot(area_vector, to_sample), received = -vec3_dot(facing->normal, to_sample);
        factors[k] = emitted > 0.0 && received > 0.0 ? emitted * received / (PI * r2 * r2) : 0.0;
    }
}

static void closed_form_factors(const mesh *m, const patch *receiver, const surface *facing, const polygon *above,
                                double *factors) {
    uint32_t first = receiver->first_sample;
    memset(factors, 0, receiver->sample_count * sizeof *factors);
    polygon_factor_batch(above, facing->normal, m->x + first, m->y + first, m->z + first, receiver->sample_count,
                         factors);
}

/* Writes the factors of one receiving patch; false if none of its samples gets any. */
static bool receive(column_worker *w, const shooter *s, const polygon *shape, const double center[3], double diameter,
                    const double area_vector[3], uint32_t receiver_index, part *out) {
    const column_setup *setup = w->setup;
    const mesh *m = setup->mesh;
    const patch *receiver = &m->patches[receiver_index];
    const surface *facing = &setup->scene->surfaces[receiver->surface];
    double margin = TOLERANCE_PLANE * setup->scene->radius;
    float *factors = out->factors + receiver->first_sample;
    memset(factors, 0, receiver->sample_count * sizeof *factors);
    if (!any_corner_above(m, receiver, s->surface, margin)) return false;
    polygon above;
    polygon_clip(&above, shape, facing->normal, facing->plane + margin);
    if (above.count < 3) return false;
    double nearest = vec3_distance(center, receiver->center) - 0.5 * receiver->diameter;
    bool closed_form = s->light || nearest < setup->proximity_diameters * diameter;
    if (closed_form)
        closed_form_factors(m, receiver, facing, &above, w->batch);
    else
        point_factors(m, receiver, facing, center, area_vector, w->batch);
    w->statistics.evaluations += receiver->sample_count;
    if (closed_form) w->statistics.analytic += receiver->sample_count;
    bool any = false;
    for (uint32_t k = 0; k < receiver->sample_count; k++) {
        uint32_t i = receiver->first_sample + k;
        const double point[3] = { m->x[i], m->y[i], m->z[i] };
        if (w->batch[k] <= 0.0) continue;
        if (!hemicube_sees(&w->cube, setup->scene, setup->triangle_surface, receiver->surface, point)) continue;
        factors[k] = (float)w->batch[k];
        out->received += m->sample_area[i] * w->batch[k];
        any = true;
    }
    return any;
}

static void mark_reached(column_worker *w, uint32_t patch_index) {
    if (w->is_reached[patch_index]) return;
    w->is_reached[patch_index] = true;
    w->reached[w->reached_count++] = patch_index;
}

/* Draws the hemi-cube of one piece of the shooter, and where the piece's power goes. */
static void look_from_piece(column_worker *w, const shooter *s, const polygon *shape, uint64_t path, part *out) {
    const column_setup *setup = w->setup;
    double center[3], eye[3];
    polygon_centroid(shape, center);
    w->cube.resolution = s->light ? setup->resolution_light : setup->resolution;
    vec3_add_scaled(eye, center, TOLERANCE_EYE_LIFT * setup->scene->radius, s->surface->normal);
    hemicube_place(&w->cube, eye, s->surface->normal, turn_of(w, s, path));
    if (!hemicube_draw(&w->cube, w->items, setup->scene->center)) w->failed = true;
    w->statistics.hemicubes++;
    out->closure = hemicube_close(&w->cube, s->light ? setup->weights_light : setup->weights, setup->scene,
                                  setup->triangle_surface);
}

/* What every sample gets from the piece whose hemi-cube was drawn last. */
static void give_from_piece(column_worker *w, const shooter *s, const polygon *shape, part *out) {
    double center[3], area_vector[3];
    polygon_centroid(shape, center);
    polygon_vector_area(shape, area_vector);
    double diameter = sqrt(vec3_length(area_vector)); /* the edge of a square as large: see proximity.h */
    out->received = 0.0;
    for (uint32_t p = 0; p < w->setup->mesh->patch_count; p++)
        if (receive(w, s, shape, center, diameter, area_vector, p, out)) mark_reached(w, p);
}

static void add_part(column_worker *w, const part *p, double share) {
    const mesh *m = w->setup->mesh;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t k = 0; k < receiver->sample_count; k++)
            w->sum[receiver->first_sample + k] += p->factors[receiver->first_sample + k];
    }
    w->statistics.closure.front += share * p->closure.front;
    w->statistics.closure.back += share * p->closure.back;
    w->statistics.closure.sky += share * p->closure.sky;
}

/* The received power, m2 of shooter, whose visibility the four parts disagree on: samples that some see and others do
 * not, weighted by what they would get if all did. */
static double disputed(const column_worker *w) {
    const mesh *m = w->setup->mesh;
    double sum = 0.0;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t s = receiver->first_sample; s < receiver->first_sample + receiver->sample_count; s++) {
            double got = 0.0;
            int seen = 0;
            for (int q = 0; q < 4; q++) {
                seen += w->parts[q].factors[s] > 0.0f;
                got += w->parts[q].factors[s];
            }
            if (seen > 0 && seen < 4) sum += m->sample_area[s] * got * 4.0 / seen;
        }
    }
    return sum;
}

/* The number of a quarter in the tree of pieces, whose root is 0. */
static uint64_t path_of_quarter(uint64_t path, int q) {
    return 4 * path + (uint64_t)q + 1;
}

/* Quarters a piece, share of the shooter's area, at most depth times, until the parts agree on what they see [Baum89,
 * sec. 5B]. */
static void shoot_quarters(column_worker *w, const shooter *s, const polygon *shape, uint64_t path, double share,
                           int depth, double tolerance) {
    polygon quarter[4];
    polygon_quarter(shape, quarter);
    for (int q = 0; q < 4; q++) {
        look_from_piece(w, s, &quarter[q], path_of_quarter(path, q), &w->parts[q]);
        give_from_piece(w, s, &quarter[q], &w->parts[q]);
    }
    double penumbra = disputed(w) / s->power_area;
    if (path == 0) w->statistics.penumbra = penumbra;
    if (penumbra > tolerance * share && depth > 1) {
        for (int q = 0; q < 4; q++)
            shoot_quarters(w, s, &quarter[q], path_of_quarter(path, q), 0.25 * share, depth - 1, tolerance);
        return;
    }
    for (int q = 0; q < 4; q++) add_part(w, &w->parts[q], 0.25 * share);
}

/* Does something stand on the piece whose hemi-cube was drawn last, or pass through it? */
static bool is_crossed(const column_worker *w, const polygon *shape) {
    return hemicube_is_crossed(&w->cube, w->setup->scene, w->setup->triangle_surface, shape);
}

/* Quarters a piece that something stands on until its parts are clear of it, and leaves out those inside. Returns the
 * share of the shooter's area that is not inside. */
static double shoot_around(column_worker *w, const shooter *s, const polygon *shape, uint64_t path, double share,
                           int depth) {
    polygon quarter[4];
    double clear = 0.0;
    polygon_quarter(shape, quarter);
    for (int q = 0; q < 4; q++) {
        look_from_piece(w, s, &quarter[q], path_of_quarter(path, q), &w->parts[0]);
        if (depth > 1 && is_crossed(w, &quarter[q])) {
            clear += shoot_around(w, s, &quarter[q], path_of_quarter(path, q), 0.25 * share, depth - 1);
        } else if (w->parts[0].closure.back <= TOLERANCE_BURIED) {
            give_from_piece(w, s, &quarter[q], &w->parts[0]);
            add_part(w, &w->parts[0], 0.25 * share);
            clear += 0.25 * share;
        }
    }
    return clear;
}

/* The radiosity of a patch is the mean over its whole area, and what is inside something has none: what is clear of it
 * shoots the power of all. */
static void scale_sums(column_worker *w, double scale) {
    const mesh *m = w->setup->mesh;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t k = 0; k < receiver->sample_count; k++) w->sum[receiver->first_sample + k] *= scale;
    }
    w->statistics.closure.front *= scale;
    w->statistics.closure.back *= scale;
    w->statistics.closure.sky *= scale;
}

/* A whole patch that is no lamp: one hemi-cube; pieces if something stands on it, or if it gives away more than it has
 * [Baum89, eq. 10]. */
static void shoot_whole(column_worker *w, const shooter *s, const polygon *shape) {
    part *whole = &w->parts[0];
    look_from_piece(w, s, shape, 0, whole);
    bool crossed = is_crossed(w, shape), may_split = w->setup->patch_depth > 0;
    w->statistics.crossed = crossed || 1.0 - whole->closure.back < TOLERANCE_ENCLOSED;
    if (may_split && crossed) {
        w->statistics.split = true;
        double clear = shoot_around(w, s, shape, 0, 1.0, w->setup->patch_depth + 1);
        if (clear > 0.0) scale_sums(w, 1.0 / clear);
        return;
    }
    give_from_piece(w, s, shape, whole);
    double excess = whole->received / s->power_area - whole->closure.front;
    if (may_split && excess > TOLERANCE_CLOSURE_EXCESS) {
        w->statistics.split = true;
        shoot_quarters(w, s, shape, 0, 1.0, w->setup->patch_depth, TOLERANCE_CLOSURE_EXCESS);
        return;
    }
    add_part(w, whole, 1.0);
}

static int compare_indices(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static column *column_new(size_t run_count, size_t factor_count) {
    column *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    c->runs = malloc((run_count + 1) * sizeof *c->runs);
    c->factors = malloc((factor_count + 1) * sizeof *c->factors);
    c->run_count = run_count;
    c->factor_count = factor_count;
    if (c->runs && c->factors) return c;
    column_destroy(c);
    return NULL;
}

/* A column that gives away more than there is, is brought down to it [Baum89, eq. 11]; in a closed room, where all must
 * arrive, one that misses a few percent is brought up. A larger deficit stays: it is light that samples cannot see. In
 * an open scene the hemi-cube is no measure: it knows the centre of the shooter, the column its whole. */
static double normalisation(double total, double front) {
    if (total <= 0.0) return 1.0;
    double ratio = 1.0 / total;
    bool closed = front > 1.0 - TOLERANCE_CLOSED;
    return ratio < 1.0 || (closed && ratio <= 1.0 + TOLERANCE_CLOSURE_EXCESS) ? ratio : 1.0;
}

/* Moves the dense sums of the reached patches into a column, in patch order, and clears them. */
static column *collect(column_worker *w, double area) {
    const mesh *m = w->setup->mesh;
    size_t factor_count = 0, next = 0;
    qsort(w->reached, w->reached_count, sizeof *w->reached, compare_indices);
    for (size_t i = 0; i < w->reached_count; i++) factor_count += m->patches[w->reached[i]].sample_count;
    column *c = column_new(w->reached_count, factor_count);
    double total = 0.0;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        double received = 0.0;
        for (uint32_t s = receiver->first_sample; s < receiver->first_sample + receiver->sample_count; s++) {
            received += m->sample_area[s] * w->sum[s];
            if (c) c->factors[next++] = (float)w->sum[s];
            w->sum[s] = 0.0;
        }
        if (c)
            c->runs[i] =
                (column_run){ w->reached[i], (uint32_t)(next - receiver->sample_count), received / receiver->area };
        w->is_reached[w->reached[i]] = false;
        total += received;
    }
    w->statistics.total = total / area;
    w->statistics.scale = normalisation(w->statistics.total, w->statistics.closure.front);
    return c;
}

static void finish(column *c, const column *statistics) {
    column head = *statistics;
    head.runs = c->runs, head.run_count = c->run_count;
    head.factors = c->factors, head.factor_count = c->factor_count;
    *c = head;
    for (size_t i = 0; i < c->run_count; i++) c->runs[i].factor *= c->scale;
    for (size_t i = 0; i < c->factor_count; i++) c->factors[i] *= (float)c->scale;
}

column *column_compute(column_worker *w, uint32_t patch_index) {
    const column_setup *setup = w->setup;
    const patch *p = &setup->mesh->patches[patch_index];
    const surface *f = &setup->scene->surfaces[p->surface];
    const double *M = setup->scene->materials[f->material].M;
    bool light = M[0] > 0.0 || M[1] > 0.0 || M[2] > 0.0;
    shooter s = { .patch = patch_index, .surface = f, .power_area = p->area, .light = light };
    polygon shape = patch_polygon(setup->mesh, p);
    memset(&w->statistics, 0, sizeof w->statistics);
    w->reached_count = 0;
    w->failed = false;
    if (light && setup->light_depth > 0) {
        w->statistics.split = true;
        shoot_quarters(w, &s, &shape, 0, 1.0, setup->light_depth, setup->light_tolerance);
    } else {
        shoot_whole(w, &s, &shape);
    }
    column *c = collect(w, p->area);
    if (c) finish(c, &w->statistics);
    if (!w->failed) return c;
    column_destroy(c);
    return NULL;
}

void column_destroy(column *c) {
    if (!c) return;
    free(c->runs);
    free(c->factors);
    free(c);
}

size_t column_bytes(const column *c) {
    return sizeof *c + c->run_count * sizeof *c->runs + c->factor_count * sizeof *c->factors;
}
