/* SPDX-License-Identifier: MIT
 * What does every sample get from a shooter, by the hybrid of [Baum89, sec. 5]? See column.h for how and where it
 * differs from the paper.
 */
#include "formfactor/column_worker.h"

#include "base/splitmix.h"
#include "base/tolerance.h"
#include "base/vec3.h"

#include <string.h>

static const double PI = 3.14159265358979323846;

typedef struct source {
    const column_piece *piece;
    const surface *surface;
    bool light;
    double coverage; /* share of the piece that is no hole */
} source;

/* The turn of a hemi-cube about its normal, so that the pixel grids of neighbours do not line up to a plaid. */
static double turn_of(const column_worker *w, const source *s, uint64_t path) {
    return splitmix_unit(splitmix(w->setup->seed ^ splitmix(s->piece->patch)) ^ path) * 2.0 * PI;
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
static bool receive(column_worker *w, const source *s, const polygon *shape, const double center[3], double diameter,
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
    bool closed_form = s->light || setup->method == COLUMN_ANALYTIC || nearest < setup->proximity_diameters * diameter;
    if (closed_form)
        closed_form_factors(m, receiver, facing, &above, w->batch);
    else
        point_factors(m, receiver, facing, center, area_vector, w->batch);
    for (uint32_t k = 0; s->coverage < 1.0 && k < receiver->sample_count; k++) w->batch[k] *= s->coverage;
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
/* Draws the hemi-cube of one piece of the shooter, and where the piece's power goes. */
static void look_from_piece(column_worker *w, const source *s, const polygon *shape, uint64_t path, part *out) {
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
static void give_from_piece(column_worker *w, const source *s, const polygon *shape, part *out) {
    double center[3], area_vector[3];
    polygon_centroid(shape, center);
    polygon_vector_area(shape, area_vector);
    double diameter = sqrt(vec3_length(area_vector)); /* the edge of a square as large: see proximity.h */
    out->received = 0.0;
    for (uint32_t p = 0; p < w->setup->mesh->patch_count; p++)
        if (receive(w, s, shape, center, diameter, area_vector, p, out)) column_mark_reached(w, p);
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

/* Quarters a piece, share of the shooter's area, at most depth times, until the parts agree on what they see [Baum89,
 * sec. 5B]. */
static void shoot_quarters(column_worker *w, const source *s, const polygon *shape, uint64_t path, double share,
                           int depth, double tolerance) {
    polygon quarter[4];
    polygon_quarter(shape, quarter);
    for (int q = 0; q < 4; q++) {
        look_from_piece(w, s, &quarter[q], column_path_of_quarter(path, q), &w->parts[q]);
        give_from_piece(w, s, &quarter[q], &w->parts[q]);
    }
    double penumbra = disputed(w) / s->piece->area;
    if (path == s->piece->path) w->statistics.penumbra = penumbra;
    if (penumbra > tolerance * share && depth > 1) {
        for (int q = 0; q < 4; q++)
            shoot_quarters(w, s, &quarter[q], column_path_of_quarter(path, q), 0.25 * share, depth - 1, tolerance);
        return;
    }
    for (int q = 0; q < 4; q++) add_part(w, &w->parts[q], 0.25 * share);
}

/* Does something stand on the piece whose hemi-cube was drawn last, or pass through it? */
static bool is_crossed(const column_worker *w, const polygon *shape) {
    return hemicube_is_crossed(&w->cube, w->setup->scene, w->setup->triangle_surface, shape);
}

/* A piece whose eye is inside something may still have a strip outside, next to what stands there, which it then lights
 * too little: such pieces are quartered this much further. */
enum { DEPTH_INSIDE = 2 };

/* Quarters a piece that something stands on until its parts are clear of it, and leaves out those inside. Returns the
 * share of the shooter's area that is not inside. */
static double shoot_around(column_worker *w, const source *s, const polygon *shape, uint64_t path, double share,
                           int depth) {
    polygon quarter[4];
    double clear = 0.0;
    polygon_quarter(shape, quarter);
    for (int q = 0; q < 4; q++) {
        look_from_piece(w, s, &quarter[q], column_path_of_quarter(path, q), &w->parts[0]);
        bool inside = w->parts[0].closure.back > TOLERANCE_BURIED;
        if (depth > (inside ? 1 - DEPTH_INSIDE : 1) && is_crossed(w, &quarter[q])) {
            clear += shoot_around(w, s, &quarter[q], column_path_of_quarter(path, q), 0.25 * share, depth - 1);
        } else if (!inside) {
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
static void shoot_whole(column_worker *w, const source *s, const polygon *shape) {
    part *whole = &w->parts[0];
    look_from_piece(w, s, shape, s->piece->path, whole);
    bool crossed = is_crossed(w, shape), may_split = w->setup->patch_depth > 0;
    w->statistics.crossed = crossed || 1.0 - whole->closure.back < TOLERANCE_ENCLOSED;
    if (may_split && crossed) {
        w->statistics.split = true;
        double clear = shoot_around(w, s, shape, s->piece->path, 1.0, w->setup->patch_depth + 1);
        if (clear > 0.0) scale_sums(w, 1.0 / clear);
        return;
    }
    give_from_piece(w, s, shape, whole);
    double excess = whole->received / s->piece->area - whole->closure.front;
    if (may_split && excess > TOLERANCE_CLOSURE_EXCESS) {
        w->statistics.split = true;
        shoot_quarters(w, s, shape, s->piece->path, 1.0, w->setup->patch_depth, TOLERANCE_CLOSURE_EXCESS);
        return;
    }
    add_part(w, whole, 1.0);
}

void column_give_hybrid(column_worker *w, const column_piece *piece) {
    const column_setup *setup = w->setup;
    const patch *from = &setup->mesh->patches[piece->patch];
    source s = { piece, &setup->scene->surfaces[from->surface], material_emits(&from->finish), from->coverage };
    if (s.light && setup->light_depth > 0) {
        w->statistics.split = true;
        shoot_quarters(w, &s, &piece->shape, piece->path, 1.0, setup->light_depth, setup->light_tolerance);
    } else {
        shoot_whole(w, &s, &piece->shape);
    }
}
