/* SPDX-License-Identifier: MIT
 * Does the closed form give what the textbooks and plain integration give? The configurations are those of the
 * view-factor tables [Howell82]: parallel (B-3) and perpendicular (B-4) rectangles, the coaxial disc, and rectangles
 * with a common edge (C-14), written out here independently of the edge formula under test.
 */
#include "check.h"
#include "geometry/polygon.h"
#include "geometry/vec3.h"

#include <stdint.h>

static const double UP[3] = { 0, 0, 1 };
static const double ORIGIN[3] = { 0, 0, 0 };

/* splitmix64 (Steele, Lea & Flood 2014), in [0, 1). */
static double random_unit(uint64_t *state) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

static double random_between(uint64_t *state, double low, double high) {
    return low + (high - low) * random_unit(state);
}

/* The corner a and the sides u and v of a parallelogram; its front is u x v. */
static polygon parallelogram(const double a[3], const double u[3], const double v[3]) {
    polygon p = { .count = 4 };
    vec3_copy(p.corner[0], a);
    vec3_add_scaled(p.corner[1], a, 1, u);
    vec3_add_scaled(p.corner[2], p.corner[1], 1, v);
    vec3_add_scaled(p.corner[3], a, 1, v);
    return p;
}

/* [x0, x1] x [y0, y1] at height z, looking down. */
static polygon ceiling(double x0, double y0, double x1, double y1, double z) {
    return parallelogram((double[]){ x0, y0, z }, (double[]){ 0, y1 - y0, 0 }, (double[]){ x1 - x0, 0, 0 });
}

static polygon reversed(const polygon *p) {
    polygon out = { .count = p->count };
    for (int i = 0; i < p->count; i++) vec3_copy(out.corner[i], p->corner[p->count - 1 - i]);
    return out;
}

static double above_origin(polygon p) {
    return polygon_factor(&p, ORIGIN, UP);
}

/* ---- textbook values ---- */

/* [Howell82, B-3]: a x b at distance c, one corner over the point. */
static double howell_parallel(double a, double b, double c) {
    double X = a / c, Y = b / c, p = sqrt(1 + X * X), q = sqrt(1 + Y * Y);
    return (X / p * atan(Y / p) + Y / q * atan(X / q)) / (2 * PI);
}

/* [Howell82, B-4]: a wall of width b and height a, standing on the plane of the point at distance c, one end of its
 * foot nearest to the point. */
static double howell_perpendicular(double a, double b, double c) {
    double r = sqrt(a * a + c * c);
    return (atan(b / c) - c / r * atan(b / r)) / (2 * PI);
}

static void a_parallel_rectangle_has_the_textbook_factor(void) {
    static const double sizes[][3] = {
        { 1, 1, 1 }, { 0.3, 2, 1 }, { 5, 0.01, 0.2 }, { 1e-3, 1e-3, 1 }, { 400, 300, 1 }
    };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        double a = sizes[i][0], b = sizes[i][1], c = sizes[i][2];
        /* Both are a few dozen roundings of numbers below 1. */
        CHECK_NEAR(above_origin(ceiling(0, 0, a, b, c)), howell_parallel(a, b, c), 2e-15);
    }
    /* The well-known value of the unit square at unit distance, seen from below its corner. */
    CHECK_NEAR(above_origin(ceiling(0, 0, 1, 1, 1)), 0.13853160599489298, 1e-15);
}

static void a_perpendicular_rectangle_has_the_textbook_factor(void) {
    static const double sizes[][3] = { { 1, 1, 1 }, { 2, 0.5, 0.1 }, { 0.01, 3, 2 }, { 50, 70, 0.5 } };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        double a = sizes[i][0], b = sizes[i][1], c = sizes[i][2];
        polygon wall = parallelogram((double[]){ c, 0, 0 }, (double[]){ 0, 0, a }, (double[]){ 0, b, 0 });
        /* As above. */
        CHECK_NEAR(above_origin(wall), howell_perpendicular(a, b, c), 2e-15);
    }
}

/* In polar coordinates about the foot of the point, F = 1/(2 pi) integral of r^2 / (r^2 + h^2) dphi with
 * r = d / cos phi, which is d / sqrt(d^2 + h^2) atan(tan theta d / sqrt(d^2 + h^2)) / (2 pi). */
