/* SPDX-License-Identifier: MIT
 * Do points, elements and polygons have the factors of the textbooks? Each test is one or a few closed forms; numbers
 * in brackets are those of the catalogue of view factors [Howell82]. Curved surfaces are outlines of many corners, with
 * a check that the rest shrinks as it must.
 *
 * An estimate fails if the value is off, if it is off by more than it says, and if it says more than was asked for.
 */
#include "check.h"
#include "element_mean.h"
#include "factors/polygon_pair.h"
#include "geometry/vec3.h"

#include <stdlib.h>

static const double UP[3] = { 0, 0, 1 };
static const double ORIGIN[3] = { 0, 0, 0 };

enum { CORNERS_MAX = 1100 };

typedef struct shape {
    double corner[CORNERS_MAX][3];
    size_t count;
} shape;

static polygon_loop loop_of(const shape *s) {
    return (polygon_loop){ s->corner, s->count };
}

static void add(shape *s, double x, double y, double z) {
    vec3_copy(s->corner[s->count++], (double[]){ x, y, z });
}

static shape parallelogram(const double a[3], const double u[3], const double v[3]) {
    shape s = { .count = 0 };
    for (int i = 0; i < 4; i++) {
        double p = i == 1 || i == 2, q = i >= 2;
        add(&s, a[0] + p * u[0] + q * v[0], a[1] + p * u[1] + q * v[1], a[2] + p * u[2] + q * v[2]);
    }
    return s;
}

static shape floor_of(double x0, double x1, double y0, double y1, double z) {
    return parallelogram((double[]){ x0, y0, z }, (double[]){ x1 - x0, 0, 0 }, (double[]){ 0, y1 - y0, 0 });
}

static shape ceiling_of(double x0, double x1, double y0, double y1, double z) {
    return parallelogram((double[]){ x0, y0, z }, (double[]){ 0, y1 - y0, 0 }, (double[]){ x1 - x0, 0, 0 });
}

/* In the plane x = x0, front to +x. */
static shape wall_of(double x0, double y0, double y1, double z0, double z1) {
    return parallelogram((double[]){ x0, y0, z0 }, (double[]){ 0, y1 - y0, 0 }, (double[]){ 0, 0, z1 - z0 });
}

/* A regular n-gon with the area of the disc: off the circle by a length of order n^-2 that has no mean, so that what is
 * left of smooth integrals is of order n^-4. */
static void add_ring(shape *s, int n, double radius, const double center[3], const double u[3], const double v[3]) {
    double r = radius * sqrt(2 * PI / n / sin(2 * PI / n));
    for (int i = 0; i < n; i++) {
        double c = r * cos(2 * PI * i / n), t = r * sin(2 * PI * i / n);
        add(s, center[0] + c * u[0] + t * v[0], center[1] + c * u[1] + t * v[1], center[2] + c * u[2] + t * v[2]);
    }
}

/* Front down, at height z. */
static shape disc_above(int n, double radius, double x, double z) {
    shape s = { .count = 0 };
    add_ring(&s, n, radius, (double[]){ x, 0, z }, (double[]){ 0, 1, 0 }, (double[]){ 1, 0, 0 });
    return s;
}

/* Front up, at height z. */
static shape disc_below(int n, double radius, double x, double z) {
    shape s = { .count = 0 };
    add_ring(&s, n, radius, (double[]){ x, 0, z }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 });
    return s;
}

static double from_origin(const shape *s, const double normal[3]) {
    return polygon_loop_factor(loop_of(s), ORIGIN, normal);
}

/* The limit of values of order n^-4 at n and 2 n. */
static double extrapolate(double at_n, double at_2n) {
    return at_2n + (at_2n - at_n) / 15;
}

/* at_n, at_2n and at_4n go to their limit with the fourth order, unless they are there. */
static void check_order_four(double at_n, double at_2n, double at_4n) {
    if (fabs(at_n - at_2n) < 1e-12) return;
    /* 16 up to terms of the next orders, which are smaller by n^-1 to n^-2 with n = 32 at least. */
    CHECK_NEAR((at_n - at_2n) / (at_2n - at_4n), 16.0, 1.0);
}

/* off: of the expected value itself. */
static void check_estimate(factor_estimate e, double expected, double asked, double off) {
    CHECK(e.converged);
    CHECK_NEAR(e.value, expected, e.error + off);
    CHECK(e.error >= 0.0 && e.error <= asked * fabs(expected) * (1 + 1e-6));
    CHECK(e.evaluations > 0);
}

/* Both ways, both methods. exact: roundings of the closed form. */
static void check_pair(const shape *a, const shape *b, double F_ab, double exact) {
    static const double asked[] = { 1e-5, 1e-8, 1e-11 };
    double area[3], A, B;
    polygon_loop_vector_area(loop_of(a), area), A = vec3_length(area);
    polygon_loop_vector_area(loop_of(b), area), B = vec3_length(area);
    for (int i = 0; i < 3; i++) {
        factor_request request = { .relative = asked[i] };
        check_estimate(polygon_pair_factor(loop_of(a), loop_of(b), &request), F_ab, asked[i], exact);
        check_estimate(polygon_pair_factor(loop_of(b), loop_of(a), &request), F_ab * A / B, asked[i], exact * A / B);
    }
    factor_request request = { .relative = 1e-8 };
    check_estimate(element_mean(loop_of(a), loop_of(b), &request), F_ab, 1e-8, exact);
}

/* ---- points ---- */

/* [B-3]: a x b at distance c over the point, one corner on the normal. */
static double parallel_corner(double a, double b, double c) {
    double X = a / c, Y = b / c, p = sqrt(1 + X * X), q = sqrt(1 + Y * Y);
    return (X / p * atan(Y / p) + Y / q * atan(X / q)) / (2 * PI);
}

