/* SPDX-License-Identifier: MIT
 * What does the closed form of polygon.h give where doubles are too short for it? The steps are those of
 * polygon.c; differences of coordinates are exact here.
 */
#include "geometry/polygon.h"

#include "geometry/double_double.h"

#include <stdbool.h>

/* Each term is good to this many DD_EPSILON of the bound that goes with it: some thirty operations. */
static const double TERM_ROUNDINGS = 32.0;

/* A point is in one plane with a loop when no corner is further from its plane than this, relative to the corner's
 * distance and to what its area is made of: what thirty operations leave of an exact 0. */
static const double IN_PLANE = 32.0 * DD_EPSILON;

typedef struct ray {
    dd v[3], height, length;
    double error; /* of v, in DD_EPSILON; a corner's is in the bound of its terms */
} ray;

typedef struct edge_sum {
    dd value;
    double error; /* in DD_EPSILON */
    ray first, last;
    bool begun;
} edge_sum;

static bool all_finite(const double a[3]) {
    return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]);
}

/* 2^-e with e the exponent of the largest coordinate seen from the point; 0 if there is none. */
static double unit_of(polygon_loop loop, const double point[3]) {
    double largest = 0.0;
    for (size_t i = 0; i < loop.count; i++) {
        if (!all_finite(loop.corner[i])) return 0.0;
        for (int k = 0; k < 3; k++) largest = fmax(largest, fabs(loop.corner[i][k] - point[k]));
    }
    int exponent = 0;
    frexp(largest, &exponent);
    double unit = ldexp(1.0, -exponent);
    return largest > 0.0 && isfinite(largest) && isfinite(unit) ? unit : 0.0;
}

static void difference(dd out[3], const double a[3], const double b[3], double unit) {
    for (int k = 0; k < 3; k++) {
        dd d = dd_two_sum(a[k], -b[k]);
        out[k] = (dd){ d.hi * unit, d.lo * unit };
    }
}

static ray ray_to(const double corner[3], const double point[3], const dd normal[3], double unit) {
    ray r = { .error = 0.0 };
    difference(r.v, corner, point, unit);
    r.height = dd_dot(normal, r.v);
    r.length = dd_sqrt(dd_dot(r.v, r.v));
    return r;
}

static ray ray_cut(const ray *a, const ray *b) {
    ray cut = { .height = dd_of(0.0), .error = a->length.hi + b->length.hi };
    dd t = dd_div(a->height, dd_sub(a->height, b->height));
    for (int k = 0; k < 3; k++) cut.v[k] = dd_add(a->v[k], dd_mul(t, dd_sub(b->v[k], a->v[k])));
    cut.length = dd_sqrt(dd_dot(cut.v, cut.v));
    return cut;
}

/* atan(t) / t for z = t^2 in [0, 1]. Four times atan t = 2 atan(t / (1 + sqrt(1 + t^2))); then z < 0.0025, and what
 * is left of the series after 14 terms is z^14 / 29 = 1e-38. */
static dd angle_over_tangent(dd z) {
    dd factor = dd_of(1.0);
    for (int i = 0; i < 4; i++) {
        dd w = dd_add(dd_of(1.0), dd_sqrt(dd_add(dd_of(1.0), z)));
        factor = dd_div(dd_scale(factor, 2.0), w);
        z = dd_div(z, dd_mul(w, w));
    }
    dd sum = dd_of(0.0);
    for (int k = 13; k >= 0; k--) sum = dd_sub(dd_div(dd_of(1.0), dd_of(2.0 * k + 1.0)), dd_mul(z, sum));
    return dd_mul(factor, sum);
}

/* The angle over its sine of edge_angle.h. */
static dd angle_ratio(dd r, dd c, const dd cross[3]) {
    static const dd pi = { 3.141592653589793116, 1.224646799147353207e-16 };
    bool obtuse = c.hi < 0.0;
    if (obtuse) c = dd_negate(c);
    dd sum = dd_add(r, c), z = dd_div(dd_sub(r, c), sum);
    dd ratio = dd_div(dd_scale(angle_over_tangent(z), 2.0), sum);
    if (!obtuse) return ratio;
    dd sine = dd_sqrt(dd_dot(cross, cross));
    return sine.hi > 0.0 ? dd_sub(dd_div(pi, sine), ratio) : dd_of(0.0);
}

