/* SPDX-License-Identifier: MIT
 * What does every sample get from a shooter, by the hybrid of [Baum89, sec. 5]? See column.h for how and where it
 * differs from the paper.
 */
#include "formfactor/column_worker.h"

#include "base/block.h"
#include "base/splitmix.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <string.h>

static const double PI = 3.14159265358979323846;

/* The turn of a hemi-cube about its normal, so that the pixel grids of neighbours do not line up to a plaid. */
static double turn_of(const column_worker *w, const shooting_subpatch *s, uint64_t path) {
    return splitmix_unit(splitmix(w->setup->seed ^ splitmix(s->piece->patch)) ^ path) * 2.0 * PI;
}

/* Takes back what the hemi-cube drawn last gave. */
static void forget_reached(column_worker *w) {
    for (size_t i = 0; i < w->reached_count; i++) w->is_reached[w->reached[i]] = false;
    w->reached_count = 0;
}

bool column_sees_sample(const column_worker *w, const mesh *m, uint32_t surface_index, uint32_t sample) {
    const double point[3] = { m->x[sample], m->y[sample], m->z[sample] };
    return hemicube_sees(&w->cube, w->setup->scene, w->setup->triangle_surface, surface_index, point);
}

/* Writes the factors of one receiving patch; false if none of its samples gets any. */
static bool receive(column_worker *w, const shooting_subpatch *s, const shooter_view *from, uint32_t receiver_index,
                    part *out) {
    const mesh *m = w->setup->mesh;
    const column_receiver r = column_patch_receiver(m, receiver_index);
    float *factors = out->factors + r.first_sample;
    bool any = false;
    memset(factors, 0, r.sample_count * sizeof *factors);
    if (!unoccluded_factors(w, s, from, m, &r)) return false;
    for (uint32_t k = 0; k < r.sample_count; k++) {
        uint32_t i = r.first_sample + k;
        if (w->batch[k] <= 0.0 || !column_sees_sample(w, m, r.surface, i)) continue;
        factors[k] = (float)w->batch[k];
        out->received += m->sample_area[i] * w->batch[k];
        any = true;
    }
    return any;
}

static void place(column_worker *w, const shooting_subpatch *s, const double point[3], uint64_t path) {
    const column_setup *setup = w->setup;
    double eye[3];
    w->cube.resolution = s->light ? setup->resolution_light : setup->resolution;
    vec3_add_scaled(eye, point, TOLERANCE_EYE_LIFT * setup->scene->radius, s->normal);
    hemicube_place(&w->cube, eye, s->normal, turn_of(w, s, path));
}

void column_look(column_worker *w, const shooting_subpatch *s, const double point[3], uint64_t path) {
    place(w, s, point, path);
    if (!hemicube_draw(&w->cube, w->items, w->setup->scene->center)) w->failed = true;
}

/* Keeps what the hemi-cube drawn last saw. */
static void keep_cube(column_worker *w) {
    w->packed_count = hemicube_pack(&w->cube, NULL);
    w->packed = block_new(w->setup->mesh->memory, (2 * w->packed_count + 1) * sizeof *w->packed);
    if (w->packed)
        hemicube_pack(&w->cube, w->packed);
    else
        w->packed_count = 0;
}

/* The same, and where the piece's power goes. */
static void look_from_piece(column_worker *w, const shooting_subpatch *s, const polygon *shape, uint64_t path,
                            part *out) {
    const column_setup *setup = w->setup;
    const shooter_view from = shooter_view_from(s, shape);
    column_look(w, s, from.center, path);
    w->statistics.hemicubes++;
    out->closure = hemicube_close(&w->cube, s->light ? setup->weights_light : setup->weights, setup->scene,
                                  setup->triangle_surface);
}

/* What every sample gets from the piece whose hemi-cube was drawn last. */
static void give_from_piece(column_worker *w, const shooting_subpatch *s, const polygon *shape, part *out) {
    const shooter_view from = shooter_view_from(s, shape);
    out->received = 0.0;
    for (uint32_t p = 0; p < w->setup->mesh->patch_count; p++)
        if (receive(w, s, &from, p, out)) column_mark_reached(w, p);
}