static void a_right_triangle_over_its_acute_corner_has_the_polar_integral(void) {
    static const double cases[][3] = { { 1, 1, 1 }, { 2, 0.5, 0.3 }, { 0.1, 3, 1 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double d = cases[i][0], opposite = cases[i][1], h = cases[i][2], s = d / sqrt(d * d + h * h);
        polygon p = { { { 0, 0, h }, { d, opposite, h }, { d, 0, h } }, 3 };
        /* As above. */
        CHECK_NEAR(above_origin(p), s * atan(opposite / d * s) / (2 * PI), 2e-15);
    }
}

/* Sum over the triangles of an n-gon around the axis, at height h. */
static double many_gon(int n, double radius, double h) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        double a = 2 * PI * i / n, b = 2 * PI * (i + 1) / n;
        polygon p = { { { 0, 0, h }, { radius * cos(b), radius * sin(b), h }, { radius * cos(a), radius * sin(a), h } },
                      3 };
        sum += above_origin(p);
    }
    return sum;
}

static void a_disc_lies_between_its_inner_and_outer_polygons(void) {
    /* A coaxial disc [Howell82]: r^2 / (r^2 + h^2). */
    const double radius = 0.8, h = 0.6, disc = radius * radius / (radius * radius + h * h);
    for (int n = 8; n <= 512; n *= 4) {
        CHECK(many_gon(n, radius, h) < disc);
        CHECK(many_gon(n, radius / cos(PI / n), h) > disc);
    }
    double ratio = (disc - many_gon(256, radius, h)) / (disc - many_gon(512, radius, h));
    /* The sagitta of a chord falls with the square of n, so twice the corners leave a quarter of the error, up to a
     * fourth-order term of pi^2 / 256^2 and its like. */
    CHECK_NEAR(ratio, 4.0, 5e-4);
}

static void an_endless_ceiling_fills_the_hemisphere_and_an_endless_wall_half_of_it(void) {
    const double far = 1e6;
    /* What is missing of the ceiling is a band near the horizon, below 1 / far^2; the rest is rounding. */
    CHECK_NEAR(above_origin(ceiling(-far, -far, far, far, 1)), 1.0, 1e-11);
    polygon wall =
        parallelogram((double[]){ 1e-6, -far, -far }, (double[]){ 0, 0, 2 * far }, (double[]){ 0, 2 * far, 0 });
    /* A wall starting 1e-6 away misses the cosine lobe above its top and beyond its ends: c / far = 1e-12. */
    CHECK_NEAR(above_origin(wall), 0.5, 1e-11);
}

static void the_two_perpendicular_rectangles_of_the_paper(void) {
    /* [Baum89, sec. 6]: S1 is 1 x 5 on the floor, S2 is 1 x 1 upright on their common unit edge. */
    polygon S1 = parallelogram(ORIGIN, (double[]){ 5, 0, 0 }, (double[]){ 0, 1, 0 });
    polygon S2 = parallelogram(ORIGIN, (double[]){ 0, 1, 0 }, (double[]){ 0, 0, 1 });
    const double east[3] = { 1, 0, 0 };
    double F_d12 = polygon_factor(&S2, (double[]){ 2.5, 0.5, 0 }, UP);
    double F_d21 = polygon_factor(&S1, (double[]){ 0, 0.5, 0.5 }, east);
    /* Half a unit of the last digit that is printed. */
    CHECK_NEAR(F_d12, 0.008570, 5e-7);
    CHECK_NEAR(F_d21, 0.24686, 5e-6);
    /* The textbook forms: two walls of half the width from the middle. */
    CHECK_NEAR(F_d12, 2 * howell_perpendicular(1, 0.5, 2.5), 2e-15);
    CHECK_NEAR(F_d21, 2 * howell_perpendicular(5, 0.5, 0.5), 2e-15);
}

/* Two rectangles at a right angle on a common edge of length 1 [Howell82, C-14]: from one of width W to one of height
 * H. */
static double howell_common_edge(double H, double W) {
    double h = H * H, w = W * W, s = sqrt(h + w), a = (1 + w) * (1 + h) / (1 + w + h);
    double b = pow(w * (1 + w + h) / ((1 + w) * (w + h)), w), c = pow(h * (1 + h + w) / ((1 + h) * (h + w)), h);
    return (W * atan(1 / W) + H * atan(1 / H) - s * atan(1 / s) + 0.25 * log(a * b * c)) / (PI * W);
}

