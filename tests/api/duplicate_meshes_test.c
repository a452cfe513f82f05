/* SPDX-License-Identifier: MIT
 * Do meshes in the place of an earlier one get its light, each with its own material, and is it solved once?
 */
#include "check.h"

#include <hemibake/hemibake.h>

#include <stdlib.h>

enum { GRID = 8, VERTICES = (GRID + 1) * (GRID + 1), TRIANGLES = 2 * GRID * GRID };

typedef struct host {
    hemi_context *context;
    hemi_scene *scene;
} host;

static void open_host(host *h) {
    hemi_context_desc desc = { .struct_size = sizeof desc, .threads = 2 };
    CHECK_EQUAL(hemi_context_create(&desc, &h->context), HEMI_OK);
    CHECK_EQUAL(hemi_scene_create(h->context, &h->scene), HEMI_OK);
}

static void close_host(host *h) {
    hemi_scene_destroy(h->scene);
    hemi_context_destroy(h->context);
}

static uint32_t paint(host *h, double red, double green, double emission, bool double_sided) {
    hemi_material_desc m = { .struct_size = sizeof m,
                             .reflectance = { red, green, 0.5 },
                             .emission = { emission, emission, emission },
                             .double_sided = double_sided };
    uint32_t index = 0;
    CHECK_EQUAL(hemi_scene_add_material(h->scene, &m, &index), HEMI_OK);
    return index;
}

/* Half of what the material says. */
static void halve(void *user, const double *attributes, uint32_t corners, hemi_texture_mean *out) {
    (void)user, (void)attributes, (void)corners;
    for (int c = 0; c < 3; c++) out->reflectance[c] *= 0.5;
}

/* A floor of many squares, at height y in its own frame; wide: how far it reaches. */
static uint32_t add_floor(host *h, float wide, float y, uint32_t material, hemi_texture_fn texture) {
    float positions[3 * VERTICES], attributes[VERTICES] = { 0 };
    uint32_t indices[3 * TRIANGLES], mesh = 0, n = 0;
    for (int i = 0; i < VERTICES; i++) {
        positions[3 * i] = wide * ((float)(i % (GRID + 1)) / GRID - 0.5f);
        positions[3 * i + 1] = y;
        positions[3 * i + 2] = -wide * ((float)(i / (GRID + 1)) / GRID - 0.5f);
    }
    for (uint32_t i = 0; i < GRID * GRID; i++) {
        uint32_t at = i / GRID * (GRID + 1) + i % GRID;
        const uint32_t two[6] = { at, at + 1, at + GRID + 2, at, at + GRID + 2, at + GRID + 1 };
        memcpy(indices + n, two, sizeof two);
        n += 6;
    }
    hemi_mesh_desc m = { .struct_size = sizeof m,
                         .positions = positions,
                         .vertex_count = VERTICES,
                         .attributes = attributes,
                         .attribute_count = 1,
                         .texture = texture,
                         .indices = indices,
                         .triangle_count = TRIANGLES,
                         .material = material };
    CHECK_EQUAL(hemi_scene_add_mesh(h->scene, &m, &mesh), HEMI_OK);
    return mesh;
}

/* An emitter above, off the middle, facing down. */
static void add_emitter(host *h) {
    static const float positions[12] = { 0, 1, 0, 0, 1, 0.5f, 0.5f, 1, 0.5f, 0.5f, 1, 0 };
    static const uint32_t indices[6] = { 0, 2, 1, 0, 3, 2 };
    hemi_mesh_desc m = { .struct_size = sizeof m,
                         .positions = positions,
                         .vertex_count = 4,
                         .indices = indices,
                         .triangle_count = 2,
                         .material = paint(h, 0, 0, 10, false) };
    CHECK_EQUAL(hemi_scene_add_mesh(h->scene, &m, NULL), HEMI_OK);
}

static hemi_solution *bake(host *h, hemi_statistics *s) {
    hemi_bake_desc desc = { .struct_size = sizeof desc, .quality = HEMI_QUALITY_DRAFT };
    hemi_solution *solution = NULL;
    add_emitter(h);
    CHECK_EQUAL(hemi_bake(h->scene, &desc, &solution), HEMI_OK);
    CHECK_EQUAL(hemi_solution_statistics(solution, s), HEMI_OK);
    return solution;
}

