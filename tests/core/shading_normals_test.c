/* SPDX-License-Identifier: MIT
 * Does a vertex look the way that the normals of its file say, in the world, and the way of its facet where they say
 * nothing that makes sense?
 */
#include "check.h"

#include "mesh/shading_normals.h"

/* A triangle of the input, of which one vertex lies in the middle. */
static const float NORMALS[] = { 1, 1, 0, 1, 1, 0, 1, 1, 0 };
static const uint32_t INDICES[] = { 0, 1, 2 };

static void look(const double transform[16], float normal[3]) {
    uint32_t triangle = 0;
    float weights[3] = { 0.25f, 0.25f, 0.5f };
    mesh_vertices v = { .source_triangles = &triangle, .source_weights = weights, .normals = normal, .count = 1 };
    source_mesh source = { .normals = NORMALS, .indices = INDICES };
    memset(normal, 0, 3 * sizeof *normal);
    shading_normals_set_matrix(transform, source.normal_matrix);
    shading_normals_set(&v, &source, 0);
}

/* Planes x + y = c become x / 2 + y = c where x is doubled: their normals are (1, 2, 0). */
static void normals_go_to_the_world_by_the_inverse_transpose(void) {
    const double twice_as_wide[16] = { 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1 };
    float n[3];
    look(twice_as_wide, n);
    CHECK_NEAR(n[0], 1 / sqrt(5), 1e-7);
    CHECK_NEAR(n[1], 2 / sqrt(5), 1e-7);
    CHECK_NEAR(n[2], 0, 1e-7);
}

static void all_zeros_are_the_identity(void) {
    float n[3];
    look((double[16]){ 0 }, n);
    CHECK_NEAR(n[0], sqrt(0.5), 1e-7);
    CHECK_NEAR(n[1], sqrt(0.5), 1e-7);
}

/* Two vertices of a facet that faces z: one leans by 45 degrees, the other by more than 80. */
static void a_normal_that_hardly_faces_the_facet_is_that_of_the_facet(void) {
    float normals[] = { 0.70710678f, 0, 0.70710678f, 0.99f, 0, 0.1410674f };
    const surface f = { .normal = { 0, 0, 1 } };
    const mesh m = { .normals = normals };
    const double weights[] = { 1.0, 0.0 }, even[] = { 0.5, 0.5 };
    double n[3];
    CHECK(shading_normals_mix(&m, &f, (uint32_t[]){ 0, 1 }, weights, 2, n));
    CHECK_NEAR(n[0], sqrt(0.5), 1e-6);
    CHECK(!shading_normals_mix(&m, &f, (uint32_t[]){ 1, 1 }, even, 2, n));
    CHECK_NEAR(n[2], 1.0, 0);
    /* The mean of the lean one and of the facet's own, which the steep one has become. */
    CHECK(shading_normals_mix(&m, &f, (uint32_t[]){ 0, 1 }, even, 2, n));
    CHECK_NEAR(n[0] / n[2], 0.70710678 / 1.70710678, 1e-6);
}

/* A two-sided file gives one normal: the back takes it turned over. */
static void the_back_of_a_sheet_has_the_normal_of_its_side(void) {
    float normals[] = { 0.6f, 0, 0.8f };
    const surface back = { .normal = { 0, 0, -1 } };
    const mesh m = { .normals = normals };
    double n[3];
    CHECK(shading_normals_mix(&m, &back, (uint32_t[]){ 0 }, (double[]){ 1.0 }, 1, n));
    CHECK_NEAR(n[2], -0.8, 1e-7);
    CHECK_NEAR(n[0], -0.6, 1e-7);
}

int main(void) {
    RUN(normals_go_to_the_world_by_the_inverse_transpose);
    RUN(all_zeros_are_the_identity);
    RUN(a_normal_that_hardly_faces_the_facet_is_that_of_the_facet);
    RUN(the_back_of_a_sheet_has_the_normal_of_its_side);
    return check_end();
}