static void the_mean_over_a_patch_is_its_patch_factor(void) {
    polygon S1 = parallelogram(ORIGIN, (double[]){ 5, 0, 0 }, (double[]){ 0, 1, 0 });
    const double east[3] = { 1, 0, 0 };
    enum { N = 200 };
    double sum = 0.0;
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) sum += polygon_factor(&S1, (double[]){ 0, (i + 0.5) / N, (k + 0.5) / N }, east);
    /* The midpoint rule on cells of 1/200 leaves h^2 / 24 = 1e-6 times the jump of slope from side to side, below 1; it
     * is F_21 of [Baum89], .247 there. */
    CHECK_NEAR(sum / (N * N), howell_common_edge(5, 1), 1e-6);
    CHECK_NEAR(howell_common_edge(5, 1), 0.247, 5e-4);
    CHECK_NEAR(howell_common_edge(1, 5), 0.0494, 5e-5);
}

/* ---- laws ---- */

static void what_is_below_the_horizon_does_not_count(void) {
    polygon whole = parallelogram((double[]){ 1, -0.4, -2 }, (double[]){ 0.3, 0, 3 }, (double[]){ 0, 1, 0 }), upper;
    polygon_clip(&upper, &whole, UP, 0.0);
    CHECK_EQUAL(upper.count, 4);
    for (int i = 0; i < upper.count; i++) CHECK(upper.corner[i][2] >= 0.0);
    double area[3];
    polygon_vector_area(&upper, area);
    /* A third of the parallelogram's area of sqrt(9.09) x 1 is above z = 0. */
    CHECK_NEAR(vec3_length(area), sqrt(9.09) / 3, 1e-15);
    /* The same corners go through the same arithmetic. */
    CHECK_NEAR(above_origin(whole), above_origin(upper), 1e-16);
    CHECK(above_origin(whole) > 0.01);
    CHECK_NEAR(above_origin(ceiling(-1, -1, 1, 1, -0.5)), 0.0, 0);
    CHECK_NEAR(above_origin(parallelogram((double[]){ 1, 0, -3 }, (double[]){ 0, 0, 2 }, (double[]){ 0, 1, 0 })), 0.0,
               0);
}

static void clipping_keeps_all_or_nothing_of_what_does_not_cross(void) {
    polygon p = ceiling(0, 0, 1, 2, 1), out;
    polygon_clip(&out, &p, UP, 0.5);
    CHECK_EQUAL(out.count, 4);
    CHECK(memcmp(out.corner, p.corner, 4 * sizeof *p.corner) == 0);
    polygon_clip(&out, &p, UP, 1.5);
    CHECK_EQUAL(out.count, 0);
    /* A plane through two corners leaves a triangle. */
    polygon square = { { { 0, 0, 0 }, { 1, 0, 1 }, { 0, 0, 2 }, { -1, 0, 1 } }, 4 };
    polygon_clip(&out, &square, UP, 1.0);
    CHECK_EQUAL(out.count, 3);
}

static void parts_add_up_to_the_whole(void) {
    uint64_t seed = 7;
    for (int i = 0; i < 200; i++) {
        double a[3], u[3], v[3];
        for (int k = 0; k < 3; k++) {
            a[k] = random_between(&seed, -1, 1);
            u[k] = random_between(&seed, -1, 1);
            v[k] = random_between(&seed, -1, 1);
        }
        polygon whole = parallelogram(a, u, v), quarter[4];
        polygon triangle = { .count = 3 };
        memcpy(triangle.corner, whole.corner, 3 * sizeof *whole.corner);
        polygon_quarter(&whole, quarter);
        double parts = 0.0, sum = above_origin(whole);
        for (int q = 0; q < 4; q++) parts += above_origin(quarter[q]);
        /* Four times the roundings of one; some of these polygons pass near the point, where angles come near pi. */
        CHECK_NEAR(parts, sum, 1e-13);
        sum = above_origin(triangle);
        polygon_quarter(&triangle, quarter);
        parts = 0.0;
        for (int q = 0; q < 4; q++) parts += above_origin(quarter[q]);
        CHECK_NEAR(parts, sum, 1e-13);
    }
}

