/* SPDX-License-Identifier: MIT */
#include "geometry/polygon.h"

#include "geometry/edge_angle.h"
#include "geometry/plane.h"
#include "geometry/triangle.h"
#include "geometry/vec3.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

static void polygon_push(polygon *p, const double corner[3]) {
    if (p->count < POLYGON_CORNERS_MAX) vec3_copy(p->corner[p->count++], corner);
}

void polygon_clip(polygon *out, const polygon *in, const double normal[3], double plane) {
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        const double *a = in->corner[i], *b = in->corner[(i + 1) % in->count];
        double height_a = plane_height(normal, plane, a), height_b = plane_height(normal, plane, b);
        if (height_a >= 0.0) polygon_push(out, a);
        if ((height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0)) {
            double edge[3], cut[3];
            vec3_sub(edge, b, a);
            vec3_add_scaled(cut, a, height_a / (height_a - height_b), edge);
            polygon_push(out, cut);
        }
    }
}

/* ---- the factor ---- */

/* The error of a term is at most this many DBL_EPSILON / 2 of its bound: four roundings of each factor of a cross
 * product's six terms, three of a dot product, fewer than ten of the angle. */
static const double TERM_ROUNDINGS = 8.0;

/* Above this bound, relative to the value, the sum is done again with more digits: half of what is promised. */
static const double ERROR_ACCEPTED = 5e-11;

/* Below this sine of the angle between a ray and the polygon's plane the point may lie in the plane; the digits that a
 * double has left then do not tell on which side. */
static const double IN_PLANE_SUSPECTED = 1e-12;

/* From the point to a corner, or to where an edge crosses the horizon (corner = NULL). */
typedef struct ray {
    double v[3], height, length;
    double error; /* of v, in roundings */
    const double *corner;
} ray;

typedef struct edge_sum {
    double value, error; /* error in roundings */
    ray first, last;
    bool begun;
} edge_sum;

static ray ray_to(const double corner[3], const double point[3], const double normal[3]) {
    ray r = { .corner = corner };
    vec3_sub(r.v, corner, point);
    r.height = vec3_dot(normal, r.v);
    r.length = r.error = vec3_length(r.v);
    return r;
}

static ray ray_cut(const ray *a, const ray *b) {
    ray cut = { .height = 0.0 };
    for (int k = 0; k < 3; k++) cut.v[k] = a->v[k] + a->height / (a->height - b->height) * (b->v[k] - a->v[k]);
    cut.length = vec3_length(cut.v);
    cut.error = 4.0 * (a->length + b->length);
    return cut;
}

/* The difference of two corners is exact to a rounding of its own; that of their rays only to one of theirs. Returns
 * its error. */
static double edge_between(double edge[3], const ray *a, const ray *b) {
    bool corners = a->corner && b->corner;
    vec3_sub(edge, corners ? b->corner : b->v, corners ? a->corner : a->v);
    return corners ? vec3_length(edge) : a->error + b->error;
}

/* n . Gamma of one edge, with the nearer end in the cross product. Through a corner nothing is seen; an edge through
 * the point itself has no direction, so its error is without bound, as that of a corner there is, in whose plane the
 * point lies. */
static void add_edge(edge_sum *sum, const ray *a, const ray *b, const double normal[3]) {
    double edge[3], cross[3], edge_error = edge_between(edge, a, b);
    const ray *near = a->length < b->length ? a : b;
    vec3_cross(cross, near->v, edge);
    double c = vec3_dot(a->v, b->v), r = a->length * b->length;
    if (r == 0.0) {
        sum->error = INFINITY;
        return;
    }
    double ratio = edge_angle_over_sine(fmin(fabs(c) / r, 1.0)) / r;
    if (c < 0.0) ratio = PI / vec3_length(cross) - ratio;
    double term = vec3_dot(normal, cross) * ratio, relative = a->error / a->length + b->error / b->length;
    sum->value += term;
    sum->error += ratio * (near->length * edge_error + vec3_length(edge) * near->error) + fabs(term) * relative;
}

static void walk_to(edge_sum *sum, const ray *r, const double normal[3]) {
    if (sum->begun)
        add_edge(sum, &sum->last, r, normal);
    else
        sum->first = *r;
    sum->last = *r;
    sum->begun = true;
}

