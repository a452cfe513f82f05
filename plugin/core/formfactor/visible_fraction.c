/* SPDX-License-Identifier: MIT
 * See visible_fraction.h.
 */
#include "formfactor/visible_fraction.h"

#include "base/tolerance.h"
#include "formfactor/shadow_integral.h"
#include "geometry/vec3.h"
#include "visibility/visible_part.h"

#include <float.h>

/* How often a shooter is quartered when its visible fragments outgrow their room. Each time the blockers that a quarter
 * shares with the whole about halve. */
enum { QUARTERINGS_MAX = 5 };

/* A shadow that lies between the points of a cell is not seen. A quad has 14 points inside; so what is hidden in one
 * cell of n weighs less than about 1 / (14 n), which is added to the error, and n is so large that this is at most half
 * of the tolerance. */
static const double CELL_SHARE = 1.0 / 14.0;
enum { CELL_DEPTH_LEAST = 1, CELL_DEPTH_MOST = 8 };

/* A closed form is good to 1e-11 of itself (polygon.h), and there may be some dozens of fragments, cut at edges that
 * have roundings of their own. */
static const double FRAGMENTS_ERROR = 1e-10;

/* Blockers are cut off this close above the two planes (TOLERANCE_PLANE of the radius), so light leaks under what
 * stands on one of them. Through a slit at the foot of a blocker of the scene's size passes as much of the factor; for
 * blockers down to a tenth of it: */
static const double FOOT_ERROR = 10.0 * TOLERANCE_PLANE;

/* The shooter above a receiver's plane, the receiver above the shooter's, and what may stand between them. */
typedef struct sight {
    polygon shooter, receiver;
    double shooter_normal[3], receiver_normal[3];
    double margin;
    blocker_list blockers;
    bool blocked;      /* for seen_from: whether blockers count */
    bool lost, failed; /* fragments; out of memory */
} sight;

static void surface_polygon(const scene *s, const surface *f, polygon *out) {
    out->count = surface_corner_count(f);
    for (int i = 0; i < out->count; i++) vec3_copy(out->corner[i], scene_vertex(s, f->corner[i]));
}

/* surfaces: which ones, or NULL for all. */
static bool collect_blockers(sight *g, const scene *s, const uint32_t *surfaces, size_t count) {
    facing_pair pair = { .a = &g->receiver, .b = &g->shooter, .margin = g->margin };
    pair.normal_a = g->receiver_normal, pair.plane_a = vec3_dot(g->receiver_normal, g->receiver.corner[0]);
    pair.normal_b = g->shooter_normal, pair.plane_b = vec3_dot(g->shooter_normal, g->shooter.corner[0]);
    for (size_t k = 0; k < (surfaces ? count : s->surface_count); k++) {
        uint32_t i = surfaces ? surfaces[k] : (uint32_t)k;
        const surface *f = &s->surfaces[i];
        polygon shape;
        if (surface_sheet(s, i) != i) continue;
        surface_polygon(s, f, &shape);
        if (!blocker_list_add(&g->blockers, &pair, &shape, f->normal, f->plane)) return false;
    }
    return true;
}

/* Cuts both polygons to what is above the other's plane. False if nothing is. */
static bool face_each_other(sight *g, const scene *s, const polygon *shooter, const polygon *receiver) {
    polygon_vector_area(shooter, g->shooter_normal);
    if (vec3_normalize(g->shooter_normal) == 0.0) return false;
    g->margin = TOLERANCE_PLANE * s->radius;
    double plane = vec3_dot(g->shooter_normal, shooter->corner[0]);
    double receiver_plane = vec3_dot(g->receiver_normal, receiver->corner[0]);
    polygon_clip(&g->shooter, shooter, g->receiver_normal, receiver_plane);
    polygon_clip(&g->receiver, receiver, g->shooter_normal, plane);
    return g->shooter.count >= 3 && g->receiver.count >= (receiver->count < 3 ? 1 : 3);
}

/* ---- at a point ----------------------------------------------------------------------------------------------------
 */

static double visible_part_factor(sight *g, const polygon *part, const double point[3], int quarterings) {
    bool lost = false;
    polygon quarter[4];
    double factor = visible_factor(&g->blockers, part, point, g->receiver_normal, g->margin, &lost);
    if (!lost) return factor;
    if (quarterings == 0) {
        g->lost = true;
        return factor;
    }
    polygon_quarter(part, quarter);
    factor = 0.0;
    for (int q = 0; q < 4; q++) factor += visible_part_factor(g, &quarter[q], point, quarterings - 1);
    return factor;
}