static void quarters_have_a_quarter_of_the_area_and_the_same_front(void) {
    polygon shapes[2] = { parallelogram((double[]){ 1, 2, 3 }, (double[]){ 1, 0.5, 0 }, (double[]){ 0, 1, -1 }) },
            quarter[4];
    shapes[1] = shapes[0];
    shapes[1].count = 3;
    for (int i = 0; i < 2; i++) {
        double whole[3], part[3];
        polygon_vector_area(&shapes[i], whole);
        polygon_quarter(&shapes[i], quarter);
        for (int q = 0; q < 4; q++) {
            CHECK_EQUAL(quarter[q].count, shapes[i].count);
            polygon_vector_area(&quarter[q], part);
            /* Sums of a few products of numbers near 1. */
            for (int k = 0; k < 3; k++) CHECK_NEAR(part[k], 0.25 * whole[k], 1e-15);
        }
    }
}

static void the_centroid_of_a_trapezoid_is_the_textbook_one(void) {
    /* Sides a = 3 below, b = 1 above, height 2: it lies at h/3 (a + 2 b) / (a + b). */
    polygon p = { { { 0, 0, 5 }, { 3, 0, 5 }, { 1, 2, 5 }, { 0, 2, 5 } }, 4 };
    double c[3];
    polygon_centroid(&p, c);
    /* A few roundings of 5. */
    CHECK_NEAR(c[1], 2.0 / 3.0 * 5.0 / 4.0, 4e-15);
    CHECK_NEAR(c[0], (1 * 1 / 2.0 * 2 + 2 * 2.0 / 2 * (1 + 2.0 / 3)) / 4.0, 4e-15);
    CHECK_NEAR(c[2], 5.0, 4e-15);
}

static void the_back_counts_negative(void) {
    polygon front = ceiling(-0.2, -1, 0.7, 0.5, 0.8), back = reversed(&front);
    CHECK(above_origin(front) > 0.0);
    /* The same terms in another order. */
    CHECK_NEAR(above_origin(back), -above_origin(front), 1e-15);
}

/* x -> scale (rotation x + shift), with the rotation of a unit quaternion. */
static void move(double out[3], const double x[3], const double q[4], double scale, const double shift[3]) {
    double axis[3] = { q[1], q[2], q[3] }, once[3], twice[3];
    vec3_cross(once, axis, x);
    vec3_cross(twice, axis, once);
    for (int k = 0; k < 3; k++) out[k] = scale * (x[k] + 2 * q[0] * once[k] + 2 * twice[k] + shift[k]);
}

static void moving_turning_and_scaling_change_nothing(void) {
    uint64_t seed = 11;
    const double none[3] = { 0, 0, 0 };
    polygon p = parallelogram((double[]){ 0.5, -0.4, -0.1 }, (double[]){ 0.3, 0, 1 }, (double[]){ 0, 1, 0.2 });
    double expected = above_origin(p);
    for (int i = 0; i < 100; i++) {
        double q[4], length = 0.0, shift[3], point[3], normal[3], scale = pow(10, random_between(&seed, -3, 3));
        for (int k = 0; k < 4; k++) q[k] = random_between(&seed, -1, 1), length += q[k] * q[k];
        for (int k = 0; k < 4; k++) q[k] /= sqrt(length);
        for (int k = 0; k < 3; k++) shift[k] = random_between(&seed, -5, 5);
        polygon moved = { .count = p.count };
        for (int c = 0; c < p.count; c++) move(moved.corner[c], p.corner[c], q, scale, shift);
        move(point, ORIGIN, q, scale, shift);
        move(normal, UP, q, 1.0, none);
        /* Shifting by 5 costs a digit of the coordinates; the factor follows them. */
        CHECK_NEAR(polygon_factor(&moved, point, normal), expected, 2e-14);
    }
}

/* ---- hard cases ---- */

static void repeated_and_straight_corners_change_nothing(void) {
    polygon p = ceiling(-0.3, -0.2, 1, 0.6, 0.7);
    polygon repeated = { .count = 6 };
    static const int order[6] = { 0, 0, 1, 2, 2, 3 };
    for (int i = 0; i < 6; i++) vec3_copy(repeated.corner[i], p.corner[order[i]]);
    /* A repeated corner adds an edge without angle: exactly 0. */
    CHECK_NEAR(above_origin(repeated), above_origin(p), 1e-16);
    polygon straight = { .count = 5 };
    for (int i = 0; i < 4; i++) vec3_copy(straight.corner[i + (i > 0)], p.corner[i]);
    vec3_mid(straight.corner[1], p.corner[0], p.corner[1]);
    /* An edge in two pieces: a rounding more. */
    CHECK_NEAR(above_origin(straight), above_origin(p), 2e-16);
}

