/* SPDX-License-Identifier: MIT
 * Are the area, the weights and the nearest point of a triangle those of the textbook?
 */
#include "check.h"

#include "base/splitmix.h"
#include "geometry/triangle.h"

/* Legs 3 and 4 in a plane z = 2. */
static const double A[3] = { 1, 1, 2 }, B[3] = { 4, 1, 2 }, C[3] = { 1, 5, 2 };

static void the_cross_product_is_twice_the_area_on_the_front(void) {
    double n[3];
    triangle_cross(n, A, B, C);
    CHECK_NEAR(n[0], 0.0, 0.0);
    CHECK_NEAR(n[1], 0.0, 0.0);
    CHECK_NEAR(n[2], 12.0, 0.0);
    CHECK_NEAR(triangle_longest_squared(A, B, C), 25.0, 0.0);
    CHECK_NEAR(triangle_longest_squared(B, C, A), 25.0, 0.0);
    CHECK_NEAR(triangle_longest_squared(C, A, B), 25.0, 0.0);
}

static void a_needle_is_degenerate_where_the_tolerance_says(void) {
    double b[3] = { 1, 0, 0 }, zero[3] = { 0, 0, 0 }, n[3];
    for (int side = 0; side < 2; side++) {
        /* Area 1/2 h against the square of the longest edge, 1. */
        double c[3] = { 0.5, 2 * TOLERANCE_DEGENERATE * (side ? 1.01 : 0.99), 0 };
        triangle_cross(n, zero, b, c);
        CHECK_EQUAL(triangle_is_degenerate(vec3_length(n), triangle_longest_squared(zero, b, c)), !side);
    }
    CHECK(triangle_is_degenerate(0.0, 0.0));
    CHECK(triangle_is_degenerate(NAN, 1.0));
}

static void weights_give_the_point_back(void) {
    for (uint64_t i = 0; i < 200; i++) {
        double own[3] = { 0, 4 * splitmix_unit(3 * i) - 2, 4 * splitmix_unit(3 * i + 1) - 2 }, x[3], w[3];
        own[0] = 1 - own[1] - own[2];
        for (int k = 0; k < 3; k++) x[k] = own[0] * A[k] + own[1] * B[k] + own[2] * C[k];
        x[2] += splitmix_unit(3 * i + 2); /* off the plane, which changes nothing */
        CHECK(triangle_weights(w, A, B, C, x));
        /* Roundings of numbers up to 100, over a determinant of 144. */
        for (int k = 0; k < 3; k++) CHECK_NEAR(w[k], own[k], 1e-14);
    }
    double w[3];
    CHECK(!triangle_weights(w, A, B, B, C));
}

static void check_nearest(double x, double y, double z, double squared, double a, double b, double c) {
    const double at[3] = { x, y, z };
    double w[3];
    CHECK_NEAR(triangle_nearest(w, A, B, C, at), squared, 1e-13);
    CHECK_NEAR(w[0], a, 1e-14);
    CHECK_NEAR(w[1], b, 1e-14);
    CHECK_NEAR(w[2], c, 1e-14);
}

static void the_nearest_point_is_inside_on_an_edge_or_a_corner(void) {
    check_nearest(2, 2, 5, 9, 5 / 12., 1 / 3., 1 / 4.);
    check_nearest(2, 0, 2, 1, 2 / 3., 1 / 3., 0);
    check_nearest(0, 2, 3, 2, 3 / 4., 0, 1 / 4.);
    check_nearest(0, 0, 2, 2, 1, 0, 0);
    check_nearest(9, 1, 2, 25, 0, 1, 0);
    check_nearest(1, 6, 0, 5, 0, 0, 1);
    /* From the middle of the hypotenuse outwards along its normal, (4, 3) / 5. */
    check_nearest(2.5 + 0.8, 3 + 0.6, 2, 1, 0, 0.5, 0.5);
}

static void a_triangle_without_area_is_its_edges(void) {
    const double end[3] = { 2, 0, 0 }, middle[3] = { 1, 0, 0 }, zero[3] = { 0, 0, 0 }, x[3] = { 1.5, 3, 0 };
    double w[3];
    CHECK_NEAR(triangle_nearest(w, zero, end, middle, x), 9.0, 1e-14);
    CHECK_NEAR(w[0] * zero[0] + w[1] * end[0] + w[2] * middle[0], 1.5, 1e-14);
    CHECK_NEAR(triangle_nearest(w, zero, zero, zero, x), 11.25, 1e-14);
    CHECK_NEAR(w[0] + w[1] + w[2], 1.0, 0.0);
}

int main(void) {
    RUN(the_cross_product_is_twice_the_area_on_the_front);
    RUN(a_needle_is_degenerate_where_the_tolerance_says);
    RUN(weights_give_the_point_back);
    RUN(the_nearest_point_is_inside_on_an_edge_or_a_corner);
    RUN(a_triangle_without_area_is_its_edges);
    return check_end();
}