static void add_part(column_worker *w, const part *p, uint64_t path, double share) {
    const mesh *m = w->setup->mesh;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t k = 0; k < receiver->sample_count; k++)
            w->sum[receiver->first_sample + k] += p->factors[receiver->first_sample + k];
    }
    w->statistics.closure.front += share * p->closure.front;
    w->statistics.closure.back += share * p->closure.back;
    w->statistics.closure.sky += share * p->closure.sky;
    column_add_path(w, path);
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
static void shoot_quarters(column_worker *w, const shooting_subpatch *s, const polygon *shape, uint64_t path,
                           double share, int depth, double tolerance) {
    polygon quarter[4];
    polygon_quarter(shape, quarter);
    for (int q = 0; q < 4; q++) {
        look_from_piece(w, s, &quarter[q], subpatch_path_of_quarter(path, q), &w->parts[q]);
        give_from_piece(w, s, &quarter[q], &w->parts[q]);
    }
    double penumbra = disputed(w) / s->piece->area;
    if (path == s->piece->path) w->statistics.penumbra = penumbra;
    if (penumbra > tolerance * share && depth > 1) {
        for (int q = 0; q < 4; q++)
            shoot_quarters(w, s, &quarter[q], subpatch_path_of_quarter(path, q), 0.25 * share, depth - 1, tolerance);
        return;
    }
    for (int q = 0; q < 4; q++) add_part(w, &w->parts[q], subpatch_path_of_quarter(path, q), 0.25 * share);
}

/* A cluster is no plane: its own members are not in its way. */
static hemicube_floor floor_of(const column_worker *w, const shooting_subpatch *s, const polygon *shape,
                               double height) {
    const clustering *c = s->piece->cluster ? w->setup->mesh->clustering : NULL;
    return (hemicube_floor){ .shape = shape,
                             .height = height,
                             .group = c ? c->of_surface : NULL,
                             .own = c ? c->of_patch[s->piece->patch] : NO_INDEX };
}

/* Does something stand on the piece whose hemi-cube was drawn last, or pass through it? */
static bool is_crossed(const column_worker *w, const shooting_subpatch *s, const polygon *shape) {
    const hemicube_floor floor = floor_of(w, s, shape, 0.0);
    return hemicube_is_crossed(&w->cube, w->setup->scene, w->setup->triangle_surface, &floor);
}

/* Does something do so, or hang so low over it that what the eye sees is not what the whole piece sees? */
static bool is_crowded(const column_worker *w, const shooting_subpatch *s, const polygon *shape) {
    double area_vector[3];
    polygon_vector_area(shape, area_vector);
    const hemicube_floor floor = floor_of(w, s, shape, TOLERANCE_LOW * sqrt(vec3_length(area_vector)));
    return hemicube_is_crossed(&w->cube, w->setup->scene, w->setup->triangle_surface, &floor);
}

/* A piece whose eye is inside something may still have a strip outside, next to what stands there, which it then lights
 * too little: such pieces are quartered this much further. */
enum { DEPTH_INSIDE = 2 };

/* Quarters a piece that something stands on until its parts are clear of it, and leaves out those inside. Returns the
 * share of the shooter's area that is not inside. */