/* Cuts edge by edge at the horizon, as Sutherland & Hodgman; what lies on the horizon closes the loop. Returns whether
 * anything may lie above it. */
static bool sum_edges(edge_sum *sum, polygon_loop loop, const double point[3], const double normal[3]) {
    bool any = false;
    ray a = ray_to(loop.corner[loop.count - 1], point, normal);
    for (size_t i = 0; i < loop.count; i++) {
        ray b = ray_to(loop.corner[i], point, normal);
        if ((a.height > 0.0 && b.height < 0.0) || (a.height < 0.0 && b.height > 0.0)) {
            ray cut = ray_cut(&a, &b);
            walk_to(sum, &cut, normal);
        }
        if (b.height >= 0.0) walk_to(sum, &b, normal);
        any = any || !(b.height + TERM_ROUNDINGS * DBL_EPSILON * b.length <= 0.0);
        a = b;
    }
    if (sum->begun) add_edge(sum, &sum->last, &sum->first, normal);
    return any;
}

static bool may_be_in_plane(polygon_loop loop, const double point[3]) {
    double area[3], r[3];
    polygon_loop_vector_area(loop, area);
    vec3_sub(r, loop.corner[0], point);
    double sine = vec3_dot(area, r), bound = IN_PLANE_SUSPECTED;
    return !(sine * sine > bound * bound * vec3_dot(area, area) * vec3_dot(r, r));
}

double polygon_loop_factor(polygon_loop loop, const double point[3], const double normal[3]) {
    if (loop.count < 3) return 0.0;
    edge_sum sum = { .value = 0.0 };
    if (!sum_edges(&sum, loop, point, normal)) return 0.0;
    double bound = TERM_ROUNDINGS * DBL_EPSILON * sum.error;
    bool good = isfinite(sum.value) && bound <= ERROR_ACCEPTED * fabs(sum.value);
    if (!good || may_be_in_plane(loop, point)) return polygon_loop_factor_exact(loop, point, normal);
    /* Seen from its front a polygon runs clockwise about the line of sight, so its sum is negative. */
    return -sum.value / (2.0 * PI);
}

double polygon_factor(const polygon *p, const double point[3], const double normal[3]) {
    return polygon_loop_factor(polygon_boundary(p), point, normal);
}

/* ---- shape ---- */

void polygon_quarter(const polygon *p, polygon quarter[4]) {
    double mid[4][3], center[3] = { 0, 0, 0 };
    int n = p->count;
    for (int i = 0; i < n; i++) vec3_mid(mid[i], p->corner[i], p->corner[(i + 1) % n]);
    for (int q = 0; q < 4; q++) quarter[q].count = 0;
    if (n == 4) vec3_mid(center, mid[0], mid[2]);
    for (int i = 0; i < n; i++) {
        polygon_push(&quarter[i], p->corner[i]);
        polygon_push(&quarter[i], mid[i]);
        if (n == 4) polygon_push(&quarter[i], center);
        polygon_push(&quarter[i], mid[(i + n - 1) % n]);
    }
    for (int i = 0; n == 3 && i < 3; i++) polygon_push(&quarter[3], mid[i]);
}

void polygon_loop_vector_area(polygon_loop loop, double out[3]) {
    out[0] = out[1] = out[2] = 0.0;
    for (size_t i = 1; i + 1 < loop.count; i++) {
        double n[3];
        triangle_cross(n, loop.corner[0], loop.corner[i], loop.corner[i + 1]);
        vec3_add_scaled(out, out, 0.5, n);
    }
}

void polygon_vector_area(const polygon *p, double out[3]) {
    polygon_loop_vector_area(polygon_boundary(p), out);
}

double polygon_centroid(const polygon *p, double out[3]) {
    double total = 0.0, moment[3] = { 0, 0, 0 };
    for (int i = 1; i + 1 < p->count; i++) {
        double u[3], v[3], n[3];
        vec3_sub(u, p->corner[i], p->corner[0]);
        vec3_sub(v, p->corner[i + 1], p->corner[0]);
        vec3_cross(n, u, v);
        double area = 0.5 * vec3_length(n);
        for (int k = 0; k < 3; k++) moment[k] += area * (u[k] + v[k]) / 3.0;
        total += area;
    }
    vec3_copy(out, p->corner[0]);
    if (total > 0.0) vec3_add_scaled(out, p->corner[0], 1.0 / total, moment);
    return total;
}