static double seen_from(void *user, const double point[3]) {
    sight *g = user;
    const polygon *p = &g->shooter;
    if (!g->blocked || g->blockers.count == 0) return polygon_factor(p, point, g->receiver_normal);
    if (p->count <= 4) return visible_part_factor(g, p, point, QUARTERINGS_MAX);
    double sum = 0.0;
    for (int i = 1; i + 1 < p->count; i++) {
        polygon triangle = { .count = 3 };
        vec3_copy(triangle.corner[0], p->corner[0]);
        vec3_copy(triangle.corner[1], p->corner[i]);
        vec3_copy(triangle.corner[2], p->corner[i + 1]);
        sum += visible_part_factor(g, &triangle, point, QUARTERINGS_MAX);
    }
    return sum;
}

/* From F with and without blockers and their errors. Fragments that were lost count as seen, so that their error is at
 * most all of the factor. */
static void conclude(const sight *g, double tolerance, double unoccluded_error, visible_fraction *out) {
    if (out->unoccluded <= 0.0) {
        *out = (visible_fraction){ .evaluations = out->evaluations, .converged = true };
        return;
    }
    out->factor_error += FRAGMENTS_ERROR * out->unoccluded;
    if (g->blockers.count > 0) out->factor_error += FOOT_ERROR * out->unoccluded;
    if (g->lost) out->factor_error = fmax(out->factor_error, out->factor);
    out->fraction = fmin(out->factor / out->unoccluded, 1.0);
    out->error = (out->factor_error + out->fraction * unoccluded_error) / out->unoccluded;
    out->converged = out->error <= tolerance;
}

bool visible_fraction_at_point(const scene *s, const polygon *shooter, const double point[3], const double normal[3],
                               visible_fraction *out) {
    return visible_fraction_among(s, NULL, 0, shooter, point, normal, out);
}

bool visible_fraction_among(const scene *s, const uint32_t *surfaces, size_t count, const polygon *shooter,
                            const double point[3], const double normal[3], visible_fraction *out) {
    sight g = { .blocked = false, .blockers.memory = s->memory };
    polygon at = { .count = 1 };
    bool ok = true;
    *out = (visible_fraction){ .evaluations = 1, .converged = true };
    vec3_copy(at.corner[0], point);
    vec3_copy(g.receiver_normal, normal);
    if (face_each_other(&g, s, shooter, &at)) {
        ok = collect_blockers(&g, s, surfaces, count);
        out->unoccluded = seen_from(&g, point);
        g.blocked = true;
        out->factor = g.blockers.count ? seen_from(&g, point) : out->unoccluded;
        conclude(&g, INFINITY, 0.0, out);
    }
    blocker_list_free(&g.blockers);
    return ok;
}

/* ---- over an element -----------------------------------------------------------------------------------------------
 */

/* What there is left to spend, and what came of what was spent. */
typedef struct budget {
    double tolerance, area; /* m2, m2 */
    double evaluations;
    shadow_integral sum;
    bool out_of_memory;
} budget;

static double polygon_area(const polygon *p) {
    double area_vector[3];
    polygon_vector_area(p, area_vector);
    return vec3_length(area_vector);
}

/* A region's share of the budget is that of its area; what it leaves is for the next. */
static void spend(sight *g, const polygon *region, budget *b) {
    double area = polygon_area(region), share = fmin(area / b->area, 1.0);
    uint64_t limit = (uint64_t)(share * fmax(b->evaluations, 0.0));
    shadow_integral part = shadow_integrate(region, seen_from, g, share * b->tolerance, limit, g->blockers.memory);
    b->sum.value += part.value;
    b->sum.error += part.error;
    b->sum.evaluations += part.evaluations;
    b->tolerance -= part.error;
    b->evaluations -= (double)part.evaluations;
    b->area = fmax(b->area - area, DBL_MIN);
}

static bool filter_blockers(const sight *g, const polygon *region, const blocker_list *candidates, blocker_list *out) {
    facing_pair pair = { .a = region, .b = &g->shooter, .margin = g->margin };
    pair.normal_a = g->receiver_normal, pair.plane_a = vec3_dot(g->receiver_normal, region->corner[0]);
    pair.normal_b = g->shooter_normal, pair.plane_b = vec3_dot(g->shooter_normal, g->shooter.corner[0]);
    for (size_t i = 0; i < candidates->count; i++) {
        const blocker *c = &candidates->blockers[i];
        if (!blocker_list_add(out, &pair, &c->shape, c->normal, c->plane)) return false;
    }
    return true;
}

