/* SPDX-License-Identifier: MIT
 * Is the nearest point the nearest, among all triangles, and on the right side?
 */
#include "check.h"

#include "closest_point.h"

#include <stdlib.h>

static const float ANY[3] = { 0, 0, 0 };

/* Numbers that look random, in [-1, 1). */
static double next(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

/* Square of the distance to the point of a triangle at u, v. */
static double distance_at(const float *const p[3], const float point[3], double u, double v) {
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double d = (1 - u - v) * p[0][k] + u * p[1][k] + v * p[2][k] - point[k];
        sum += d * d;
    }
    return sum;
}

/* The least over a fine grid of all triangles: never less than the true distance, and little more. */
static double by_search(const float *positions, const uint32_t *indices, size_t triangles, const float point[3]) {
    enum { STEPS = 60 };
    double least = INFINITY;
    for (size_t t = 0; t < triangles; t++) {
        const float *const p[3] = { positions + 3 * (size_t)indices[3 * t], positions + 3 * (size_t)indices[3 * t + 1],
                                    positions + 3 * (size_t)indices[3 * t + 2] };
        for (int i = 0; i <= STEPS; i++)
            for (int j = 0; i + j <= STEPS; j++)
                least = fmin(least, distance_at(p, point, (double)i / STEPS, (double)j / STEPS));
    }
    return sqrt(least);
}

static void the_nearest_of_many_is_found(void) {
    enum { TRIANGLES = 200, POINTS = 200 };
    float positions[9 * TRIANGLES];
    uint32_t indices[3 * TRIANGLES];
    uint64_t state = 7;
    for (size_t t = 0; t < TRIANGLES; t++) {
        double middle[3] = { next(&state), next(&state), next(&state) };
        for (size_t i = 0; i < 9; i++) positions[9 * t + i] = (float)(middle[i % 3] + 0.1 * next(&state));
        for (size_t i = 0; i < 3; i++) indices[3 * t + i] = (uint32_t)(3 * t + i);
    }
    closest_point *tree = closest_point_create(NULL, NULL, positions, indices, TRIANGLES);
    for (int i = 0; i < POINTS; i++) {
        const float point[3] = { (float)next(&state), (float)next(&state), (float)next(&state) };
        closest_point_hit hit = closest_point_find(tree, point, ANY, 0.0, (uint32_t)i % TRIANGLES);
        double found = by_search(positions, indices, TRIANGLES, point), at = 0.0;
        /* The grid's points are at most 0.3 / 60 from the nearest one. */
        CHECK(hit.distance <= found + 1e-6 && hit.distance > found - 0.005);
        const float *const p[3] = { positions + 9 * (size_t)hit.triangle, positions + 9 * (size_t)hit.triangle + 3,
                                    positions + 9 * (size_t)hit.triangle + 6 };
        at = distance_at(p, point, hit.weights[1], hit.weights[2]);
        /* Doubles from floats of size 1. */
        CHECK_NEAR(sqrt(at), hit.distance, 1e-12);
        CHECK_NEAR(hit.weights[0] + hit.weights[1] + hit.weights[2], 1.0, 1e-12);
    }
    closest_point_destroy(tree);
}

/* Two sheets 0.01 apart, the upper facing up and the lower facing down. */
static void the_side_that_faces_the_same_way_wins(void) {
    static const float positions[18] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -0.01f, 1, 0, -0.01f, 0, 1, -0.01f };
    static const uint32_t indices[6] = { 0, 1, 2, 3, 5, 4 };
    static const float point[3] = { 0.2f, 0.2f, 0.001f }, up[3] = { 0, 0, 1 }, down[3] = { 0, 0, -1 };
    closest_point *tree = closest_point_create(NULL, NULL, positions, indices, 2);
    CHECK_EQUAL(closest_point_find(tree, point, up, 0.1, 1).triangle, 0);
    CHECK_EQUAL(closest_point_find(tree, point, down, 0.1, 0).triangle, 1);
    CHECK_EQUAL(closest_point_find(tree, point, ANY, 0.1, 1).triangle, 0);
    /* Further away than what turning costs, the wrong side is better than nothing. */
    CHECK_EQUAL(closest_point_find(tree, point, down, 0.001, 0).triangle, 0);
    closest_point_destroy(tree);
}

static void no_triangles_and_flat_ones_are_answered(void) {
    static const float positions[9] = { 0, 0, 0, 1, 0, 0, 2, 0, 0 }, point[3] = { 1.5f, 1, 0 };
    static const uint32_t indices[3] = { 0, 1, 2 };
    closest_point *none = closest_point_create(NULL, NULL, positions, indices, 0),
                  *flat = closest_point_create(NULL, NULL, positions, indices, 1);
    CHECK_EQUAL(closest_point_find(none, point, ANY, 0.0, 0).triangle, UINT32_MAX);
    closest_point_hit hit = closest_point_find(flat, point, ANY, 0.0, 0);
    /* On a line of small numbers: exact. */
    CHECK_NEAR(hit.distance, 1.0, 1e-15);
    closest_point_destroy(none);
    closest_point_destroy(flat);
}

int main(void) {
    RUN(the_nearest_of_many_is_found);
    RUN(the_side_that_faces_the_same_way_wins);
    RUN(no_triangles_and_flat_ones_are_answered);
    return check_end();
}