static void polygons_without_area_give_nothing(void) {
    polygon line = { { { 1, 0, 1 }, { 2, 0, 1 }, { 3, 0, 1 }, { 2, 0, 1 } }, 4 };
    polygon dot = { { { 1, 2, 3 }, { 1, 2, 3 }, { 1, 2, 3 } }, 3 };
    polygon empty = { .count = 0 };
    /* Terms that cancel to a rounding. */
    CHECK_NEAR(above_origin(line), 0.0, 1e-16);
    CHECK_NEAR(above_origin(dot), 0.0, 0);
    CHECK_NEAR(above_origin(empty), 0.0, 0);
}

static void a_polygon_seen_on_its_edge_gives_nothing(void) {
    /* The point lies in the polygon's plane, which stands on the horizon. */
    polygon upright = parallelogram((double[]){ 1, 0, 0.5 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 0, 1 });
    CHECK_NEAR(above_origin(upright), 0.0, 1e-16);
    /* And beside it in the plane of the horizon. */
    CHECK_NEAR(above_origin(ceiling(1, 0, 2, 1, 0)), 0.0, 1e-16);
}

static void points_on_corners_edges_and_planes_give_finite_factors_in_range(void) {
    polygon wall = parallelogram(ORIGIN, (double[]){ 0, 1, 0 }, (double[]){ 0, 0, 1 });
    polygon slanted = parallelogram(ORIGIN, (double[]){ 0.6, 0.8, 0.1 }, (double[]){ -0.3, 0.2, 0.9 });
    const polygon *shapes[] = { &wall, &slanted };
    const double normals[][3] = { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0.6, 0, 0.8 }, { -1, 0, 0 } };
    for (int shape = 0; shape < 2; shape++)
        for (int n = 0; n < 5; n++)
            for (int i = -4; i <= 12; i++)
                for (int k = -4; k <= 12; k++) {
                    const polygon *p = shapes[shape];
                    double point[3], u = i / 8.0, v = k / 8.0;
                    for (int c = 0; c < 3; c++)
                        point[c] = (1 - u - v) * p->corner[0][c] + u * p->corner[1][c] + v * p->corner[3][c];
                    double F = polygon_factor(p, point, normals[n]);
                    /* On the polygon itself the factor jumps between its one-sided limits, all of them within 1; false
                     * for NaN. The margin is a rounding of the sum of four angles. */
                    CHECK(fabs(F) <= 1.0 + 1e-15);
                }
}

static void a_point_close_to_a_wall_sees_half_of_everything(void) {
    polygon wall = parallelogram((double[]){ 0, -1, 0 }, (double[]){ 0, 2, 0 }, (double[]){ 0, 0, 1 });
    for (double x = 1e-3; x > 1e-13; x *= 0.1) /* B-4 for c -> 0: 1/2 less terms of the order of c / a. */
        CHECK_NEAR(polygon_factor(&wall, (double[]){ x, 0, 0 }, UP), 0.5, 2 * x + 1e-12);
}

static void a_distant_small_polygon_is_a_point(void) {
    const double distance = 1e5;
    /* cos cos A / (pi r^2), to second order in size / distance. */
    double F = above_origin(ceiling(-0.5, -0.5, 0.5, 0.5, distance)), point = 1 / (PI * distance * distance);
    /* The angles of 1e-5 of the edges cancel to 1e-10: six digits of the sixteen are left. */
    CHECK_NEAR(F / point, 1.0, 1e-5);
}

/* ---- plain integration ---- */

/* Gauss-Legendre with five points [Abramowitz64, table 25.4], exact to degree 9. */
static const double GAUSS_X[5] = { -0.906179845938663993, -0.538469310105683091, 0, 0.538469310105683091,
                                   0.906179845938663993 };
static const double GAUSS_W[5] = { 0.236926885056189088, 0.478628670499366468, 0.568888888888888889,
                                   0.478628670499366468, 0.236926885056189088 };

