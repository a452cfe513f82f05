/* SPDX-License-Identifier: MIT */
#include "solver/subdivision.h"

#include "base/tolerance.h"
#include "formfactor/column_worker.h"
#include "formfactor/hemicube_visibility.h"

/* ---- one column, several hemi-cubes ---- */

/* The received power, m2 of shooter, whose visibility the four quarters disagree on: samples that some see and others
 * do not, weighted by what they would get if all did. */
static double penumbra_area(const column_worker *w) {
    const mesh *m = w->setup->mesh;
    double sum = 0.0;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        for (uint32_t s = receiver->first_sample; s < receiver->first_sample + receiver->sample_count; s++) {
            double got = 0.0;
            int seen = 0;
            for (int q = 0; q < 4; q++) {
                seen += w->quarters[q].factors[s] > 0.0f;
                got += w->quarters[q].factors[s];
            }
            if (seen > 0 && seen < 4) sum += m->sample_area[s] * got * 4.0 / seen;
        }
    }
    return sum;
}

/* Quarters a subpatch of a shooter, at most depth times, until the quarters agree on what they see, but for a share of
 * its power. */
static void shoot_quarters(column_worker *w, const subpatch *from, const subpatch *whole, int depth, double tolerance) {
    subpatch quarter[4];
    subpatch_quarter(whole, quarter);
    for (int q = 0; q < 4; q++) {
        column_open_subpatch(w, &quarter[q], &w->quarters[q]);
        column_shoot_subpatch(w, &quarter[q], &w->quarters[q]);
    }
    double penumbra = penumbra_area(w) / from->area;
    if (whole->path == from->path) w->statistics.penumbra = penumbra;
    bool agree = penumbra <= tolerance * (whole->area / from->area);
    for (int q = 0; q < 4; q++) {
        if (agree || depth == 1)
            column_add_subpatch(w, &quarter[q], &w->quarters[q], quarter[q].area / from->area);
        else
            shoot_quarters(w, from, &quarter[q], depth - 1, tolerance);
    }
}

/* Does something stand on the subpatch whose hemi-cube was drawn last, pass through it, or hang lower than a height
 * over it? A cluster is no plane: its own members are not in its way. */
static bool is_crossed(const column_worker *w, const subpatch *s, double height) {
    const clustering *c = s->cluster ? w->setup->mesh->clustering : NULL;
    const hemicube_floor floor = { .shape = &s->shape,
                                   .height = height,
                                   .group = c ? c->of_surface : NULL,
                                   .own = c ? c->of_patch[s->patch] : NO_INDEX };
    return hemicube_is_crossed(&w->cube, w->setup->scene, w->setup->triangle_surface, &floor);
}

/* Does anything, so that what the eye sees is not what the whole subpatch sees? */
static bool is_crowded(const column_worker *w, const subpatch *s) {
    return is_crossed(w, s, TOLERANCE_LOW * s->edge);
}

/* A subpatch whose eye is inside something may still have a strip outside, next to what stands there, which it then
 * lights too little: such subpatches are quartered this much further. */
enum { DEPTH_INSIDE = 2 };

/* Quarters a subpatch that something stands on until its quarters are clear of it, and leaves out those inside. Returns
 * the share of the shooter's area that is not inside. */
static double shoot_around(column_worker *w, const subpatch *from, const subpatch *whole, int depth) {
    subpatch quarter[4];
    double clear = 0.0, share = 0.25 * (whole->area / from->area);
    subpatch_quarter(whole, quarter);
    for (int q = 0; q < 4; q++) {
        column_open_subpatch(w, &quarter[q], &w->quarters[0]);
        bool inside = w->quarters[0].closure.back > TOLERANCE_BURIED;
        if (depth > (inside ? 1 - DEPTH_INSIDE : 1) && is_crowded(w, &quarter[q])) {
            clear += shoot_around(w, from, &quarter[q], depth - 1);
        } else if (!inside) {
            column_shoot_subpatch(w, &quarter[q], &w->quarters[0]);
            column_add_subpatch(w, &quarter[q], &w->quarters[0], share);
            clear += share;
        }
    }
    return clear;
}

