/* SPDX-License-Identifier: MIT
 * Are directions spread evenly over what a polygon fills? Their mean cosine times the solid angle is the form factor
 * times pi, which the closed form gives by another way; and each of them meets the polygon.
 */
#include "base/sobol.h"
#include "check.h"
#include "geometry/spherical_polygon.h"
#include "geometry/vec3.h"

static const double ORIGIN[3] = { 0, 0, 0 };

enum { POINTS = 1 << 14 };

static polygon shape(const double corners[][3], int count) {
    polygon p = { .count = count };
    for (int i = 0; i < count; i++) vec3_copy(p.corner[i], corners[i]);
    return p;
}

/* On the plane of a convex polygon, and how far outside of its worst edge in its size; below 0 inside. */
static double outside(const polygon *p, const double direction[3]) {
    double area[3], normal[3], at[3], worst = -INFINITY, size = 0.0;
    polygon_vector_area(p, area), vec3_copy(normal, area), vec3_normalize(normal);
    vec3_add_scaled(at, ORIGIN, vec3_dot(p->corner[0], normal) / vec3_dot(direction, normal), direction);
    for (int i = 0; i < p->count; i++) {
        double edge[3], out[3], from[3];
        vec3_sub(edge, p->corner[(i + 1) % p->count], p->corner[i]);
        vec3_cross(out, edge, normal), vec3_normalize(out), vec3_sub(from, at, p->corner[i]);
        worst = fmax(worst, vec3_dot(from, out)), size = fmax(size, vec3_length(edge));
    }
    return worst / size;
}

static void spreads_evenly(const polygon *p, double tolerance) {
    const double normals[3][3] = { { 0, 0, 1 }, { 0.6, 0, 0.8 }, { 0, -0.6, 0.8 } };
    double sums[3] = { 0 };
    spherical_polygon s;
    spherical_polygon_set(&s, p, ORIGIN);
    CHECK(s.solid_angle > 0 && s.triangles == p->count - 2);
    for (uint32_t i = 0; i < POINTS; i++) {
        double square[2], direction[3];
        sobol_2d(i, 7, square);
        spherical_polygon_direction(&s, square, direction);
        CHECK_NEAR(vec3_length(direction), 1.0, 1e-12);
        CHECK(outside(p, direction) < 1e-6);
        for (int k = 0; k < 3; k++) sums[k] += fmax(vec3_dot(direction, normals[k]), 0.0);
    }
    for (int k = 0; k < 3; k++) {
        double factor = fabs(polygon_factor(p, ORIGIN, normals[k]));
        CHECK_NEAR(sums[k] / POINTS * s.solid_angle / PI, factor, tolerance * factor);
    }
}

static void an_octant_is_half_pi(void) {
    const polygon p = shape((double[][3]){ { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, 3);
    spherical_polygon s;
    spherical_polygon_set(&s, &p, ORIGIN);
    CHECK_NEAR(s.solid_angle, 0.5 * PI, 1e-14);
}

static void mean_cosines_are_form_factors(void) {
    const polygon above = shape((double[][3]){ { -1, -1, 1 }, { 1, -1, 1 }, { 1, 1, 1 }, { -1, 1, 1 } }, 4);
    const polygon close = shape((double[][3]){ { -5, -2, 0.02 }, { 7, -2, 0.02 }, { 7, 9, 0.02 }, { -5, 9, 0.02 } }, 4);
    const polygon wall =
        shape((double[][3]){ { 2, -1, 0.1 }, { 2, 3, 0.1 }, { 2, 3, 4 }, { 2, 0, 5 }, { 2, -1, 4 } }, 5);
    const polygon back = shape((double[][3]){ { 2, 3, 1 }, { 2, -1, 1 }, { 2, 0, 4 } }, 3);
    spreads_evenly(&above, 1e-4);
    spreads_evenly(&close, 1e-3);
    spreads_evenly(&wall, 1e-3);
    spreads_evenly(&back, 1e-3);
}

static void small_and_long_ones_are_filled_too(void) {
    const polygon small = shape((double[][3]){ { 1, 1, 3 }, { 1.004, 1, 3 }, { 1, 1.003, 3 } }, 3);
    const polygon strip = shape((double[][3]){ { -4, 0.3, 1 }, { 4, 0.3, 1 }, { 4, 0.301, 1 }, { -4, 0.301, 1 } }, 4);
    spreads_evenly(&small, 1e-3);
    spreads_evenly(&strip, 1e-3);
}

static void what_is_seen_edge_on_or_is_none_fills_nothing(void) {
    const polygon edge = shape((double[][3]){ { 1, 0, 0 }, { 2, 0, 0 }, { 1, 0, 1 } }, 3);
    const polygon touched = shape((double[][3]){ { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } }, 3);
    const polygon line = shape((double[][3]){ { 1, 0, 1 }, { 2, 0, 1 } }, 2);
    spherical_polygon s;
    spherical_polygon_set(&s, &edge, ORIGIN);
    CHECK(s.solid_angle == 0.0);
    spherical_polygon_set(&s, &touched, ORIGIN);
    CHECK(s.solid_angle == 0.0);
    spherical_polygon_set(&s, &line, ORIGIN);
    CHECK(s.solid_angle == 0.0);
}

int main(void) {
    RUN(an_octant_is_half_pi);
    RUN(mean_cosines_are_form_factors);
    RUN(small_and_long_ones_are_filled_too);
    RUN(what_is_seen_edge_on_or_is_none_fills_nothing);
    return check_end();
}
