/* SPDX-License-Identifier: MIT */
#include "factors/shadow_integral.h"

#include "geometry/triangle.h"
#include "geometry/vec3.h"

#include <string.h>

/* Evaluations of a triangle inside, and of the corners that quartering makes. */
enum { POINTS = 7, NEW_CORNERS = 3 };

/* The outermost point of the rule is 0.8 of the way to a corner; what is beyond a line that passes between both is less
 * than a tenth of the triangle on the side of an edge, and less at a corner. */
static const double CORNER_SHARE = 0.1;

/* place: three corners, each a point and the function there. */
enum { CORNER = 4, VALUE = 3 };

typedef struct integrand {
    shadow_integrand f;
    void *user;
} integrand;

static void set_corner(const integrand *g, double corner[CORNER], const double point[3]) {
    vec3_copy(corner, point);
    corner[VALUE] = g->f(g->user, point);
}

/* f at the point with weight w0 on corner i and w on the two others. */
static double value_inside(const integrand *g, const double *place, int i, double w0, double w) {
    const double *a = place + CORNER * i, *b = place + CORNER * ((i + 1) % 3), *d = place + CORNER * ((i + 2) % 3);
    double point[3];
    for (int k = 0; k < 3; k++) point[k] = w0 * a[k] + w * (b[k] + d[k]);
    return g->f(g->user, point);
}

/* The parabola through values at x[0..2], at 1. */
static double extrapolate(const double x[3], const double f[3]) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        double p = x[(i + 1) % 3], q = x[(i + 2) % 3];
        sum += f[i] * (1 - p) * (1 - q) / ((x[i] - p) * (x[i] - q));
    }
    return sum;
}

/* Mean over the triangle by centroid and the three points at w: exact for degree 2 when each of these weighs s with
 * (1 - 3 s) / 9 + s (2 w^2 + (1 - 2 w)^2) = 1/6. */
static double degree_two(double center, double sum, double w) {
    double second = 2 * w * w + (1 - 2 * w) * (1 - 2 * w);
    double s = (1.0 / 6.0 - 1.0 / 9.0) / (second - 1.0 / 3.0);
    return (1 - 3 * s) * center + s * sum;
}

static void evaluate(void *user, adaptive_piece *piece) {
    const integrand *g = user;
    const double root = sqrt(15.0), near = (6 - root) / 21, far = (6 + root) / 21;
    const double along[3] = { 1 - 2 * near, 1.0 / 3.0, 1 - 2 * far }; /* the median of a corner */
    const double *at = piece->place;
    double area = triangle_area(at, at + CORNER, at + 2 * CORNER), near_sum = 0.0, far_sum = 0.0, off = 0.0;
    double center = value_inside(g, piece->place, 0, 1.0 / 3.0, 1.0 / 3.0);
    for (int i = 0; i < 3; i++) {
        const double f[3] = { value_inside(g, piece->place, i, 1 - 2 * near, near), center,
                              value_inside(g, piece->place, i, 1 - 2 * far, far) };
        near_sum += f[0];
        far_sum += f[2];
        off = fmax(off, CORNER_SHARE * fabs(piece->place[CORNER * i + VALUE] - extrapolate(along, f)));
    }
    double mean = 0.225 * center + (155 - root) / 1200 * near_sum + (155 + root) / 1200 * far_sum;
    off = fmax(off, fabs(mean - degree_two(center, near_sum, near)));
    off = fmax(off, fabs(mean - degree_two(center, far_sum, far)));
    piece->value = area * mean;
    piece->error = area * off;
    piece->rounding = 0.0;
}

static void set_triangle(double *place, const double *a, const double *b, const double *c) {
    memcpy(place, a, CORNER * sizeof *place);
    memcpy(place + CORNER, b, CORNER * sizeof *place);
    memcpy(place + 2 * CORNER, c, CORNER * sizeof *place);
}

static int quarter(void *user, const double place[ADAPTIVE_PLACE], double parts[ADAPTIVE_CHILDREN][ADAPTIVE_PLACE]) {
    const double *a = place, *b = place + CORNER, *c = place + 2 * CORNER;
    double mid[3][CORNER];
    for (int i = 0; i < 3; i++) {
        double point[3];
        vec3_mid(point, place + CORNER * i, place + CORNER * ((i + 1) % 3));
        set_corner(user, mid[i], point);
    }
    set_triangle(parts[0], a, mid[0], mid[2]);
    set_triangle(parts[1], mid[0], b, mid[1]);
    set_triangle(parts[2], mid[2], mid[1], c);
    set_triangle(parts[3], mid[0], mid[1], mid[2]);
    return 4;
}

factor_estimate shadow_integrate(const polygon *shape, shadow_integrand f, void *user, double tolerance,
                                 uint64_t evaluation_limit, allocator *memory) {
    integrand g = { f, user };
    const adaptive_rule rule = { evaluate, quarter, POINTS, NEW_CORNERS, true, &g };
    double corner[POLYGON_CORNERS_MAX][CORNER], places[POLYGON_CORNERS_MAX][ADAPTIVE_PLACE];
    size_t corners = (size_t)shape->count, left = evaluation_limit > corners ? (size_t)evaluation_limit - corners : 1;
    const factor_request request = { .absolute = tolerance, .evaluations_max = left, .memory = memory };
    for (size_t i = 0; i < corners; i++) set_corner(&g, corner[i], shape->corner[i]);
    for (size_t i = 0; i + 2 < corners; i++) set_triangle(places[i], corner[0], corner[i + 1], corner[i + 2]);
    factor_estimate out =
        adaptive_integrate(&rule, (const double(*)[ADAPTIVE_PLACE])places, corners - 2, 1.0, &request);
    out.evaluations += corners;
    return out;
}