/* [B-4]: upright, b wide and a high, at distance c. */
static double perpendicular_corner(double a, double b, double c) {
    double r = sqrt(a * a + c * c);
    return (atan(b / c) - c / r * atan(b / r)) / (2 * PI);
}

static void a_point_and_a_parallel_or_perpendicular_rectangle(void) {
    static const double sizes[][3] = {
        { 1, 1, 1 }, { 0.3, 2, 1 }, { 5, 0.01, 0.2 }, { 40, 30, 1 }, { 1e3, 1e-3, 1e-2 }
    };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        double a = sizes[i][0], b = sizes[i][1], c = sizes[i][2];
        shape ceiling = ceiling_of(0, a, 0, b, c),
              wall = parallelogram((double[]){ c, 0, 0 }, (double[]){ 0, 0, a }, (double[]){ 0, b, 0 });
        /* Both sides are a few dozen roundings of numbers below 1. */
        CHECK_NEAR(from_origin(&ceiling, UP), parallel_corner(a, b, c), 2e-15);
        CHECK_NEAR(from_origin(&wall, UP), perpendicular_corner(a, b, c), 2e-15);
    }
}

/* [Hamilton52]: the rectangle's side b lies in the plane of the point, at distance c, one end nearest; its
 * side a rises from there at the angle phi towards the point. */
static double tilted_corner(double a, double b, double c, double phi) {
    double N = a / b, L = c / b, V = 1 / sqrt(N * N + L * L - 2 * N * L * cos(phi));
    double W = sqrt(1 + L * L * sin(phi) * sin(phi));
    return (atan(1 / L) + V * (N * cos(phi) - L) * atan(V) +
            cos(phi) / W * (atan((N - L * cos(phi)) / W) + atan(L * cos(phi) / W))) /
           (2 * PI);
}

static void a_point_and_a_tilted_rectangle(void) {
    for (double phi = 0.2; phi < 3.1; phi += 0.2)
        for (double a = 0.1; a < 20; a *= 3) {
            shape s = parallelogram((double[]){ 1, 0, 0 }, (double[]){ -a * cos(phi), 0, a * sin(phi) },
                                    (double[]){ 0, 0.7, 0 });
            /* As above; differences of numbers near 1. */
            CHECK_NEAR(from_origin(&s, UP), tilted_corner(a, 0.7, 1, phi), 2e-15);
        }
}

/* In polar coordinates about the foot: d / s atan(tan(theta) d / s) / (2 pi), s^2 = d^2 + h^2 [Hottel67, sec. 2.4]. */
static double right_triangle(double d, double opposite, double h) {
    double s = d / sqrt(d * d + h * h);
    return s * atan(opposite / d * s) / (2 * PI);
}

static void a_point_and_a_triangle(void) {
    for (double h = 0.01; h < 200; h *= 4) {
        shape s = { { { 0, 0, h }, { 1, 1.5, h }, { 1, -0.5, h } }, 3 };
        CHECK_NEAR(from_origin(&s, UP), right_triangle(1, 1.5, h) + right_triangle(1, 0.5, h), 2e-15);
    }
}

static void a_point_and_a_regular_polygon_on_its_axis(void) {
    for (int n = 3; n <= 1000; n = 2 * n + 1) {
        shape s = { .count = 0 };
        double apothem = 0.8, h = 0.6, radius = apothem / cos(PI / n);
        for (int i = 0; i < n; i++) add(&s, radius * sin(2 * PI * i / n), radius * cos(2 * PI * i / n), h);
        /* 2 n right triangles; n terms with roundings of 1 / n each. */
        CHECK_NEAR(from_origin(&s, UP), 2 * n * right_triangle(apothem, apothem * tan(PI / n), h), 4e-15);
    }
}

/* Values of three discs, finer and finer, against a closed form. */
static void check_disc(const double at[3], double expected) {
    check_order_four(at[0], at[1], at[2]);
    /* The next order: n^-6 = 2e-12 with a factor that depends on how near the rim is. */
    CHECK_NEAR(extrapolate(at[1], at[2]), expected, 1e-9);
}

