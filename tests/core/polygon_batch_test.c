/* SPDX-License-Identifier: MIT
 * Does the vector kernel give what the plain closed form gives, and how much faster is it?
 */
#include "check.h"
#include "geometry/polygon.h"
#include "geometry/vec3.h"

#include <stdint.h>
#include <stdlib.h>
#include <time.h>

enum { POINTS = 4096 };

typedef struct points {
    double x[POINTS], y[POINTS], z[POINTS], factors[POINTS];
    size_t count;
} points;

static double random_between(uint64_t *state, double low, double high) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

/* A plane with a frame of its own: u x v = normal. */
typedef struct plane {
    double origin[3], u[3], v[3], normal[3];
} plane;

static plane random_plane(uint64_t *seed) {
    plane p;
    double helper[3];
    for (int k = 0; k < 3; k++) {
        p.origin[k] = random_between(seed, -3, 3);
        p.normal[k] = random_between(seed, -1, 1);
        helper[k] = random_between(seed, -1, 1);
    }
    vec3_normalize(p.normal);
    vec3_cross(p.u, helper, p.normal);
    vec3_normalize(p.u);
    vec3_cross(p.v, p.normal, p.u);
    return p;
}

static void place(double out[3], const plane *p, double s, double t, double height) {
    vec3_add_scaled(out, p->origin, s, p->u);
    vec3_add_scaled(out, out, t, p->v);
    vec3_add_scaled(out, out, height, p->normal);
}

static void scatter(points *set, const plane *p, size_t count, uint64_t *seed) {
    set->count = count;
    for (size_t i = 0; i < count; i++) {
        double x[3];
        place(x, p, random_between(seed, -4, 4), random_between(seed, -4, 4), 0);
        set->x[i] = x[0], set->y[i] = x[1], set->z[i] = x[2], set->factors[i] = 0.0;
    }
}

/* A random triangle, quad or pentagon (three corners and what a clip leaves) above the plane. */
static polygon random_polygon(const plane *p, uint64_t *seed) {
    polygon whole = { .count = 4 }, above;
    double a[3], b[3], c[3];
    place(a, p, random_between(seed, -2, 2), random_between(seed, -2, 2), random_between(seed, -0.5, 2));
    place(b, p, random_between(seed, -2, 2), random_between(seed, -2, 2), random_between(seed, -0.5, 2));
    place(c, p, random_between(seed, -2, 2), random_between(seed, -2, 2), random_between(seed, -0.5, 2));
    vec3_copy(whole.corner[0], a);
    vec3_copy(whole.corner[1], b);
    for (int k = 0; k < 3; k++) whole.corner[2][k] = b[k] + c[k] - a[k];
    vec3_copy(whole.corner[3], c);
    polygon_clip(&above, &whole, p->normal, vec3_dot(p->normal, p->origin) + 1e-6);
    return above;
}

static void many_points_agree_with_the_plain_closed_form(void) {
    static points set;
    uint64_t seed = 42;
    int drawn = 0;
    while (drawn < 30) {
        plane p = random_plane(&seed);
        polygon shape = random_polygon(&p, &seed);
        if (shape.count < 3) continue;
        drawn++;
        /* Counts that are no multiple of a vector's width are among them. */
        scatter(&set, &p, (size_t)(POINTS - drawn), &seed);
        polygon_factor_batch(&shape, p.normal, set.x, set.y, set.z, set.count, set.factors);
        for (size_t i = 0; i < set.count; i++) {
            double point[3] = { set.x[i], set.y[i], set.z[i] };
            /* What polygon.h promises. */
            CHECK_NEAR(set.factors[i], polygon_factor(&shape, point, p.normal), 1e-13);
        }
    }
}

static void results_add_to_what_is_there(void) {
    polygon shape = { { { 0, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 1, 0, 1 } }, 4 };
    const double up[3] = { 0, 0, 1 }, zero = 0.0;
    double once = 0.0, again = 5.0;
    polygon_factor_batch(&shape, up, &zero, &zero, &zero, 1, &once);
    polygon_factor_batch(&shape, up, &zero, &zero, &zero, 1, &again);
    /* A rounding of 5 for each edge. */
    CHECK_NEAR(again - 5.0, once, 4e-15);
    /* The unit square at unit distance over a corner [Howell82, B-3]. */
    CHECK_NEAR(once, 0.13853160599489298, 1e-15);
    polygon_factor_batch(&shape, up, &zero, &zero, &zero, 0, &once);
    CHECK_NEAR(once, 0.13853160599489298, 1e-15);
}

