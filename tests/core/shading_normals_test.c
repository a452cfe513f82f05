/* SPDX-License-Identifier: MIT
 * Does a vertex look the way that the normals of its file say, in the world, and the way of its facet where they say
 * nothing that makes sense, or the way of the face that its bevels hardly bend?
 */
#include "check.h"

#include "mesh/shading_normals.h"
#include "mesh/weighted_normals.h"

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

/* A level strip along z from x = -width to 0 and one that goes on from it at 45 degrees, bevel wide. Files split
 * vertices for textures: the two have their own along the edge, 2 and 3 of the first, 4 and 5 of the second, whose
 * normals are the plain mean of the two strips'. */
enum { STRIP_VERTICES = 8, STRIP_TRIANGLES = 4 };

static const float *weighted(float width, float bevel, arena *memory) {
    const float x = 0.70710678f * bevel, s = 0.38268343f, c = 0.92387953f;
    const float at[STRIP_VERTICES][3] = { { -width, 0, 0 }, { -width, 0, 1 }, { 0, 0, 0 },  { 0, 0, 1 },
                                          { 0, 0, 0 },      { 0, 0, 1 },      { x, -x, 0 }, { x, -x, 1 } };
    const float normals[STRIP_VERTICES][3] = { { 0, 1, 0 }, { 0, 1, 0 }, { s, c, 0 }, { s, c, 0 },
                                               { s, c, 0 }, { s, c, 0 }, { 1, 0, 0 }, { 1, 0, 0 } };
    static const uint32_t indices[] = { 0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7 };
    source_mesh m = { .positions = at[0], .normals = normals[0], .indices = indices };
    CHECK(weighted_normals(&m, STRIP_VERTICES, STRIP_TRIANGLES, memory));
    return m.normals == normals[0] ? NULL : m.normals;
}

/* 25 cm to 2 mm: the normal along the edge is that of the sill, by area, and the same on either strip. One end of the
 * edge has two triangles of the sill and one of the bevel, the other one and two. */
static void a_sill_with_a_bevel_is_flat(void) {
    arena memory = { 0 };
    const double across = 0.002 * sqrt(0.5), sill[] = { 0.25, 0.125 }, bevel[] = { 0.5 * across, across };
    const float *n = weighted(0.25f, 0.002f, &memory);
    CHECK(n);
    for (int v = 2; n && v < 6; v++) {
        double lean = atan2(bevel[v % 2], sill[v % 2] + bevel[v % 2]);
        CHECK_NEAR(n[3 * v], sin(lean), 1e-6);
        CHECK_NEAR(n[3 * v + 1], cos(lean), 1e-6);
    }
    if (n) CHECK_NEAR(n[3 * 6], 1, 0); /* a facet alone, whose normal leans by 45 degrees, says nothing against it */
    arena_free(&memory);
}

/* The other way round it is the bevel that is flat; of two as wide as each other both are facets of something round. */
static void facets_that_are_alike_keep_the_normals_of_the_file(void) {
    arena memory = { 0 };
    const float *n = weighted(0.002f, 0.25f, &memory);
    CHECK(n);
    if (n) CHECK_NEAR(n[3 * 2], sqrt(0.5), 0.01);
    CHECK(!weighted(0.25f, 0.25f, &memory));
    CHECK(!weighted(0.25f, 0.15f, &memory));
    arena_free(&memory);
}

/* The face of a polygon of as many corners around an axis, seen as a strip from angle -half to half, whose normals are
 * those of the cylinder around it. Where the middle of the strip is looked at from, as a height above the strip. */
static double lift_of(double half, bool lean_out, bool *is_lifted) {
    const double x = sin(half), y = cos(half), side = lean_out ? 1 : -1;
    const double vertices[] = { -x, y, 1, x, y, 1, x, y, -1, -x, y, -1 };
    float normals[12];
    for (int i = 0; i < 4; i++) {
        normals[3 * i] = (float)(side * vertices[3 * i]);
        normals[3 * i + 1] = (float)y, normals[3 * i + 2] = 0;
    }
    mesh m = { .vertices = (double *)vertices, .normals = normals };
    const surface f = { .corner = { 0, 1, 2, 3 }, .normal = { 0, 1, 0 } };
    const double middle[3] = { 0, y, 0.25 };
    double out[3];
    *is_lifted = shading_normals_lift(&m, &f, middle, out);
    CHECK_NEAR(out[0], 0, 1e-6);
    CHECK_NEAR(out[2], 0.25, 1e-6);
    return out[1] - y;
}

/* Each corner's plane passes at a height of sin(half) sin(half) above the middle, along its own normal; none of it is
 * below a hollow. */
static void a_point_of_a_facet_is_lifted_to_what_its_corners_touch(void) {
    bool is_lifted;
    double half = 0.2;
    CHECK_NEAR(lift_of(half, true, &is_lifted), sin(half) * sin(half) * cos(half), 1e-6);
    CHECK(is_lifted);
    CHECK_NEAR(lift_of(half, false, &is_lifted), 0, 0);
    CHECK(!is_lifted); /* its facet is its horizon: light from behind has come through it */
}

static void a_face_of_a_box_is_no_piece_of_a_ball(void) {
    bool is_lifted;
    CHECK(lift_of(44 * PI / 180, true, &is_lifted) > 0.3);
    CHECK(is_lifted);
    CHECK_NEAR(lift_of(54 * PI / 180, true, &is_lifted), 0, 0);
    CHECK(!is_lifted);
}

int main(void) {
    RUN(normals_go_to_the_world_by_the_inverse_transpose);
    RUN(all_zeros_are_the_identity);
    RUN(a_normal_that_hardly_faces_the_facet_is_that_of_the_facet);
    RUN(the_back_of_a_sheet_has_the_normal_of_its_side);
    RUN(a_sill_with_a_bevel_is_flat);
    RUN(facets_that_are_alike_keep_the_normals_of_the_file);
    RUN(a_point_of_a_facet_is_lifted_to_what_its_corners_touch);
    RUN(a_face_of_a_box_is_no_piece_of_a_ball);
    return check_end();
}