static void a_point_and_a_disc(void) {
    static const double cases[][3] = { { 0.5, 1, 1 }, { 0.3, 0.8, 2 }, { 0.9, 0.4, 1.5 }, { 2, 1, 0.5 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double r = cases[i][0], h = cases[i][1], l = cases[i][2], R = r / l, H = h / l, Z = 1 + H * H + R * R;
        double root = sqrt(Z * Z - 4 * R * R), on_axis[3], beside[3], sideways[3];
        for (int k = 0; k < 3; k++) {
            shape axis = disc_above(64 << k, r, 0, h), off = disc_above(64 << k, r, l, h);
            on_axis[k] = from_origin(&axis, UP);
            beside[k] = from_origin(&off, UP);
            sideways[k] = from_origin(&off, (double[]){ 1, 0, 0 });
        }
        check_disc(on_axis, r * r / (r * r + h * h));               /* [Howell82] */
        check_disc(beside, 0.5 * (1 - (1 + H * H - R * R) / root)); /* [Howell82] */
        if (r < l) check_disc(sideways, 0.5 * H * (Z / root - 1));  /* [Howell82] */
    }
}

static void a_point_and_an_ellipse_on_its_axis(void) {
    /* [Howell82]; an affine image of the disc. */
    double a = 0.7, b = 1.9, h = 0.8, at[3];
    for (int k = 0; k < 3; k++) {
        shape s = disc_above(64 << k, 1, 0, h);
        for (size_t i = 0; i < s.count; i++) s.corner[i][0] *= a, s.corner[i][1] *= b;
        at[k] = from_origin(&s, UP);
    }
    check_disc(at, a * b / sqrt((h * h + a * a) * (h * h + b * b)));
}

/* Two rings joined by a bridge that is walked both ways: not convex, and with different heights not planar. */
static shape keyhole(int n, double outer, double z_outer, double inner, double z_inner) {
    shape s = disc_above(n, outer, 0, z_outer), hole = disc_above(n, inner, 0, z_inner);
    vec3_copy(s.corner[s.count], s.corner[0]), s.count++;
    for (size_t i = 0; i <= hole.count; i++) vec3_copy(s.corner[s.count++], hole.corner[(hole.count - i) % hole.count]);
    return s;
}

static void a_point_and_a_ring_or_the_inside_of_a_cylinder(void) {
    double annulus[3], band[3];
    for (int k = 0; k < 3; k++) {
        shape flat = keyhole(64 << k, 1, 0.7, 0.4, 0.7), upright = keyhole(64 << k, 0.9, 0.5, 0.9, 1.4);
        annulus[k] = from_origin(&flat, UP);
        band[k] = from_origin(&upright, UP);
    }
    /* Discs on the axis, [Howell82]: discs less the holes in them. */
    check_disc(annulus, 1 / (1 + 0.49) - 0.16 / (0.16 + 0.49));
    check_disc(band, 0.81 / (0.81 + 0.25) - 0.81 / (0.81 + 1.96));
}

/* The outline of a sphere: where rays from the point touch it. */
static shape sphere_outline(int n, const double point[3], const double center[3], double radius) {
    shape s = { .count = 0 };
    double axis[3], u[3], v[3], middle[3];
    vec3_sub(axis, point, center);
    double d = vec3_normalize(axis), share = radius / d;
    vec3_cross(u, axis, fabs(axis[0]) < 0.7 ? (double[]){ 1, 0, 0 } : (double[]){ 0, 1, 0 });
    vec3_normalize(u);
    vec3_cross(v, axis, u);
    vec3_add_scaled(middle, center, radius * share, axis);
    add_ring(&s, n, radius * sqrt(1 - share * share), middle, u, v);
    return s;
}

/* [Juul79]: H = distance over radius, omega from the normal to the centre. */
static double point_to_sphere(double H, double omega) {
    if (omega <= acos(1 / H)) return cos(omega) / (H * H);
    double r = sqrt(H * H - 1), c = cos(omega), s = sin(omega);
    return 0.5 - asin(r / (H * s)) / PI + (c * acos(-r * c / s) - r * sqrt(1 - H * H * c * c)) / (PI * H * H);
}

static void a_point_and_a_sphere_above_or_through_the_horizon(void) {
    for (double H = 1.2; H < 12; H *= 1.7)
        for (double omega = 0.1; omega < 0.5 * PI + asin(1 / H) - 0.05; omega += 0.3) {
            double center[3] = { H * sin(omega), 0, H * cos(omega) }, at[3];
            for (int k = 0; k < 3; k++) {
                shape s = sphere_outline(64 << k, ORIGIN, center, 1);
                at[k] = from_origin(&s, UP);
            }
            if (omega < acos(1 / H) - 0.05)
                check_disc(at, point_to_sphere(H, omega));
            else
                /* Cut by the horizon, where corners lie changes the second order: (pi / 256)^2 times a cosine of
                 * (pi / 256)^2 or less at the cut, and the fourth order as before. */
                CHECK_NEAR(at[2], point_to_sphere(H, omega), 1e-7);
        }
}

/* Inside a sphere every part sees every other as its share of the area [Moon36]. */
static void a_point_inside_a_sphere_sees_any_cap_as_its_share(void) {
    for (double cap = 0.3; cap < 2.5; cap += 0.5)
        for (double place = cap + 0.2; place < PI; place += 0.4) {
            double at[3], point[3] = { sin(place), 0, cos(place) }, normal[3] = { -sin(place), 0, -cos(place) };
            for (int k = 0; k < 3; k++) {
                shape s = { .count = 0 };
                add_ring(&s, 64 << k, sin(cap), (double[]){ 0, 0, cos(cap) }, (double[]){ 0, 1, 0 },
                         (double[]){ 1, 0, 0 });
                at[k] = polygon_loop_factor(loop_of(&s), point, normal);
            }
            /* The rings' corners are off the sphere by up to 0.2 pi^2 / n^2, so the fourth order has a larger
             * factor where the point is 0.2 away: (0.04 / n^2 / 0.2)^2. */
            CHECK_NEAR(extrapolate(at[1], at[2]), 0.5 * (1 - cos(cap)), 1e-6);
        }
}

/* Two dimensions [Hottel67, sec. 2.3]: (sin phi2 - sin phi1) / 2 from the normal; the ends are 1e6 away and miss (w /
 * 1e6)^2 = 1e-12. */
static const double LONG = 1e6;

static void a_point_and_a_long_strip_or_an_endless_plane(void) {
    for (double phi = -1.5; phi < 1.3; phi += 0.35) {
        double end = phi + 0.2;
        shape s = { .count = 0 };
        add(&s, sin(phi), -LONG, cos(phi)), add(&s, sin(phi), LONG, cos(phi));
        add(&s, 2 * sin(end), LONG, 2 * cos(end)), add(&s, 2 * sin(end), -LONG, 2 * cos(end));
        CHECK_NEAR(from_origin(&s, UP), 0.5 * (sin(end) - sin(phi)), 1e-11);
    }
    for (double tilt = 0.1; tilt < 3; tilt += 0.3) {
        /* A plane at unit distance whose normal is tilted sees (1 + cos) / 2 of the hemisphere. */
        shape s =
            parallelogram((double[]){ -LONG, -LONG, 1 }, (double[]){ 0, 2 * LONG, 0 }, (double[]){ 2 * LONG, 0, 0 });
        /* The rim is 1e-6 above the plane's own horizon: of the order of 1e-6 where the tilted horizon crosses it. */
        CHECK_NEAR(from_origin(&s, (double[]){ sin(tilt), 0, cos(tilt) }), 0.5 * (1 + cos(tilt)), 2e-6);
    }
}

/* ---- rectangles ---- */

/* [C-11]: a x b, aligned, at distance c. */
static double opposite_rectangles(double a, double b, double c) {
    double X = a / c, Y = b / c, p = sqrt(1 + X * X), q = sqrt(1 + Y * Y);
    return 2 / (PI * X * Y) *
           (0.5 * log(p * p * q * q / (1 + X * X + Y * Y)) + X * q * atan(X / q) + Y * p * atan(Y / p) - X * atan(X) -
            Y * atan(Y));
}

/* [C-14]: from width W to height H, common edge of length 1. */
static double right_angle(double H, double W) {
    double h = H * H, w = W * W, s = sqrt(h + w), a = log((1 + w) * (1 + h) / (1 + w + h));
    double b = w * log(w * (1 + w + h) / ((1 + w) * (w + h))), c = h * log(h * (1 + h + w) / ((1 + h) * (h + w)));
    return (W * atan(1 / W) + H * atan(1 / H) - s * atan(1 / s) + 0.25 * (a + b + c)) / (PI * W);
}

static void the_two_figures_of_the_unit_squares(void) {
    shape down = floor_of(0, 1, 0, 1, 0), up = ceiling_of(0, 1, 0, 1, 1), side = wall_of(0, 0, 1, 0, 1);
    factor_request request = { .relative = 1e-11 };
    CHECK_NEAR(polygon_pair_factor(loop_of(&down), loop_of(&up), &request).value, 0.19982489569838746, 1e-14);
    CHECK_NEAR(polygon_pair_factor(loop_of(&down), loop_of(&side), &request).value, 0.20004377607540316, 1e-12);
    check_pair(&down, &up, 0.19982489569838746, 1e-15);
    check_pair(&down, &side, 0.20004377607540316, 1e-15);
    /* [C-11] and [C-14] are those; logarithms of products leave some roundings. */
    CHECK_NEAR(opposite_rectangles(1, 1, 1), 0.19982489569838746, 2e-15);
    CHECK_NEAR(right_angle(1, 1), 0.20004377607540316, 2e-15);
}

static void opposite_rectangles_of_many_sizes(void) {
    static const double sizes[][3] = { { 1, 2, 0.1 }, { 3, 0.2, 1 }, { 1, 1, 4 }, { 10, 1, 0.5 }, { 1, 1, 1e-2 } };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        double a = sizes[i][0], b = sizes[i][1], c = sizes[i][2];
        shape down = floor_of(0, a, 0, b, 0), up = ceiling_of(0, a, 0, b, c);
        /* The closed form adds terms of the order of X Y before it divides by them. */
        check_pair(&down, &up, opposite_rectangles(a, b, c), 1e-13);
    }
}