static void points_on_corners_and_edges_give_finite_factors(void) {
    static points set;
    const double up[3] = { 0, 0, 1 };
    /* A wall that stands on the plane of the points; the points run along its foot, through both of its ends. */
    polygon wall = { { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 1, 1 }, { 0, 0, 1 } }, 4 };
    set.count = 401;
    for (size_t i = 0; i < set.count; i++)
        set.x[i] = 0, set.y[i] = -0.5 + (double)i / 200, set.z[i] = 0, set.factors[i] = 0;
    polygon_factor_batch(&wall, up, set.x, set.y, set.z, set.count, set.factors);
    for (size_t i = 0; i < set.count; i++) {
        /* On the wall's foot the factor is between its limits of 0 and 1/2 (1/4 at the ends); false for NaN. */
        CHECK(set.factors[i] >= -1e-15 && set.factors[i] <= 0.5 + 1e-15);
    }
    /* Points on the corners and edges of a polygon in their own plane. */
    polygon flat = { { { 0, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 }, { 1, 0, 0 } }, 4 };
    for (size_t i = 0; i < set.count; i++) set.factors[i] = 0;
    polygon_factor_batch(&flat, up, set.x, set.y, set.z, set.count, set.factors);
    for (size_t i = 0; i < set.count; i++) CHECK(set.factors[i] >= -1e-15 && set.factors[i] <= 1 + 1e-15);
}

static void repeated_corners_change_nothing(void) {
    static points set, plain;
    uint64_t seed = 5;
    plane p = random_plane(&seed);
    polygon shape = { .count = 4 }, repeated = { .count = 6 };
    static const int order[6] = { 0, 0, 1, 2, 3, 3 };
    static const double square[4][2] = { { 0, 0 }, { 0, 1 }, { 1, 1 }, { 1, 0 } };
    for (int i = 0; i < 4; i++) place(shape.corner[i], &p, square[i][0], square[i][1], 1);
    for (int i = 0; i < 6; i++) vec3_copy(repeated.corner[i], shape.corner[order[i]]);
    scatter(&set, &p, 100, &seed);
    plain = set;
    polygon_factor_batch(&repeated, p.normal, set.x, set.y, set.z, set.count, set.factors);
    polygon_factor_batch(&shape, p.normal, plain.x, plain.y, plain.z, plain.count, plain.factors);
    /* An edge of two equal corners has a cross product of exactly 0. */
    for (size_t i = 0; i < set.count; i++) CHECK_NEAR(set.factors[i], plain.factors[i], 0);
}

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Prints; a clock is no judge on a machine that others use. What it checks is that both loops did the same work. */
static void the_speed_is_printed(void) {
    static points set;
    uint64_t seed = 3;
    plane p = random_plane(&seed);
    polygon shape;
    do shape = random_polygon(&p, &seed);
    while (shape.count != 4);
    scatter(&set, &p, POINTS, &seed);
    enum { ROUNDS = 50 };
    double begin = seconds(), sum = 0.0, batch = 0.0;
    for (int r = 0; r < ROUNDS; r++)
        polygon_factor_batch(&shape, p.normal, set.x, set.y, set.z, set.count, set.factors);
    double batch_s = seconds() - begin;
    begin = seconds();
    for (int r = 0; r < ROUNDS; r++)
        for (size_t i = 0; i < set.count; i++)
            sum += polygon_factor(&shape, (double[]){ set.x[i], set.y[i], set.z[i] }, p.normal);
    double plain_s = seconds() - begin, evaluations = (double)ROUNDS * POINTS;
    for (size_t i = 0; i < set.count; i++) batch += set.factors[i];
    /* 2e5 differences of at most 1e-13 each. */
    CHECK_NEAR(batch, sum, 2e-8);
    printf("quad: batch %.1f million factors a second, one by one %.1f, ratio %.1f\n", 1e-6 * evaluations / batch_s,
           1e-6 * evaluations / plain_s, plain_s / batch_s);
}

int main(void) {
    RUN(many_points_agree_with_the_plain_closed_form);
    RUN(results_add_to_what_is_there);
    RUN(points_on_corners_and_edges_give_finite_factors);
    RUN(repeated_corners_change_nothing);
    RUN(the_speed_is_printed);
    return check_end();
}
