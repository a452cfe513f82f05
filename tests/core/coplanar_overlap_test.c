/* SPDX-License-Identifier: MIT
 * Are triangles that lie in each other found, and no others?
 */
#include "check.h"
#include "item_rays.h"
#include "scene/coplanar_overlap.h"

#include <time.h>

enum { CELLS = 200, VERTICES = (CELLS + 1) * (CELLS + 1), TRIANGLES = 2 * CELLS * CELLS };

/* A grid of CELLS x CELLS cells over the unit square, at a + u e + v f, counted by vertex and triangle from the first.
 */
static void add_grid(float *positions, uint32_t *indices, uint32_t first_vertex, size_t first_triangle,
                     const double a[3], const double e[3], const double f[3]) {
    for (uint32_t y = 0; y <= CELLS; y++)
        for (uint32_t x = 0; x <= CELLS; x++)
            for (int k = 0; k < 3; k++)
                positions[3 * (first_vertex + y * (CELLS + 1) + x) + (uint32_t)k] =
                    (float)(a[k] + (double)x / CELLS * e[k] + (double)y / CELLS * f[k]);
    for (uint32_t y = 0; y < CELLS; y++)
        for (uint32_t x = 0; x < CELLS; x++) {
            uint32_t v = first_vertex + y * (CELLS + 1) + x;
            const uint32_t quad[6] = { v, v + 1, v + CELLS + 2, v, v + CELLS + 2, v + CELLS + 1 };
            memcpy(indices + 3 * (first_triangle + 2 * (y * CELLS + x)), quad, sizeof quad);
        }
}

static size_t count_layered(const uint8_t *layers, size_t first, size_t count) {
    size_t sum = 0;
    for (size_t t = first; t < first + count; t++) sum += layers[t] != 0;
    return sum;
}

static void neighbours_in_a_plane_do_not_overlap_and_copies_do(void) {
    const double planes[][2][3] = { { { 1, 0, 0 }, { 0, 1, 0 } },
                                    { { 0, 0, 1 }, { 0, 1, 0 } },
                                    { { 0.6, 0.48, 0.64 }, { -0.8, 0.36, 0.48 } },
                                    { { 1, 1, 0 }, { 0, 0, 1 } } };
    float *positions = malloc(2 * 3 * VERTICES * sizeof *positions);
    uint32_t *indices = malloc(2 * 3 * TRIANGLES * sizeof *indices);
    uint8_t *layers = malloc(2 * TRIANGLES);
    for (int i = 0; i < 4; i++) {
        const double *e = planes[i][0], *f = planes[i][1], a[3] = { -0.3, -0.2, -0.4 };
        double shifted[3];
        vec3_add_scaled(shifted, a, 0.25, e);
        add_grid(positions, indices, 0, 0, a, e, f);
        add_grid(positions, indices, VERTICES, TRIANGLES, shifted, e, f);
        clock_t start = clock();
        CHECK(coplanar_overlap_find_layers(NULL, positions, indices, 2 * TRIANGLES, layers));
        printf("%d triangles in one plane: %.3f s\n", 2 * TRIANGLES, (double)(clock() - start) / CLOCKS_PER_SEC);
        CHECK_EQUAL(count_layered(layers, 0, TRIANGLES), 0);
        /* The copy is shifted by a quarter of its width, a whole number of cells. */
        CHECK_EQUAL(count_layered(layers, TRIANGLES, TRIANGLES), TRIANGLES * 3 / 4);
    }
    free(positions);
    free(indices);
    free(layers);
}

static void layers_pile_up(void) {
    static soup s;
    uint8_t layers[9];
    soup_start(&s, 1e-6);
    /* Three that overlap, one beside, one that crosses them, one that is parallel, one of no area; again the first. */
    for (int i = 0; i < 3; i++)
        soup_triangle(&s, (double[]){ 0.1 * i, 0, 1 }, (double[]){ 1, 0.1 * i, 1 }, (double[]){ 0, 1, 1 });
    soup_triangle(&s, (double[]){ 2, 0, 1 }, (double[]){ 3, 0, 1 }, (double[]){ 2, 1, 1 });
    soup_triangle(&s, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0.5, 0.5, 2 });
    soup_triangle(&s, (double[]){ 0, 0, 1.001 }, (double[]){ 1, 0, 1.001 }, (double[]){ 0, 1, 1.001 });
    soup_triangle(&s, (double[]){ 0, 0, 1 }, (double[]){ 0.5, 0, 1 }, (double[]){ 1, 0, 1 });
    soup_triangle(&s, (double[]){ 0, 1, 1 }, (double[]){ 1, 0, 1 }, (double[]){ 0, 0, 1 });
    CHECK(coplanar_overlap_find_layers(NULL, s.positions, s.indices, s.geometry.triangle_count, layers));
    const uint8_t expected[] = { 0, 1, 2, 0, 0, 0, 0, 3 };
    for (int i = 0; i < 8; i++) CHECK_EQUAL(layers[i], expected[i]);
}

/* Every pair by brute force: a pixel's worth of sample points in both says that they overlap, touching does not. */
static void random_triangles_in_a_few_planes_agree_with_samples(void) {
    static soup s;
    static uint8_t layers[SOUP_TRIANGLES_MAX];
    uint64_t state = 4;
    int missed = 0, found = 0, invented = 0;
    for (int i = 0; i < 30; i++) {
        soup_start(&s, 1e-6);
        for (int t = 0; t < 40; t++) {
            double corner[3][3];
            for (int c = 0; c < 3; c++)
                for (int k = 0; k < 3; k++) corner[c][k] = k == i % 3 ? (t % 5) * 0.3 : random_in(&state, -1, 1);
            soup_triangle(&s, corner[0], corner[1], corner[2]);
        }
        CHECK(coplanar_overlap_find_layers(NULL, s.positions, s.indices, 40, layers));
        for (size_t t = 0; t < 40; t++) {
            bool overlaps = false;
            for (int k = 0; k < 4000 && !overlaps; k++) {
                double w[2] = { random_unit(&state), random_unit(&state) }, eye[3] = { 0 };
                const double along[3] = { i % 3 == 0, i % 3 == 1, i % 3 == 2 };
                if (w[0] + w[1] > 1) w[0] = 1 - w[0], w[1] = 1 - w[1];
                for (int c = 0; c < 3; c++)
                    eye[c] = (1 - w[0] - w[1]) * s.positions[9 * t + (size_t)c] +
                             w[0] * s.positions[9 * t + 3 + (size_t)c] + w[1] * s.positions[9 * t + 6 + (size_t)c];
                vec3_add_scaled(eye, eye, -0.01, along);
                for (size_t u = t % 5; u < t && !overlaps; u += 5)
                    overlaps = ray_triangle(&s.geometry, u, eye, along) < 0.02;
            }
            found += overlaps;
            missed += overlaps && !layers[t];
            invented += !overlaps && layers[t];
        }
    }
    CHECK(found > 500);
    CHECK_EQUAL(missed, 0);
    /* Overlaps of less than a few thousandths of a triangle escape the samples. */
    CHECK(invented < 10);
}

int main(void) {
    RUN(neighbours_in_a_plane_do_not_overlap_and_copies_do);
    RUN(layers_pile_up);
    RUN(random_triangles_in_a_few_planes_agree_with_samples);
    return check_end();
}