static double shoot_around(column_worker *w, const shooting_subpatch *s, const polygon *shape, uint64_t path,
                           double share, int depth) {
    polygon quarter[4];
    double clear = 0.0;
    polygon_quarter(shape, quarter);
    for (int q = 0; q < 4; q++) {
        look_from_piece(w, s, &quarter[q], subpatch_path_of_quarter(path, q), &w->parts[0]);
        bool inside = w->parts[0].closure.back > TOLERANCE_BURIED;
        if (depth > (inside ? 1 - DEPTH_INSIDE : 1) && is_crowded(w, s, &quarter[q])) {
            clear += shoot_around(w, s, &quarter[q], subpatch_path_of_quarter(path, q), 0.25 * share, depth - 1);
        } else if (!inside) {
            give_from_piece(w, s, &quarter[q], &w->parts[0]);
            add_part(w, &w->parts[0], subpatch_path_of_quarter(path, q), 0.25 * share);
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
    w->statistics.piece_scale *= scale;
    w->statistics.closure.front *= scale;
    w->statistics.closure.back *= scale;
    w->statistics.closure.sky *= scale;
}

/* A whole patch that is no emitter: one hemi-cube; pieces if something stands on it, or if it gives away more than it
 * has [Baum89, eq. 10]. */
static void shoot_whole(column_worker *w, const shooting_subpatch *s, const polygon *shape) {
    part *whole = &w->parts[0];
    look_from_piece(w, s, shape, s->piece->path, whole);
    bool crossed = is_crossed(w, s, shape), may_split = w->setup->patch_depth > 0;
    w->statistics.crossed = crossed || 1.0 - whole->closure.back < TOLERANCE_ENCLOSED;
    if (may_split && (crossed || is_crowded(w, s, shape))) {
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
    if (w->setup->keep_cubes) keep_cube(w);
    add_part(w, whole, s->piece->path, 1.0);
}

/* A cluster: one hemi-cube does, or none. */
static void shoot_cluster(column_worker *w, const shooting_subpatch *s, const polygon *outline) {
    part *whole = &w->parts[0];
    look_from_piece(w, s, outline, s->piece->path, whole);
    bool inside = whole->closure.back > TOLERANCE_BURIED;
    w->statistics.crowded = inside || is_crossed(w, s, outline) || is_crowded(w, s, outline);
    if (w->statistics.crowded) return;
    give_from_piece(w, s, outline, whole);
    w->statistics.crowded = whole->received / s->piece->area - whole->closure.front > TOLERANCE_CLOSURE_EXCESS;
    if (w->statistics.crowded) {
        forget_reached(w);
        return;
    }
    if (w->setup->keep_cubes) keep_cube(w);
    add_part(w, whole, s->piece->path, 1.0);
}

void column_give_hybrid(column_worker *w, const subpatch *piece) {
    const column_setup *setup = w->setup;
    shooting_subpatch s = shooting_subpatch_of(w, piece);
    if (s.light && setup->exact_emitters) {
        column_shoot_emitter(w, &s);
    } else if (s.light && setup->light_depth > 0) {
        w->statistics.split = true;
        shoot_quarters(w, &s, &piece->shape, piece->path, 1.0, setup->light_depth, setup->light_tolerance);
    } else if (piece->cluster) {
        shoot_cluster(w, &s, &piece->shape);
    } else {
        shoot_whole(w, &s, &piece->shape);
    }
}

/* ---- other receivers -----------------------------------------------------------------------------------------------
 */

static void shape_of_path(const subpatch *piece, uint64_t path, polygon *out) {
    polygon parent, quarter[4];
    if (path == piece->path) {
        *out = piece->shape;
        return;
    }
    shape_of_path(piece, (path - 1) / 4, &parent);
    polygon_quarter(&parent, quarter);
    *out = quarter[(path - 1) % 4];
}

void column_receive_hybrid(column_worker *w, const column *c, const subpatch *piece, const mesh *receiving,
                           const column_receiver *receivers, size_t count, float *factors) {
    const shooting_subpatch s = shooting_subpatch_of(w, piece);
    if (s.light && w->setup->exact_emitters) column_emitter_factors(w, &s, receiving, receivers, count, factors);
    for (size_t i = 0; i < c->path_count; i++) {
        polygon shape;
        shape_of_path(piece, c->paths[i], &shape);
        const shooter_view from = shooter_view_from(&s, &shape);
        if (c->packed) {
            place(w, &s, from.center, c->paths[i]);
            hemicube_unpack(&w->cube, c->packed, c->packed_count);
        } else {
            column_look(w, &s, from.center, c->paths[i]);
        }
        float *at = factors;
        for (size_t r = 0; r < count; at += receivers[r++].sample_count) {
            if (!unoccluded_factors(w, &s, &from, receiving, &receivers[r])) continue;
            for (uint32_t k = 0; k < receivers[r].sample_count; k++)
                if (w->batch[k] > 0.0 &&
                    column_sees_sample(w, receiving, receivers[r].surface, receivers[r].first_sample + k))
                    at[k] += (float)w->batch[k];
        }
    }
}