/* By how much the shooter gives away more than its hemi-cube sees [Baum89, eq. 10]. */
static double excess_of(const subpatch *from, const subpatch_factors *f) {
    return f->received / from->area - f->closure.front;
}

/* A whole patch that is no emitter: one hemi-cube; quarters if something stands on it, or if it gives away too much.
 * The radiosity of a patch is the mean over its whole area, and what is inside something has none: what is clear of it
 * shoots the power of all. */
static void shoot_patch(column_worker *w, const subpatch *from) {
    subpatch_factors *whole = &w->quarters[0];
    int depth = w->setup->patch_depth;
    column_open_subpatch(w, from, whole);
    bool crossed = is_crossed(w, from, 0.0);
    w->statistics.crossed = crossed || 1.0 - whole->closure.back < TOLERANCE_ENCLOSED;
    w->statistics.split = depth > 0 && (crossed || is_crowded(w, from));
    if (w->statistics.split) {
        double clear = shoot_around(w, from, from, depth + 1);
        if (clear > 0.0) column_scale_sums(w, 1.0 / clear);
        return;
    }
    column_shoot_subpatch(w, from, whole);
    w->statistics.split = depth > 0 && excess_of(from, whole) > TOLERANCE_CLOSURE_EXCESS;
    if (w->statistics.split) {
        shoot_quarters(w, from, from, depth, TOLERANCE_CLOSURE_EXCESS);
        return;
    }
    if (w->setup->keep_cubes) column_keep_cube(w);
    column_add_subpatch(w, from, whole, 1.0);
}

/* A cluster: one hemi-cube does, or none. */
static void shoot_cluster(column_worker *w, const subpatch *from) {
    subpatch_factors *whole = &w->quarters[0];
    column_open_subpatch(w, from, whole);
    bool inside = whole->closure.back > TOLERANCE_BURIED;
    w->statistics.crowded = inside || is_crossed(w, from, 0.0) || is_crowded(w, from);
    if (w->statistics.crowded) return;
    column_shoot_subpatch(w, from, whole);
    w->statistics.crowded = excess_of(from, whole) > TOLERANCE_CLOSURE_EXCESS;
    if (w->statistics.crowded) {
        column_forget_reached(w);
        return;
    }
    if (w->setup->keep_cubes) column_keep_cube(w);
    column_add_subpatch(w, from, whole, 1.0);
}

void subdivision_shoot(column_worker *w, const subpatch *from) {
    if (from->emits && w->setup->light_depth > 0) {
        w->statistics.split = true;
        shoot_quarters(w, from, from, w->setup->light_depth, w->setup->light_tolerance);
    } else if (from->cluster) {
        shoot_cluster(w, from);
    } else {
        shoot_patch(w, from);
    }
}

/* ---- several shooters ---- */

bool subdivision_is_possible(const shooters *s, uint32_t index) {
    const shooter *one = &s->all[index];
    uint32_t elements = s->mesh->patches[one->subpatch.patch].element_count;
    return shooter_is_whole(one) && shooter_depth(one) < SUBDIVISION_DEPTH && elements >= 4u << 2 * shooter_depth(one);
}

bool subdivision_by_gradient(const shooters *s, uint32_t index, const double *B) {
    const patch *p = &s->mesh->patches[s->all[index].subpatch.patch];
    double low = INFINITY, high = 0.0, sum = 0.0, area = 0.0;
    for (uint32_t k = 0; k < p->sample_count; k++) {
        if (index >= s->mesh->patch_count && s->of_sample[p->first_sample + k] != index) continue;
        double one = B[3 * k] + B[3 * k + 1] + B[3 * k + 2], weight = s->mesh->sample_area[p->first_sample + k];
        low = fmin(low, one);
        high = fmax(high, one);
        sum += weight * one;
        area += weight;
    }
    return area > 0.0 && high - low > SUBDIVISION_GRADIENT * sum / area;
}