/* Radiance of two meshes, vertex by vertex: b = emission + share a. */
static void check_light(const hemi_solution *solution, uint32_t a, uint32_t b, const double share[3], double emission) {
    hemi_mesh_view x = { .struct_size = sizeof x }, y = { .struct_size = sizeof y };
    float largest = 0.0f, off = 0.0f;
    CHECK_EQUAL(hemi_solution_mesh(solution, a, &x), HEMI_OK);
    CHECK_EQUAL(hemi_solution_mesh(solution, b, &y), HEMI_OK);
    CHECK_EQUAL(x.vertex_count, y.vertex_count);
    CHECK_EQUAL(x.triangle_count, y.triangle_count);
    CHECK(memcmp(x.indices, y.indices, 3 * x.triangle_count * sizeof *x.indices) == 0);
    CHECK(memcmp(x.positions, y.positions, 3 * x.vertex_count * sizeof *x.positions) == 0);
    CHECK(memcmp(x.source_triangles, y.source_triangles, x.vertex_count * sizeof *x.source_triangles) == 0);
    for (uint32_t i = 0; i < 3 * x.vertex_count; i++) {
        largest = fmaxf(largest, x.radiance[i]);
        off = fmaxf(off, fabsf(y.radiance[i] - (float)(emission + share[i % 3] * (double)x.radiance[i])));
    }
    /* One fit of radiance against one of irradiance: they stop at 1e-6 of the largest, and floats. */
    CHECK(largest > 0.1f);
    CHECK_NEAR(off / largest, 0.0, 1e-4);
}

static void copies_get_the_light_of_the_first_with_their_own_material(void) {
    host h;
    hemi_statistics s = { .struct_size = sizeof s }, alone = { .struct_size = sizeof alone };
    open_host(&h);
    uint32_t first = add_floor(&h, 2, 0, paint(&h, 0.8, 0.4, 0, false), NULL);
    uint32_t darker = add_floor(&h, 2, 0, paint(&h, 0.4, 0.4, 0, false), NULL);
    uint32_t glowing = add_floor(&h, 2, 0, paint(&h, 0.8, 0.0, 3, false), NULL);
    uint32_t textured = add_floor(&h, 2, 0, paint(&h, 0.8, 0.4, 0, false), halve);
    hemi_solution *solution = bake(&h, &s);
    CHECK_EQUAL(s.scene.duplicate_meshes, 3);
    CHECK_EQUAL(s.scene.overlapping_triangles, 0);
    check_light(solution, first, darker, (const double[]){ 0.5, 1, 1 }, 0);
    check_light(solution, first, glowing, (const double[]){ 1, 0, 1 }, 3);
    check_light(solution, first, textured, (const double[]){ 0.5, 0.5, 0.5 }, 0);
    hemi_mesh_view view = { .struct_size = sizeof view };
    CHECK_EQUAL(hemi_solution_mesh(solution, textured, &view), HEMI_OK);
    CHECK(view.demodulated != NULL);
    hemi_solution_destroy(solution);
    close_host(&h);
    open_host(&h);
    add_floor(&h, 2, 0, paint(&h, 0.8, 0.4, 0, false), NULL);
    solution = bake(&h, &alone);
    CHECK_EQUAL(alone.scene.duplicate_meshes, 0);
    CHECK_EQUAL(alone.scene.surfaces, s.scene.surfaces);
    /* What copies emit is not shot, and what they absorb is not counted twice. */
    CHECK_NEAR(s.energy.emitted_w, alone.energy.emitted_w, 1e-9 * alone.energy.emitted_w);
    CHECK_NEAR(s.energy.absorbed_w, alone.energy.absorbed_w, 1e-9 * alone.energy.absorbed_w);
    hemi_solution_destroy(solution);
    close_host(&h);
}

static void what_differs_in_place_or_sides_is_no_copy(void) {
    host h;
    hemi_statistics s = { .struct_size = sizeof s };
    open_host(&h);
    uint32_t grey = paint(&h, 0.5, 0.5, 0, false);
    add_floor(&h, 2, 0, grey, NULL);
    add_floor(&h, 2, -0.5f, grey, NULL);
    add_floor(&h, 3, 0, grey, NULL);
    add_floor(&h, 2, 0, paint(&h, 0.5, 0.5, 0, true), NULL);
    hemi_solution *solution = bake(&h, &s);
    CHECK_EQUAL(s.scene.duplicate_meshes, 0);
    hemi_solution_destroy(solution);
    close_host(&h);
}

static void both_sides_of_a_double_sided_copy_are_lit(void) {
    host h;
    hemi_statistics s = { .struct_size = sizeof s };
    open_host(&h);
    uint32_t first = add_floor(&h, 2, 0, paint(&h, 0.8, 0.4, 0, true), NULL);
    uint32_t copy = add_floor(&h, 2, 0, paint(&h, 0.4, 0.4, 0, true), NULL);
    hemi_solution *solution = bake(&h, &s);
    CHECK_EQUAL(s.scene.duplicate_meshes, 1);
    check_light(solution, first, copy, (const double[]){ 0.5, 1, 1 }, 0);
    hemi_solution_destroy(solution);
    close_host(&h);
}

int main(void) {
    RUN(copies_get_the_light_of_the_first_with_their_own_material);
    RUN(what_differs_in_place_or_sides_is_no_copy);
    RUN(both_sides_of_a_double_sided_copy_are_lit);
    return check_end();
}