/* Quarters a region (triangle or quad) until nothing stands before it or the depth is reached. */
static void integrate_region(sight *g, const polygon *region, const blocker_list *candidates, int depth, budget *b) {
    blocker_list blockers = { .memory = g->blockers.memory };
    polygon quarter[4];
    if (!filter_blockers(g, region, candidates, &blockers)) {
        b->out_of_memory = true;
    } else if (depth == 0 || blockers.count == 0) {
        blocker_list all = g->blockers;
        g->blockers = blockers;
        spend(g, region, b);
        g->blockers = all;
    } else {
        polygon_quarter(region, quarter);
        for (int q = 0; q < 4; q++) integrate_region(g, &quarter[q], &blockers, depth - 1, b);
    }
    blocker_list_free(&blockers);
}

static void integrate_blocked(sight *g, int depth, budget *b) {
    const polygon *p = &g->receiver;
    if (p->count <= 4) {
        integrate_region(g, p, &g->blockers, depth, b);
        return;
    }
    for (int i = 1; i + 1 < p->count; i++) {
        polygon triangle = { .count = 3 };
        vec3_copy(triangle.corner[0], p->corner[0]);
        vec3_copy(triangle.corner[1], p->corner[i]);
        vec3_copy(triangle.corner[2], p->corner[i + 1]);
        integrate_region(g, &triangle, &g->blockers, depth, b);
    }
}

/* The least depth whose cells are small enough for the tolerance, if the evaluations suffice for three turns of
 * refinement in each. */
static int cell_depth(const visible_effort *effort, double *missed) {
    int depth = CELL_DEPTH_LEAST;
    double cells = 4.0;
    while (depth < CELL_DEPTH_MOST && CELL_SHARE / cells > 0.5 * effort->tolerance &&
           4.0 * cells * 3.0 / CELL_SHARE <= (double)effort->evaluation_limit)
        depth++, cells *= 4.0;
    *missed = CELL_SHARE / cells;
    return depth;
}

/* A twentieth of the tolerance goes to the integral without blockers, half to what cells miss, the rest to the integral
 * with blockers. */
static void integrate(sight *g, double area, const visible_effort *effort, visible_fraction *out) {
    uint64_t limit = effort->evaluation_limit;
    shadow_integral rough = shadow_integrate(&g->receiver, seen_from, g, INFINITY, limit, g->blockers.memory);
    shadow_integral all = shadow_integrate(&g->receiver, seen_from, g, 0.05 * effort->tolerance * rough.value,
                                           limit / 4, g->blockers.memory);
    shadow_integral seen = all;
    double missed = 0.0;
    out->evaluations = rough.evaluations + all.evaluations;
    if (g->blockers.count > 0) {
        int depth = cell_depth(effort, &missed);
        budget b = { .tolerance = (effort->tolerance - missed) * all.value - 2.0 * all.error,
                     .area = polygon_area(&g->receiver),
                     .evaluations = (double)limit - (double)out->evaluations };
        g->blocked = true;
        integrate_blocked(g, depth, &b);
        if (b.out_of_memory) g->failed = true;
        seen = b.sum;
        out->evaluations += seen.evaluations;
    }
    out->unoccluded = all.value / area;
    out->factor = seen.value / area;
    out->factor_error = seen.error / area + missed * out->unoccluded;
    conclude(g, effort->tolerance, all.error / area, out);
    if (g->blockers.count == 0) out->fraction = 1.0, out->error = 0.0, out->converged = true;
}

bool visible_fraction_of_element(const scene *s, const polygon *shooter, const polygon *element,
                                 const visible_effort *effort, visible_fraction *out) {
    sight g = { .blocked = false, .blockers.memory = s->memory };
    bool ok = true;
    *out = (visible_fraction){ .converged = true };
    polygon_vector_area(element, g.receiver_normal);
    double area = vec3_normalize(g.receiver_normal);
    if (area > 0.0 && face_each_other(&g, s, shooter, element)) {
        ok = collect_blockers(&g, s, NULL, 0);
        if (ok) integrate(&g, area, effort, out);
        ok = ok && !g.failed;
    }
    blocker_list_free(&g.blockers);
    return ok;
}