static void rectangles_at_a_right_angle_of_many_sizes(void) {
    static const double sizes[][2] = { { 5, 1 }, { 1, 5 }, { 0.1, 2 }, { 30, 0.3 }, { 1e-3, 1 } };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        double H = sizes[i][0], W = sizes[i][1];
        shape floor = floor_of(0, W, 0, 1, 0), wall = wall_of(0, 0, 1, 0, H);
        check_pair(&floor, &wall, right_angle(H, W), 1e-13);
    }
}

/* [C-13; Gross81; Ehlert93]: parallel at distance z, sides parallel: sums of a function over the corners. */
static double parallel_term(double u, double v, double z) {
    double p = sqrt(u * u + z * z), q = sqrt(v * v + z * z);
    return (v * p * atan(v / p) + u * q * atan(u / q) - 0.5 * z * z * log(u * u + v * v + z * z)) / (2 * PI);
}

static double displaced_parallel(const double a[4], const double b[4], double z) {
    double sum = 0.0;
    for (int i = 0; i < 16; i++) {
        double u = a[i & 1] - b[i >> 1 & 1], v = a[2 + (i >> 2 & 1)] - b[2 + (i >> 3 & 1)];
        sum += ((i ^ i >> 1 ^ i >> 2 ^ i >> 3) & 1 ? -1 : 1) * parallel_term(u, v, z);
    }
    return sum / ((a[1] - a[0]) * (a[3] - a[2]));
}

