/* SPDX-License-Identifier: MIT */
#include "geometry/light_walk.h"

#include "base/splitmix.h"
#include "geometry/even_points.h"
#include "geometry/triangle.h"

/* Walls that a path meets. With 64 paths 0.2 % of the walls that are open are found all but always. */
enum { WALLS_MAX = 32 };

/* How far off its wall a path goes on, of how far it came, and of how far the place is from the origin: more than
 * roundings of doubles. */
static const double LIFT = 1e-7, LIFT_AT = 1e-9;

void light_walk_begin(light_walk *w, const triangle_bvh *tree, double narrow) {
    *w = (light_walk){ .tree = tree, .narrow = narrow };
    for (int k = 0; k < 3; k++) w->low[k] = INFINITY, w->high[k] = -INFINITY;
}

static void extend(light_walk *w, const double point[3]) {
    for (int k = 0; k < 3; k++) w->low[k] = fmin(w->low[k], point[k]), w->high[k] = fmax(w->high[k], point[k]);
}

void light_walk_edges(const light_walk *w, double *least, double *diagonal) {
    double edge[3];
    for (int k = 0; k < 3; k++) edge[k] = fmax(w->high[k] - w->low[k], 0.0);
    *least = fmin(edge[0], fmin(edge[1], edge[2]));
    *diagonal = vec3_length(edge);
}

/* off: of the way that was gone, m. */
static void lift(double point[3], const double normal[3], double off) {
    double far = fmax(fabs(point[0]), fmax(fabs(point[1]), fabs(point[2])));
    vec3_add_scaled(point, point, LIFT * off + LIFT_AT * far, normal);
}

static void normal_of(const double p[3][3], double out[3]) {
    triangle_cross(out, p[0], p[1], p[2]);
    vec3_normalize(out);
}

bool light_walk_start(const double corner[3][3], size_t i, double from[3], double direction[3]) {
    double weights[3], normal[3];
    normal_of(corner, normal);
    if (vec3_is_zero(normal)) return false;
    even_weights(weights, even_point(i, 0), even_point(i, 1));
    for (int k = 0; k < 3; k++)
        from[k] = weights[0] * corner[0][k] + weights[1] * corner[1][k] + weights[2] * corner[2][k];
    lift(from, normal, 0.0);
    even_direction(direction, normal, even_point(i, 2), even_point(i, 3));
    return true;
}

/* To the next wall, and off it by the cosine. False: there is none. */
static bool step(light_walk *w, double at[3], double direction[3], uint64_t seed) {
    double length = 2.1 * w->tree->radius + vec3_distance(at, w->tree->center), to[3], normal[3];
    triangle_meeting met;
    vec3_add_scaled(to, at, length, direction);
    if (!triangle_bvh_meet(w->tree, at, to, false, NULL, &met)) return false;
    const double(*p)[3] = w->tree->corners[met.triangle];
    for (int k = 0; k < 3; k++) at[k] = met.weights[0] * p[0][k] + met.weights[1] * p[1][k] + met.weights[2] * p[2][k];
    normal_of(p, normal);
    for (int k = 0; k < 3 && !met.is_front; k++) normal[k] = -normal[k];
    w->last = met.triangle;
    extend(w, at);
    lift(at, normal, met.share * length);
    even_direction(direction, normal, splitmix_unit(2 * seed), splitmix_unit(2 * seed + 1));
    return true;
}

bool light_walk_gets_out(light_walk *w, const double from[3], const double direction[3], uint64_t seed) {
    double at[3], along[3], least, diagonal;
    vec3_copy(at, from);
    vec3_copy(along, direction);
    for (uint64_t i = 0; i < WALLS_MAX; i++) {
        if (!step(w, at, along, splitmix(seed) + i)) return true;
        light_walk_edges(w, &least, &diagonal);
        if (least > w->narrow) return true;
    }
    return false;
}
