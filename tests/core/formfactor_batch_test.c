/* SPDX-License-Identifier: MIT
 * Does the batch kernel give the same bits on every machine, and what the exact factor gives, near corners and edges,
 * too? The source is compiled a second time without dispatch, and a third time for AVX2 where the compiler can.
 */
#include "check.h"
#include "geometry/polygon.h"
#include "geometry/vec3.h"

#include <stdbool.h>
#include <stdint.h>

void portable_polygon_loop_factor_batch(polygon_loop loop, const double normal[3], const double *x, const double *y,
                                        const double *z, size_t count, double *factors);
void avx2_polygon_loop_factor_batch(polygon_loop loop, const double normal[3], const double *x, const double *y,
                                    const double *z, size_t count, double *factors);

enum { POINTS = 200, CORNERS_MAX = 40 };

static const double UP[3] = { 0, 0, 1 };

typedef struct points {
    double x[POINTS], y[POINTS], z[POINTS], factors[POINTS];
} points;

typedef struct shape {
    double corner[CORNERS_MAX][3];
    size_t count;
} shape;

static double random_between(uint64_t *state, double low, double high) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

/* Corners at random heights above the plane z = 0, in random order of angle: loops of all sorts. */
static shape random_loop(uint64_t *seed, double size) {
    shape s = { .count = 3 + (size_t)random_between(seed, 0, CORNERS_MAX - 3) };
    for (size_t i = 0; i < s.count; i++) {
        double angle = 6.28 * (double)i / (double)s.count, r = random_between(seed, 0.2, 1) * size;
        s.corner[i][0] = r * sin(angle), s.corner[i][1] = r * cos(angle);
        s.corner[i][2] = i % 7 == 0 ? 0.0 : random_between(seed, 0, size);
    }
    return s;
}

/* On the plane: anywhere, at corners' feet, on edges' feet, next to them. */
static void scatter(points *p, const shape *s, uint64_t *seed, double size) {
    for (size_t i = 0; i < POINTS; i++) {
        const double *a = s->corner[i % s->count], *b = s->corner[(i + 1) % s->count];
        double t = i % 3 ? random_between(seed, 0, 1) : 0.0, off = i % 5 ? pow(10, -(double)(i % 17)) * size : 0.0;
        p->x[i] = a[0] + t * (b[0] - a[0]) + off, p->y[i] = a[1] + t * (b[1] - a[1]), p->z[i] = 0;
        if (i % 4 == 0) p->x[i] = random_between(seed, -2, 2) * size, p->y[i] = random_between(seed, -2, 2) * size;
        p->factors[i] = 0.0;
    }
}

static void all_versions_give_the_same_bits(void) {
    static points one, two;
    uint64_t seed = 1;
    for (int i = 0; i < 300; i++) {
        double size = pow(10, i % 13 - 6);
        shape s = random_loop(&seed, size);
        polygon_loop loop = { s.corner, s.count };
        scatter(&one, &s, &seed, size);
        two = one;
        size_t count = (size_t)i % POINTS;
        polygon_loop_factor_batch(loop, UP, one.x, one.y, one.z, count, one.factors);
        portable_polygon_loop_factor_batch(loop, UP, two.x, two.y, two.z, count, two.factors);
        CHECK(memcmp(one.factors, two.factors, sizeof one.factors) == 0);
#ifdef TEST_AVX2
        if (!__builtin_cpu_supports("avx2")) continue;
        memset(two.factors, 0, sizeof two.factors);
        avx2_polygon_loop_factor_batch(loop, UP, two.x, two.y, two.z, count, two.factors);
        CHECK(memcmp(one.factors, two.factors, sizeof one.factors) == 0);
#endif
    }
}

static void a_point_has_the_same_bits_in_any_company(void) {
    static points all;
    uint64_t seed = 2;
    shape s = random_loop(&seed, 1);
    polygon_loop loop = { s.corner, s.count };
    scatter(&all, &s, &seed, 1);
    polygon_loop_factor_batch(loop, UP, all.x, all.y, all.z, POINTS, all.factors);
    for (size_t i = 0; i < POINTS; i++) {
        double alone = 0.0;
        polygon_loop_factor_batch(loop, UP, &all.x[i], &all.y[i], &all.z[i], 1, &alone);
        CHECK(memcmp(&alone, &all.factors[i], sizeof alone) == 0);
    }
}

static void near_corners_and_edges_it_agrees_with_the_exact_factor(void) {
    static points set;
    uint64_t seed = 3;
    for (int i = 0; i < 200; i++) {
        double size = pow(10, i % 13 - 6);
        shape s = random_loop(&seed, size);
        /* Off the plane: on it a foot of the loop may run through a point, where the exact rule and the bare sum
         * differ. */
        for (size_t k = 0; k < s.count; k++) s.corner[k][2] += 1e-6 * size;
        polygon_loop loop = { s.corner, s.count };
        scatter(&set, &s, &seed, size);
        polygon_loop_factor_batch(loop, UP, set.x, set.y, set.z, POINTS, set.factors);
        for (size_t k = 0; k < POINTS; k++) {
            double point[3] = { set.x[k], set.y[k], set.z[k] };
            /* A rounding of a coordinate over the nearest distance of 1e-6, which an edge's direction sees: 40 edges of
             * 2e-10; and the promise of the header for all that is no nearer than 1e-3. */
            double exact = polygon_loop_factor(loop, point, UP), nearest = INFINITY;
            for (size_t c = 0; c < s.count; c++) {
                double e[3], r[3];
                vec3_sub(e, s.corner[(c + 1) % s.count], s.corner[c]);
                vec3_sub(r, point, s.corner[c]);
                double t = fmin(fmax(vec3_dot(r, e) / vec3_dot(e, e), 0), 1);
                vec3_add_scaled(r, r, -t, e);
                nearest = fmin(nearest, vec3_length(r) / size);
            }
            CHECK_NEAR(set.factors[k], exact, nearest > 1e-3 ? 1e-13 : 1e-9);
        }
    }
}

static void on_corners_and_edges_it_stays_finite(void) {
    static points set;
    uint64_t seed = 4;
    for (int i = 0; i < 100; i++) {
        shape s = random_loop(&seed, 1);
        for (size_t k = 0; k < s.count; k++) s.corner[k][2] *= k % 3 == 0;
        scatter(&set, &s, &seed, 1);
        polygon_loop_factor_batch((polygon_loop){ s.corner, s.count }, UP, set.x, set.y, set.z, POINTS, set.factors);
        /* As many windings as a loop of 40 corners can have, each at most 1. */
        for (size_t k = 0; k < POINTS; k++) CHECK(fabs(set.factors[k]) <= 20);
    }
    double none = 3.0;
    polygon_loop_factor_batch((polygon_loop){ NULL, 0 }, UP, set.x, set.y, set.z, 1, &none);
    CHECK_NEAR(none, 3.0, 0);
}

int main(void) {
    RUN(all_versions_give_the_same_bits);
    RUN(a_point_has_the_same_bits_in_any_company);
    RUN(near_corners_and_edges_it_agrees_with_the_exact_factor);
    RUN(on_corners_and_edges_it_stays_finite);
    return check_end();
}