bool subdivision_by_factor(const column *c) {
    return c->largest > 1.0;
}

/* How far inside a convex polygon a point of its plane is: the least distance to an edge, negative outside. */
static double depth_inside(const polygon *shape, const double normal[3], const double point[3]) {
    double least = INFINITY;
    for (int i = 0; i < shape->count; i++) {
        double edge[3], inward[3], offset[3];
        vec3_sub(edge, shape->corner[(i + 1) % shape->count], shape->corner[i]);
        vec3_cross(inward, normal, edge);
        vec3_sub(offset, point, shape->corner[i]);
        if (vec3_normalize(inward) > 0.0) least = fmin(least, vec3_dot(inward, offset));
    }
    return least;
}

static int quarter_of(const subpatch quarter[4], const double normal[3], const double point[3]) {
    int best = 0;
    double deepest = -INFINITY;
    for (int q = 0; q < 4; q++) {
        double depth = depth_inside(&quarter[q].shape, normal, point);
        if (depth > deepest) deepest = depth, best = q;
    }
    return best;
}

static bool reserve(shooters *s) {
    if (!s->of_sample) {
        s->of_sample = block_new(s->mesh->memory, (s->mesh->sample_count + 1) * sizeof *s->of_sample);
        if (!s->of_sample) return false;
        for (size_t p = 0; p < s->mesh->patch_count; p++)
            for (uint32_t k = 0; k < s->mesh->patches[p].sample_count; k++)
                s->of_sample[s->mesh->patches[p].first_sample + k] = (uint32_t)p;
    }
    size_t wanted = s->count + 4 > s->capacity ? 2 * s->capacity + 4 : s->capacity;
    return block_reserve(s->mesh->memory, (void **)&s->all, &s->capacity, wanted, sizeof *s->all);
}

/* Hands the samples of a shooter to its quarters: their areas, and the radiosity that goes with them. */
static void share_samples(shooters *s, uint32_t index, const subpatch quarter[4], const double *radiosity,
                          double power[4][3]) {
    const patch *p = &s->mesh->patches[s->all[index].subpatch.patch];
    const double *normal = s->scene->surfaces[p->surface].normal;
    for (uint32_t k = 0; k < p->sample_count; k++) {
        uint32_t i = p->first_sample + k;
        if (s->of_sample[i] != index) continue;
        int q = quarter_of(quarter, normal, (double[]){ s->mesh->x[i], s->mesh->y[i], s->mesh->z[i] });
        s->of_sample[i] = s->all[index].quarters[q];
        s->all[s->of_sample[i]].subpatch.area += s->mesh->sample_area[i];
        for (int c = 0; c < 3; c++) power[q][c] += s->mesh->sample_area[i] * radiosity[3 * (size_t)k + c];
    }
}

bool subdivision_quarter(shooters *s, uint32_t index, const double *radiosity) {
    subpatch quarter[4];
    double power[4][3] = { 0 };
    if (!reserve(s)) return false;
    shooter *whole = &s->all[index];
    subpatch_quarter(&whole->subpatch, quarter);
    for (int q = 0; q < 4; q++) {
        whole->quarters[q] = (uint32_t)s->count;
        s->all[s->count] = (shooter){ .subpatch = quarter[q], .quarters = { NO_INDEX } };
        s->all[s->count++].subpatch.area = 0.0; /* until it gets its samples */
    }
    share_samples(s, index, quarter, radiosity, power);
    for (int c = 0; c < 3; c++) {
        double all = power[0][c] + power[1][c] + power[2][c] + power[3][c];
        double unshot = whole->unshot[c] * whole->subpatch.area;
        for (int q = 0; q < 4; q++) {
            shooter *one = &s->all[whole->quarters[q]];
            double share = all > 0.0 ? power[q][c] / all : one->subpatch.area / whole->subpatch.area;
            if (one->subpatch.area > 0.0) one->unshot[c] = unshot * share / one->subpatch.area;
        }
        whole->unshot[c] = 0.0;
    }
    shooter_drop_column(whole);
    return true;
}