static void add_edge(edge_sum *sum, const ray *a, const ray *b, const dd normal[3]) {
    dd edge[3], cross[3];
    for (int k = 0; k < 3; k++) edge[k] = dd_sub(b->v[k], a->v[k]);
    const ray *near = a->length.hi < b->length.hi ? a : b;
    dd_cross(cross, near->v, edge);
    dd r = dd_mul(a->length, b->length), c = dd_dot(a->v, b->v);
    if (!(r.hi + fabs(c.hi) > 0.0)) return;
    dd ratio = angle_ratio(r, c, cross);
    sum->value = dd_add(sum->value, dd_mul(dd_dot(normal, cross), ratio));
    double size = sqrt(dd_dot(edge, edge).hi);
    sum->error += ratio.hi * (near->length.hi * (size + a->error + b->error) + size * near->error);
}

static void walk_to(edge_sum *sum, const ray *r, const dd normal[3]) {
    if (sum->begun)
        add_edge(sum, &sum->last, r, normal);
    else
        sum->first = *r;
    sum->last = *r;
    sum->begun = true;
}

/* The sum of cross products, and into *terms that of the sizes of what they are made of: a sliver has little area of
 * long edges. */
static void vector_area(polygon_loop loop, double unit, dd out[3], double *terms) {
    *terms = 0.0;
    for (int k = 0; k < 3; k++) out[k] = dd_of(0.0);
    for (size_t i = 1; i + 1 < loop.count; i++) {
        dd u[3], v[3], n[3];
        difference(u, loop.corner[i], loop.corner[0], unit);
        difference(v, loop.corner[i + 1], loop.corner[0], unit);
        dd_cross(n, u, v);
        for (int k = 0; k < 3; k++) out[k] = dd_add(out[k], n[k]);
        *terms += sqrt(dd_dot(u, u).hi * dd_dot(v, v).hi);
    }
}

static bool is_in_one_plane(polygon_loop loop, const double point[3], double unit) {
    dd area[3];
    double terms;
    vector_area(loop, unit, area, &terms);
    for (size_t i = 0; i < loop.count; i++) {
        ray r = ray_to(loop.corner[i], point, area, unit);
        if (fabs(r.height.hi) > IN_PLANE * terms * r.length.hi) return false;
    }
    return dd_dot(area, area).hi > 0.0;
}

double polygon_loop_factor_exact(polygon_loop loop, const double point[3], const double normal[3]) {
    if (loop.count < 3 || !all_finite(point) || !all_finite(normal)) return 0.0;
    double unit = unit_of(loop, point);
    if (!(unit > 0.0) || is_in_one_plane(loop, point, unit)) return 0.0;
    dd n[3] = { dd_of(normal[0]), dd_of(normal[1]), dd_of(normal[2]) };
    edge_sum sum = { .error = 0.0 };
    double top = 0.0;
    ray a = ray_to(loop.corner[loop.count - 1], point, n, unit);
    for (size_t i = 0; i < loop.count; i++) {
        ray b = ray_to(loop.corner[i], point, n, unit);
        if ((a.height.hi > 0.0 && b.height.hi < 0.0) || (a.height.hi < 0.0 && b.height.hi > 0.0)) {
            ray cut = ray_cut(&a, &b);
            walk_to(&sum, &cut, n);
        }
        if (b.height.hi >= 0.0) walk_to(&sum, &b, n);
        top = fmax(top, b.height.hi);
        a = b;
    }
    if (!(top > 0.0)) return 0.0;
    add_edge(&sum, &sum.last, &sum.first, n);
    if (!(fabs(sum.value.hi) > TERM_ROUNDINGS * DD_EPSILON * sum.error)) return 0.0;
    return -sum.value.hi / 6.28318530717958647692;
}