/* The integral of cos cos / (pi r^2) over a parallelogram; signed at its back, 0 below the horizon. */
static double integrate(const double a[3], const double u[3], const double v[3], const double normal[3], int panels) {
    double n[3], sum = 0.0;
    vec3_cross(n, u, v);
    for (int cell = 0; cell < panels * panels * 25; cell++) {
        int i = cell % 5, k = cell / 5 % 5, x = cell / 25 % panels, y = cell / 25 / panels;
        double s = (x + 0.5 + 0.5 * GAUSS_X[i]) / panels, t = (y + 0.5 + 0.5 * GAUSS_X[k]) / panels, r[3];
        for (int c = 0; c < 3; c++) r[c] = a[c] + s * u[c] + t * v[c];
        double r2 = vec3_dot(r, r), cosine = vec3_dot(normal, r);
        if (cosine > 0.0) sum += GAUSS_W[i] * GAUSS_W[k] * cosine * -vec3_dot(n, r) / (PI * r2 * r2);
    }
    return sum / (4.0 * panels * panels);
}

static void random_parallelograms_have_the_factor_that_integration_gives(void) {
    uint64_t seed = 1989;
    for (int i = 0; i < 300; i++) {
        double a[3], u[3], v[3], normal[3] = { random_between(&seed, -0.2, 0.2), random_between(&seed, -0.2, 0.2), 1 };
        for (int k = 0; k < 3; k++) {
            a[k] = k < 2 ? random_between(&seed, -2, 2) : random_between(&seed, 3, 5);
            u[k] = random_between(&seed, -1, 1);
            v[k] = random_between(&seed, -1, 1);
        }
        vec3_normalize(normal);
        polygon p = parallelogram(a, u, v);
        /* Everything is at least 1 away and at most sqrt(12) across in 6 panels: ten orders of (0.3 / 1). */
        CHECK_NEAR(polygon_factor(&p, ORIGIN, normal), integrate(a, u, v, normal, 6), 1e-9);
    }
}

static void parallelograms_through_the_horizon_have_the_factor_that_integration_gives(void) {
    uint64_t seed = 1760;
    for (int i = 0; i < 20; i++) {
        double a[3] = { random_between(&seed, 1, 2), random_between(&seed, -1, 1), random_between(&seed, -1, 0) };
        double u[3] = { random_between(&seed, -0.2, 0.2), 1, random_between(&seed, -0.5, 0.5) };
        double v[3] = { random_between(&seed, -0.2, 0.2), random_between(&seed, -0.5, 0.5), 1.5 };
        polygon p = parallelogram(a, u, v);
        /* At the horizon the integrand has a kink: second order in panels of 1 / 150, times 0.1 for its slope. */
        CHECK_NEAR(polygon_factor(&p, ORIGIN, UP), integrate(a, u, v, UP, 150), 5e-6);
    }
}

int main(void) {
    RUN(a_parallel_rectangle_has_the_textbook_factor);
    RUN(a_perpendicular_rectangle_has_the_textbook_factor);
    RUN(a_right_triangle_over_its_acute_corner_has_the_polar_integral);
    RUN(a_disc_lies_between_its_inner_and_outer_polygons);
    RUN(an_endless_ceiling_fills_the_hemisphere_and_an_endless_wall_half_of_it);
    RUN(the_two_perpendicular_rectangles_of_the_paper);
    RUN(the_mean_over_a_patch_is_its_patch_factor);
    RUN(what_is_below_the_horizon_does_not_count);
    RUN(clipping_keeps_all_or_nothing_of_what_does_not_cross);
    RUN(parts_add_up_to_the_whole);
    RUN(quarters_have_a_quarter_of_the_area_and_the_same_front);
    RUN(the_centroid_of_a_trapezoid_is_the_textbook_one);
    RUN(the_back_counts_negative);
    RUN(moving_turning_and_scaling_change_nothing);
    RUN(repeated_and_straight_corners_change_nothing);
    RUN(polygons_without_area_give_nothing);
    RUN(a_polygon_seen_on_its_edge_gives_nothing);
    RUN(points_on_corners_edges_and_planes_give_finite_factors_in_range);
    RUN(a_point_close_to_a_wall_sees_half_of_everything);
    RUN(a_distant_small_polygon_is_a_point);
    RUN(random_parallelograms_have_the_factor_that_integration_gives);
    RUN(parallelograms_through_the_horizon_have_the_factor_that_integration_gives);
    return check_end();
}