static void displaced_parallel_rectangles(void) {
    static const double cases[][9] = {
        { 0, 1, 0, 1, 2, 3, 1, 2, 1 },   { 0, 1, 0, 1, 0.5, 1.5, 0.25, 0.75, 0.3 },
        { 0, 2, 0, 1, -4, -1, 3, 5, 2 }, { 0, 1, 0, 1, 0.4, 0.6, 0.4, 0.6, 0.05 },
        { 0, 1, 0, 1, 1, 2, 0, 1, 1 },   { 0, 3, 0, 3, 1, 2, 1, 2, 5 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double *c = cases[i];
        shape down = floor_of(c[0], c[1], c[2], c[3], 0), up = ceiling_of(c[4], c[5], c[6], c[7], c[8]);
        /* Sixteen terms of the order of 10. */
        check_pair(&down, &up, displaced_parallel(c, c + 4, c[8]), 1e-14);
    }
}

/* [C-15; Gross81; Ehlert93]: a in the plane z = 0, at x and y; b in the plane x = 0, at y and z. */
static double perpendicular_term(double x, double dy, double z) {
    double c2 = x * x + z * z, c = sqrt(c2), square = c2 + dy * dy;
    double angle = c > 0 ? dy * c * atan(dy / c) : 0.0;
    return (angle - (square > 0 ? 0.25 * (c2 - dy * dy) * log(square) : 0.0)) / (2 * PI);
}

static double displaced_perpendicular(const double a[4], const double b[4]) {
    double sum = 0.0;
    for (int i = 0; i < 16; i++) {
        double x = a[i & 1], dy = a[2 + (i >> 2 & 1)] - b[i >> 3 & 1], z = b[2 + (i >> 1 & 1)];
        sum += ((i ^ i >> 1 ^ i >> 2 ^ i >> 3) & 1 ? 1 : -1) * perpendicular_term(x, dy, z);
    }
    return fabs(sum) / ((a[1] - a[0]) * (a[3] - a[2]));
}

static void displaced_perpendicular_rectangles(void) {
    static const double cases[][8] = {
        { 1, 2, 0, 1, 2, 3, 0.5, 2 }, { 0, 1, 0, 1, 1, 2, 0, 1 },     { 0, 1, 0, 1, 0.3, 0.6, 0, 0.4 },
        { 0, 2, 0, 1, -1, 4, 0, 3 },  { 0.2, 1, 0, 1, 0.5, 5, 0, 1 }, { 0, 1, 0, 1, 0.2, 0.8, 0.1, 2 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double *c = cases[i];
        shape down = floor_of(c[0], c[1], c[2], c[3], 0), side = wall_of(0, c[4], c[5], c[6], c[7]);
        check_pair(&down, &side, displaced_perpendicular(c, c + 4), 1e-14);
    }
}

/* Gauss-Legendre with five points [Abramowitz64, table 25.4] on panels. */
static const double GAUSS_X[5] = { 0.0469100770306680036, 0.2307653449471584545, 0.5, 0.7692346550528415455,
                                   0.9530899229693319964 };
static const double GAUSS_W[5] = { 0.1184634425280945438, 0.239314335249683234, 0.2844444444444444444,
                                   0.239314335249683234, 0.1184634425280945438 };

/* [C-16; Feingold66]: from the rectangle of width B to that of width A, common edge of length 1, angle phi between. */
static double any_angle(double A, double B, double phi) {
    double s = sin(phi), c = cos(phi), C = A * A + B * B - 2 * A * B * c, D = sqrt(1 + A * A * s * s), sum = 0.0;
    sum -= sin(2 * phi) / 4 *
           (A * B * s + (PI / 2 - phi) * (A * A + B * B) + B * B * atan((A - B * c) / (B * s)) +
            A * A * atan((B - A * c) / (A * s)));
    sum += s * s / 4 *
           ((2 / (s * s) - 1) * log((1 + A * A) * (1 + B * B) / (1 + C)) +
            B * B * log(B * B * (1 + C) / (C * (1 + B * B))) +
            A * A * log(A * A * pow(1 + A * A, cos(2 * phi)) / (C * pow(1 + C, cos(2 * phi)))));
    sum += B * atan(1 / B) + A * atan(1 / A) - sqrt(C) * atan(1 / sqrt(C));
    sum += s * sin(2 * phi) / 2 * A * D * (atan(A * c / D) + atan((B - A * c) / D));
    for (int i = 0; i < 5 * 40; i++) {
        double z = B * (i / 5 + GAUSS_X[i % 5]) / 40, root = sqrt(1 + z * z * s * s);
        sum += c * B / 40 * GAUSS_W[i % 5] * root * (atan(z * c / root) + atan((A - z * c) / root));
    }
    return sum / (PI * B);
}

static void rectangles_on_a_common_edge_at_any_angle(void) {
    for (double phi = 0.15; phi < 3; phi += 0.3)
        for (double A = 0.3; A < 3; A *= 2.5) {
            shape floor = floor_of(0, 1.2, 0, 1, 0);
            shape flap = parallelogram(ORIGIN, (double[]){ 0, 1, 0 }, (double[]){ A * cos(phi), 0, A * sin(phi) });
            /* Terms of the order of 3 cancel; the last integral is smooth over panels of 0.03. */
            check_pair(&floor, &flap, any_angle(A, 1.2, phi), 1e-13);
        }
}

/* ---- discs and spheres ---- */

/* [C-41]: from r1 to r2, on one axis at distance h. */
static double coaxial_discs(double r1, double r2, double h) {
    double R1 = r1 / h, R2 = r2 / h, X = 1 + (1 + R2 * R2) / (R1 * R1);
    return 0.5 * (X - sqrt(X * X - 4 * (R2 / R1) * (R2 / R1)));
}

static double pair_value(const shape *a, const shape *b) {
    factor_request request = { .relative = 1e-10 };
    factor_estimate e = polygon_pair_factor(loop_of(a), loop_of(b), &request);
    CHECK(e.converged);
    return e.value;
}

static void coaxial_discs_of_many_sizes(void) {
    static const double cases[][3] = { { 1, 1, 1 }, { 0.5, 2, 1 }, { 1, 0.3, 0.5 }, { 1, 1, 4 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double r1 = cases[i][0], r2 = cases[i][1], h = cases[i][2], at[3];
        for (int k = 0; k < 3; k++) {
            shape a = disc_below(16 << k, r1, 0, 0), b = disc_above(16 << k, r2, 0, h);
            at[k] = pair_value(&a, &b);
        }
        CHECK(fabs(at[1] - at[2]) < fabs(at[0] - at[1]) / 8);
        /* n = 64: (pi / 64)^6 = 1e-8, with a factor below 1. */
        CHECK_NEAR(extrapolate(at[1], at[2]), coaxial_discs(r1, r2, h), 1e-8);
    }
}

static void turn_over(shape *s) {
    for (size_t i = 0, k = s->count - 1; i < k; i++, k--) {
        double t[3];
        vec3_copy(t, s->corner[i]);
        vec3_copy(s->corner[i], s->corner[k]);
        vec3_copy(s->corner[k], t);
    }
}

/* Rings are discs less discs; outlines that are not convex. */
static void coaxial_rings(void) {
    double o1 = 1, i1 = 0.5, o2 = 0.8, i2 = 0.3, h = 0.6, at[3];
    double expected = (o1 * o1 * (coaxial_discs(o1, o2, h) - coaxial_discs(o1, i2, h)) -
                       i1 * i1 * (coaxial_discs(i1, o2, h) - coaxial_discs(i1, i2, h))) /
                      (o1 * o1 - i1 * i1);
    for (int k = 0; k < 3; k++) {
        shape above = keyhole(16 << k, o2, h, i2, h), below = keyhole(16 << k, o1, 0, i1, 0);
        turn_over(&below);
        at[k] = pair_value(&below, &above);
    }
    CHECK_NEAR(extrapolate(at[1], at[2]), expected, 1e-8);
}

/* Two circles on a sphere: all that passes one and the other goes from cap to cap, of which each sees its share
 * [Moon36]. The discs may stand at any angle. */
static void discs_on_a_common_sphere(void) {
    double first = 0.6, second = 0.8;
    for (double between = first + second + 0.1; between < PI; between += 0.4) {
        double at[3];
        for (int k = 0; k < 3; k++) {
            shape a = { .count = 0 }, b = { .count = 0 };
            add_ring(&a, 16 << k, sin(first), (double[]){ 0, 0, cos(first) }, (double[]){ 0, 1, 0 },
                     (double[]){ 1, 0, 0 });
            double c = cos(between), s = sin(between);
            add_ring(&b, 16 << k, sin(second), (double[]){ s * cos(second), 0, c * cos(second) }, (double[]){ 0, 1, 0 },
                     (double[]){ c, 0, -s });
            at[k] = pair_value(&a, &b);
        }
        double caps = 0.5 * (1 - cos(first)) * 2 * PI * (1 - cos(second));
        /* The nearest are 0.1 apart, two edges of the coarse outline; n = 64 leaves (pi / 64)^4 / 15. */
        CHECK_NEAR(extrapolate(at[1], at[2]), caps / (PI * sin(first) * sin(first)), 1e-6);
    }
}

/* A point to a disc beside its axis, integrated over the rectangle: a second way from there on. */
static void a_disc_and_a_parallel_rectangle(void) {
    double r = 0.7, h = 0.9, at[2], expected = 0.0;
    for (int i = 0; i < 2500; i++) {
        double x = 0.1 + 1.1 * (i / 5 % 10 + GAUSS_X[i % 5]) / 10,
               y = -0.3 + 0.8 * (i / 250 + GAUSS_X[i / 50 % 5]) / 10;
        double l = hypot(x, y), R = r / l, H = h / l, Z = 1 + H * H + R * R;
        expected +=
            GAUSS_W[i % 5] * GAUSS_W[i / 50 % 5] / 100 * 0.5 * (1 - (1 + H * H - R * R) / sqrt(Z * Z - 4 * R * R));
    }
    for (int k = 0; k < 2; k++) {
        shape disc = disc_above(32 << k, r, 0, h), rectangle = floor_of(0.1, 1.2, -0.3, 0.5, 0);
        at[k] = pair_value(&rectangle, &disc);
    }
    /* n = 64, as for the discs. */
    CHECK_NEAR(extrapolate(at[0], at[1]), expected, 1e-9);
}

/* The mean of the factors to a sphere over a rectangle, in n x n panels of five points squared. */
static double rectangle_to_sphere(int corners, double l1, double l2, double d, double radius, int panels) {
    double sum = 0.0, center[3] = { 0, 0, d };
    for (int i = 0; i < 25 * panels * panels; i++) {
        double s = (i / 25 % panels + GAUSS_X[i % 5]) / panels, t = (i / 25 / panels + GAUSS_X[i / 5 % 5]) / panels;
        double point[3] = { l1 * s, l2 * t, 0 };
        shape outline = sphere_outline(corners, point, center, radius);
        sum += GAUSS_W[i % 5] * GAUSS_W[i / 5 % 5] * polygon_loop_factor(loop_of(&outline), point, UP);
    }
    return sum / (panels * panels);
}

static void a_sphere_and_a_rectangle_or_a_disc(void) {
    /* [Feingold70]: the rectangle's corner lies under the centre. By reciprocity. */
    double l1 = 1.5, l2 = 0.8, d = 1, radius = 0.5, D1 = d / l1, D2 = d / l2;
    double expected = atan(1 / sqrt(D1 * D1 + D2 * D2 + D1 * D1 * D2 * D2)) / (4 * PI);
    double coarse = rectangle_to_sphere(16, l1, l2, d, radius, 4), fine = rectangle_to_sphere(32, l1, l2, d, radius, 4);
    /* n = 32: (pi / 32)^6 = 9e-7 of a value of 0.04, which is 0.3 of the ratio of areas. */
    CHECK_NEAR(extrapolate(coarse, fine) * l1 * l2 / (4 * PI * radius * radius), expected, 1e-8);
    /* [Feingold70]: a disc of radius r on the axis, (1 - 1 / sqrt(1 + r^2 / d^2)) / 2. */
    double sum = 0.0, r = 1.2, center[3] = { 0, 0, d };
    for (int i = 0; i < 50; i++) {
        double at[2], x = r * (i / 5 + GAUSS_X[i % 5]) / 10, point[3] = { x, 0, 0 };
        for (int k = 0; k < 2; k++) {
            shape outline = sphere_outline(32 << k, point, center, radius);
            at[k] = polygon_loop_factor(loop_of(&outline), point, UP);
        }
        sum += 2 * PI * x * GAUSS_W[i % 5] * r / 10 * extrapolate(at[0], at[1]);
    }
    CHECK_NEAR(sum / (4 * PI * radius * radius), 0.5 * (1 - 1 / sqrt(1 + r * r / (d * d))), 1e-8);
}

/* ---- long strips: crossed strings [Hottel67, sec. 2.3] ---- */

/* Between a1-a2 and b1-b2 in the plane, each seen from its front (left of its direction). */
static double crossed_strings(const double a[4], const double b[4]) {
    double crossed = hypot(a[0] - b[0], a[1] - b[1]) + hypot(a[2] - b[2], a[3] - b[3]);
    double uncrossed = hypot(a[0] - b[2], a[1] - b[3]) + hypot(a[2] - b[0], a[3] - b[1]);
    return (crossed - uncrossed) / (2 * hypot(a[2] - a[0], a[3] - a[1]));
}

static shape strip(const double a[4], double half_length) {
    shape s = { .count = 0 };
    add(&s, a[0], half_length, a[1]), add(&s, a[0], -half_length, a[1]);
    add(&s, a[2], -half_length, a[3]), add(&s, a[2], half_length, a[3]);
    return s;
}

/* The mean over the middle of a of the factor to b, which is 1e6 long. */
static double strip_factor(const double a[4], const double b[4]) {
    double e[3] = { a[2] - a[0], 0, a[3] - a[1] }, normal[3] = { -e[2], 0, e[0] }, sum = 0.0;
    shape far = strip(b, LONG);
    vec3_normalize(normal);
    for (int i = 0; i < 5 * 64; i++) {
        double t = (i / 5 + GAUSS_X[i % 5]) / 64, point[3] = { a[0] + t * e[0], 0, a[1] + t * e[2] };
        sum += GAUSS_W[i % 5] / 64 * polygon_loop_factor(loop_of(&far), point, normal);
    }
    return sum;
}

static void long_strips_have_the_factor_of_the_crossed_strings(void) {
    /* Fronts face each other; a runs to the right below, b to the left above. */
    static const double cases[][8] = {
        { 0, 0, 1, 0, 1, 1, 0, 1 },       { 0, 0, 1, 0, 4, 2, 1, 1 },      { 0, 0, 2, 0, 2.5, 0.5, 2.5, 3 },
        { 0, 0, 1, 0, 0.7, 1, 0.4, 0.3 }, { 0, 0, 1, 0, 1, 0.2, -3, 0.4 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double *a = cases[i], *b = cases[i] + 4;
        /* 64 panels of five points: what is nearest is 0.2 away. The ends miss 1e-12. */
        CHECK_NEAR(strip_factor(a, b), crossed_strings(a, b), 1e-10);
    }
    /* Opposite, sqrt(1 + H^2) - H. */
    CHECK_NEAR(strip_factor(cases[0], cases[0] + 4), sqrt(2.0) - 1, 1e-10);
}

static void long_wedges_and_triangles(void) {
    for (double angle = 0.3; angle < 3; angle += 0.4) {
        const double a[4] = { 0, 0, 1, 0 }, b[4] = { cos(angle), sin(angle), 0, 0 };
        /* Plates of one width, 1 - sin(angle / 2). The integrand is smooth up to the common edge. */
        CHECK_NEAR(strip_factor(a, b), 1 - sin(0.5 * angle), 1e-10);
        const double lid[4] = { 1, 0, cos(angle), sin(angle) };
        /* Three strips that close a triangle: (A1 + A3 - A2) / (2 A1). */
        double third = 2 * sin(0.5 * angle);
        CHECK_NEAR(strip_factor(a, lid), 0.5 * third, 1e-10);
        /* The same as polygons of length 2e4: the ends miss some widths over the length. */
        shape first = strip(a, 1e4), second = strip(b, 1e4);
        factor_request request = { .relative = 1e-6 };
        factor_estimate e = polygon_pair_factor(loop_of(&first), loop_of(&second), &request);
        check_estimate(e, 1 - sin(0.5 * angle), 1e-6, 1e-4);
    }
    /* At a right angle, (1 + H - sqrt(1 + H^2)) / 2. */
    for (double H = 0.1; H < 20; H *= 3) {
        const double a[4] = { 0, 0, 1, 0 }, b[4] = { 0, H, 0, 0 };
        /* A short wall changes its look over H / 5: the panels of 1/64 still resolve it. */
        CHECK_NEAR(strip_factor(a, b), 0.5 * (1 + H - sqrt(1 + H * H)), 1e-9);
    }
}

/* ---- inside of closed bodies ---- */

static void the_inside_of_a_box(void) {
    for (double a = 0.2; a < 4; a *= 3)
        for (double b = 0.5; b < 3; b *= 2) {
            shape floor = floor_of(0, a, 0, b, 0), lid = ceiling_of(0, a, 0, b, 1), left = wall_of(0, 0, b, 0, 1);
            shape front = parallelogram(ORIGIN, (double[]){ 0, 0, 1 }, (double[]){ a, 0, 0 });
            double to_lid = pair_value(&floor, &lid), to_left = pair_value(&floor, &left);
            double to_front = pair_value(&floor, &front);
            /* Five estimates of 1e-10 each. */
            CHECK_NEAR(to_lid + 2 * to_left + 2 * to_front, 1.0, 1e-9);
            CHECK_NEAR(to_lid, opposite_rectangles(a, b, 1), 1e-10);
            CHECK_NEAR(to_left, right_angle(1 / b, a / b), 1e-10);
        }
}

static void the_inside_of_a_tetrahedron(void) {
    shape a = { { { 1, 1, 1 }, { -1, 1, -1 }, { 1, -1, -1 } }, 3 },
          b = { { { 1, 1, 1 }, { 1, -1, -1 }, { -1, -1, 1 } }, 3 };
    /* Three equal neighbours close it. */
    check_pair(&a, &b, 1.0 / 3.0, 1e-15);
}

static void the_inside_of_a_cylinder(void) {
    enum { N = 48 };
    shape floor = disc_below(N, 1, 0, 0), lid = disc_above(N, 1, 0, 1.3);
    double sum = pair_value(&floor, &lid), wall = 0.0, first_to_floor = 0.0, first_to_rest = 0.0;
    shape sides[N];
    for (int i = 0; i < N; i++) {
        const double *a = floor.corner[i], *b = floor.corner[(i + 1) % N];
        sides[i] = parallelogram(b, (double[]){ a[0] - b[0], a[1] - b[1], 0 }, (double[]){ 0, 0, 1.3 });
    }
    for (int i = 0; i < N; i++) wall += pair_value(&floor, &sides[i]);
    for (int i = 1; i < N; i++) first_to_rest += pair_value(&sides[0], &sides[i]);
    first_to_floor = pair_value(&sides[0], &floor) + pair_value(&sides[0], &lid);
    /* The prism closes exactly; N estimates of 1e-10 of their values. */
    CHECK_NEAR(sum + wall, 1.0, 1e-9);
    CHECK_NEAR(first_to_floor + first_to_rest, 1.0, 1e-9);
    /* [Howell82]: of the light of a cylinder's wall 1 + H - sqrt(1 + H^2) stays, H = h / (2 r). The
     * prism differs by (pi / 48)^2 times a logarithm. */
    double H = 1.3 / 2;
    CHECK_NEAR(first_to_rest, 1 + H - sqrt(1 + H * H), 5e-3);
    /* [C-41]; the prism's disc by the fourth order. */
    CHECK_NEAR(sum, coaxial_discs(1, 1, 1.3), 1e-5);
}

static void the_inside_of_a_half_ball(void) {
    /* Over a disc all light goes to the dome: any outline around the rim, as a loop seen from the disc, is everything.
     */
    for (double x = 0; x < 0.95; x += 0.3) {
        shape rim = disc_above(512, 1, 0, 1e-9);
        double point[3] = { x, 0.1, 0 };
        /* The rim is 1e-9 above the horizon, 0.04 away at the least. */
        CHECK_NEAR(polygon_loop_factor(loop_of(&rim), point, UP), 1.0, 1e-12);
    }
}

/* ---- what does not see each other ---- */

static void only_what_is_in_front_counts(void) {
    shape floor = floor_of(0, 1, 0, 1, 0), wall = wall_of(0, 0, 1, -3, 1), pierced = floor_of(-2, 1, 0, 1, 0);
    /* What lies below the floor gets nothing; what lies behind the wall sends nothing. */
    check_pair(&floor, &wall, right_angle(1, 1), 1e-14);
    check_pair(&pierced, &wall, right_angle(1, 1) / 3, 1e-14);
    const shape none[] = { floor_of(0, 1, 0, 1, 1),     ceiling_of(0, 1, 0, 1, -1), floor_of(1, 2, 0, 1, 0),
                           ceiling_of(0.5, 2, 0, 1, 0), wall_of(2, 0, 1, 0, 1),     floor_of(0, 1, 0, 1, 0) };
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        factor_estimate e = polygon_pair_factor(loop_of(&floor), loop_of(&none[i]), NULL);
        CHECK_NEAR(e.value, 0.0, 0);
        CHECK_NEAR(e.error, 0.0, 0);
        CHECK(e.converged);
    }
}

int main(void) {
    RUN(a_point_and_a_parallel_or_perpendicular_rectangle);
    RUN(a_point_and_a_tilted_rectangle);
    RUN(a_point_and_a_triangle);
    RUN(a_point_and_a_regular_polygon_on_its_axis);
    RUN(a_point_and_a_disc);
    RUN(a_point_and_an_ellipse_on_its_axis);
    RUN(a_point_and_a_ring_or_the_inside_of_a_cylinder);
    RUN(a_point_and_a_sphere_above_or_through_the_horizon);
    RUN(a_point_inside_a_sphere_sees_any_cap_as_its_share);
    RUN(a_point_and_a_long_strip_or_an_endless_plane);
    RUN(the_two_figures_of_the_unit_squares);
    RUN(opposite_rectangles_of_many_sizes);
    RUN(rectangles_at_a_right_angle_of_many_sizes);
    RUN(displaced_parallel_rectangles);
    RUN(displaced_perpendicular_rectangles);
    RUN(rectangles_on_a_common_edge_at_any_angle);
    RUN(coaxial_discs_of_many_sizes);
    RUN(coaxial_rings);
    RUN(discs_on_a_common_sphere);
    RUN(a_disc_and_a_parallel_rectangle);
    RUN(a_sphere_and_a_rectangle_or_a_disc);
    RUN(long_strips_have_the_factor_of_the_crossed_strings);
    RUN(long_wedges_and_triangles);
    RUN(the_inside_of_a_box);
    RUN(the_inside_of_a_tetrahedron);
    RUN(the_inside_of_a_cylinder);
    RUN(the_inside_of_a_half_ball);
    RUN(only_what_is_in_front_counts);
    return check_end();
}
