/* SPDX-License-Identifier: MIT
 * Is the measured error the one that was put in, and is every probe matched to the surface that it lies on? */
#include "check.h"
#include "match.h"

#include <stdlib.h>
#include <time.h>

/* A square of 2 m in the plane z = 0, front up, with the linear radiance ramp of `ramp` at its corners. */
static const float square_positions[12] = { -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0 };
static const uint32_t square_indices[6] = { 0, 1, 2, 0, 2, 3 };

static float ramp(float x, float y, int band) {
    return 2.0f + 0.5f * x - 0.25f * y + (float)band;
}

static void square_radiance(float radiance[12], float offset) {
    for (int v = 0; v < 4; v++)
        for (int c = 0; c < 3; c++)
            radiance[3 * v + c] = ramp(square_positions[3 * v], square_positions[3 * v + 1], c) + offset;
}

static hemi_mesh_desc square(void) {
    return (hemi_mesh_desc){ .struct_size = sizeof(hemi_mesh_desc),
                             .positions = square_positions,
                             .indices = square_indices,
                             .vertex_count = 4,
                             .triangle_count = 2 };
}

enum { SIDE = 20, PROBES = SIDE * SIDE };

/* A lattice over the square, its outer probes on the very edge and its diagonal ones on the cut. */
static probe_set square_probes(probe storage[PROBES], float normal_z) {
    for (int i = 0; i < PROBES; i++) {
        float x = -1.0f + 2.0f * (float)(i % SIDE) / (SIDE - 1), y = -1.0f + 2.0f * (float)(i / SIDE) / (SIDE - 1);
        storage[i] = (probe){ .position = { x, y, 0 }, .normal = { 0, 0, normal_z }, .standard_error = 0.01f };
        for (int c = 0; c < 3; c++) storage[i].radiance[c] = ramp(x, y, c);
    }
    return (probe_set){ storage, PROBES };
}

/* The square with probes over it, its light that of the truth and an offset. */
typedef struct floor_case {
    probe storage[PROBES];
    probe_set set;
    hemi_mesh_desc desc;
    float radiance[12];
    match_mesh mesh;
    match_result result;
    char message[PROBES_MESSAGE_SIZE];
} floor_case;

static void open_floor(floor_case *f, float normal, float offset) {
    f->set = square_probes(f->storage, normal);
    f->desc = square();
    square_radiance(f->radiance, offset);
    f->mesh = (match_mesh){ "floor", &f->desc, f->radiance };
}

static hemi_result match_floor(floor_case *f) {
    return probes_match(&f->mesh, 1, &f->set, &f->result, f->message);
}

static double truth_squared(const probe_set *set) {
    double sum = 0.0;
    for (size_t i = 0; i < set->count; i++)
        for (int c = 0; c < 3; c++) sum += (double)set->probes[i].radiance[c] * set->probes[i].radiance[c];
    return sum;
}

static void a_linear_ramp_has_no_error(void) {
    floor_case f;
    open_floor(&f, 1.0f, 0.0f);
    CHECK_EQUAL(match_floor(&f), HEMI_OK);
    CHECK_EQUAL(f.result.total.matched, PROBES);
    CHECK_EQUAL(f.result.unmatched, 0);
    /* Truth and corners are float32 numbers near 3: 2^-24 of them a value. */
    CHECK_NEAR(match_error(&f.result.total), 0.0, 1e-6);
    CHECK_NEAR(match_bias(&f.result.total), 0.0, 1e-6);
    CHECK_NEAR(match_noise(&f.result.total), sqrt(PROBES * 3 * 0.01 * 0.01 / truth_squared(&f.set)), 1e-8);
    match_result_destroy(&f.result);
}

static void an_offset_gives_its_closed_form(void) {
    floor_case f;
    open_floor(&f, 1.0f, 0.125f);
    CHECK_EQUAL(match_floor(&f), HEMI_OK);
    CHECK_NEAR(match_error(&f.result.total), sqrt(3 * PROBES * 0.125 * 0.125 / truth_squared(&f.set)), 1e-7);
    CHECK_NEAR(f.result.worst_difference, sqrt(3.0) * 0.125, 1e-6);
    CHECK(match_bias(&f.result.total) > 0.0);
    match_result_destroy(&f.result);
}

static void the_wrong_side_is_not_matched(void) {
    floor_case f;
    open_floor(&f, -1.0f, 0.0f);
    CHECK_EQUAL(match_floor(&f), HEMI_ERROR_DATA);
    CHECK(f.result.meshes == NULL && strstr(f.message, "none of the 400 probes"));
    f.storage[7].normal[2] = 1.0f;
    CHECK_EQUAL(match_floor(&f), HEMI_OK);
    CHECK_EQUAL(f.result.total.matched, 1);
    CHECK_EQUAL(f.result.unmatched, PROBES - 1);
    match_result_destroy(&f.result);
}

static void a_probe_beyond_the_distance_is_not_matched(void) {
    float radiance[12];
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    hemi_mesh_desc desc = square();
    square_radiance(radiance, 0.0f);
    match_mesh mesh = { "floor", &desc, radiance };
    double distance = MATCH_DISTANCE * sqrt(8.0);
    const float factors[2] = { 0.99f, 1.01f };
    for (int beside = 0; beside < 2; beside++) /* above the square, then beside its edge */
        for (int i = 0; i < 2; i++) {
            probe p = { .normal = { 0, 0, 1 }, .radiance = { 1, 1, 1 } };
            p.position[0] = beside ? 1.0f + (float)distance * factors[i] : 0.0f;
            p.position[2] = beside ? 0.0f : (float)distance * factors[i];
            hemi_result found = probes_match(&mesh, 1, &(probe_set){ &p, 1 }, &result, message);
            CHECK_EQUAL(found, i == 0 ? HEMI_OK : HEMI_ERROR_DATA);
            match_result_destroy(&result);
        }
}

/* Two squares side by side in x, one placed by a transform; the second one is off by a constant. */
static void every_mesh_has_its_own_figure(void) {
    probe storage[2 * PROBES];
    float exact[12], off[12];
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    hemi_mesh_desc first = square(), second = square();
    square_probes(storage, 1.0f);
    square_probes(storage + PROBES, 1.0f);
    for (int i = PROBES; i < 2 * PROBES; i++) storage[i].position[0] += 5.0f;
    probe_set set = { storage, 2 * PROBES };
    second.transform[0] = second.transform[5] = second.transform[10] = second.transform[15] = 1.0;
    second.transform[12] = 5.0;
    square_radiance(exact, 0.0f);
    square_radiance(off, -0.5f);
    match_mesh meshes[2] = { { "left", &first, exact }, { "right", &second, off } };
    CHECK_EQUAL(probes_match(meshes, 2, &set, &result, message), HEMI_OK);
    CHECK_EQUAL(result.meshes[0].matched, PROBES);
    CHECK_EQUAL(result.meshes[1].matched, PROBES);
    double half = result.meshes[1].truth_squared;
    CHECK_NEAR(match_error(&result.meshes[0]), 0.0, 1e-6);
    CHECK_NEAR(match_error(&result.meshes[1]), sqrt(3 * PROBES * 0.25 / half), 1e-6);
    CHECK_NEAR(match_error(&result.total), sqrt(3 * PROBES * 0.25 / (2 * half)), 1e-6);
    CHECK_NEAR(match_bias(&result.meshes[1]), -0.5 * 3 * PROBES / result.meshes[1].truth, 1e-6);
    CHECK_EQUAL(result.worst_mesh, 1);
    match_result_destroy(&result);
}

static void the_worst_probe_is_named(void) {
    floor_case f;
    open_floor(&f, 1.0f, 0.0f);
    f.storage[123].radiance[1] += 4.0f;
    CHECK_EQUAL(match_floor(&f), HEMI_OK);
    CHECK_EQUAL(f.result.worst_probe, 123);
    CHECK_NEAR(f.result.worst_difference, 4.0, 1e-5);
    CHECK_NEAR(f.result.worst_radiance[1], f.storage[123].radiance[1] - 4.0f, 1e-5);
    match_result_destroy(&f.result);
}

/* A bake of 2 in each band against a truth that is 2 at most places, 1 at a tenth of them and next to black at another.
 */
static void the_middle_and_the_95th_percentile_are_of_each_probe_itself(void) {
    floor_case f;
    open_floor(&f, 1.0f, 0.0f);
    for (int i = 0; i < 12; i++) f.radiance[i] = 2.0f;
    for (int i = 0; i < PROBES; i++)
        for (int c = 0; c < 3; c++) f.storage[i].radiance[c] = i % 10 == 0 ? 1.0f : i % 10 == 1 ? 1e-6f : 2.0f;
    CHECK_EQUAL(match_floor(&f), HEMI_OK);
    CHECK_NEAR(f.result.median, 0.0, 0.0);
    /* The darkest tenth counts as 2 % of the mean, 0.8 * 2 + 0.1. */
    CHECK_NEAR(f.result.percentile95, 2.0 / (MATCH_DIM_SHARE * 1.7), 1e-3);
    match_result_destroy(&f.result);
}

/* x -> -x mirrors; by the rule of hemi_mesh_desc the front still looks up. */
static void a_mirrored_mesh_keeps_its_front(void) {
    probe p = { .position = { 0.5f, 0.25f, 0 }, .normal = { 0, 0, 1 } };
    float radiance[12];
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    hemi_mesh_desc desc = square();
    desc.transform[0] = -1.0;
    desc.transform[5] = desc.transform[10] = desc.transform[15] = 1.0;
    square_radiance(radiance, 0.0f);
    for (int c = 0; c < 3; c++) p.radiance[c] = ramp(-0.5f, 0.25f, c);
    match_mesh mesh = { "floor", &desc, radiance };
    CHECK_EQUAL(probes_match(&mesh, 1, &(probe_set){ &p, 1 }, &result, message), HEMI_OK);
    CHECK_NEAR(match_error(&result.total), 0.0, 1e-6);
    match_result_destroy(&result);
    p.normal[2] = -1.0f;
    CHECK_EQUAL(probes_match(&mesh, 1, &(probe_set){ &p, 1 }, &result, message), HEMI_ERROR_DATA);
    match_result_destroy(&result);
}

static void of_two_sheets_the_nearer_wins(void) {
    float near_radiance[12], far_radiance[12];
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    hemi_mesh_desc low = square(), high = square();
    probe p = { .position = { 0.1f, 0.2f, 0.0004f }, .normal = { 0, 0, 1 }, .radiance = { 1, 1, 1 } };
    high.transform[0] = high.transform[5] = high.transform[10] = high.transform[15] = 1.0;
    high.transform[14] = 0.001;
    square_radiance(near_radiance, 0.0f);
    square_radiance(far_radiance, 1.0f);
    match_mesh meshes[2] = { { "high", &high, far_radiance }, { "low", &low, near_radiance } };
    CHECK_EQUAL(probes_match(meshes, 2, &(probe_set){ &p, 1 }, &result, message), HEMI_OK);
    CHECK_EQUAL(result.worst_mesh, 1);
    match_result_destroy(&result);
    p.position[2] = 0.0006f;
    CHECK_EQUAL(probes_match(meshes, 2, &(probe_set){ &p, 1 }, &result, message), HEMI_OK);
    CHECK_EQUAL(result.worst_mesh, 0);
    match_result_destroy(&result);
}

/* Two facets meet at an edge, tilted by +-30 degrees; a probe on the edge belongs to the one that faces as it does. */
static void of_two_facets_at_an_edge_the_better_facing_wins(void) {
    const float positions[12] = { 0, -1, 0, 0, 1, 0, -1, 0, -0.57735f, 1, 0, -0.57735f };
    const uint32_t indices[6] = { 0, 1, 2, 0, 3, 1 };
    const float radiance[12] = { 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1 };
    hemi_mesh_desc left = { .positions = positions, .indices = indices, .vertex_count = 4, .triangle_count = 1 };
    hemi_mesh_desc right = left;
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    right.indices = indices + 3;
    match_mesh meshes[2] = { { "left", &left, radiance }, { "right", &right, radiance } };
    for (int side = 0; side < 2; side++) {
        probe p = { .position = { 0, 0.3f, 0 }, .normal = { side ? 0.5f : -0.5f, 0, 0.8660254f } };
        CHECK_EQUAL(probes_match(meshes, 2, &(probe_set){ &p, 1 }, &result, message), HEMI_OK);
        CHECK_EQUAL(result.worst_mesh, side);
        match_result_destroy(&result);
    }
}

static void triangles_without_area_are_passed_over(void) {
    const float positions[18] = { -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, 0, 0, 0, 0.5f, 0.5f, 0 };
    const uint32_t indices[12] = { 0, 0, 0, 0, 4, 5, 0, 1, 2, 0, 2, 3 }; /* a point, a needle, the square */
    probe storage[PROBES];
    probe_set set = square_probes(storage, 1.0f);
    float radiance[18] = { 0 };
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    hemi_mesh_desc desc = { .positions = positions, .indices = indices, .vertex_count = 6, .triangle_count = 4 };
    square_radiance(radiance, 0.0f);
    match_mesh mesh = { NULL, &desc, radiance };
    CHECK_EQUAL(probes_match(&mesh, 1, &set, &result, message), HEMI_OK);
    CHECK_EQUAL(result.degenerate_triangles, 2);
    CHECK_EQUAL(result.total.matched, PROBES);
    CHECK_NEAR(match_error(&result.total), 0.0, 1e-6);
    match_result_destroy(&result);
}

static void broken_meshes_are_refused_with_their_name(void) {
    probe storage[PROBES];
    probe_set set = square_probes(storage, 1.0f);
    float radiance[12], positions[12];
    uint32_t indices[6];
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    hemi_mesh_desc desc = square();
    square_radiance(radiance, 0.0f);
    memcpy(positions, square_positions, sizeof positions);
    memcpy(indices, square_indices, sizeof indices);
    desc.positions = positions;
    desc.indices = indices;
    match_mesh mesh = { "lid", &desc, radiance };
    indices[4] = 4;
    CHECK_EQUAL(probes_match(&mesh, 1, &set, &result, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "mesh lid") && strstr(message, "triangle 1"));
    indices[4] = 2;
    positions[5] = NAN;
    CHECK_EQUAL(probes_match(&mesh, 1, &set, &result, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "vertex 1"));
    positions[5] = 0.0f;
    radiance[0] = NAN;
    CHECK_EQUAL(probes_match(&mesh, 1, &set, &result, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "radiance"));
    CHECK_EQUAL(probes_match(&mesh, 0, &set, &result, message), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(probes_match(&mesh, 1, &(probe_set){ 0 }, &result, message), HEMI_ERROR_ARGUMENT);
    mesh.radiance = NULL;
    CHECK_EQUAL(probes_match(&mesh, 1, &set, &result, message), HEMI_ERROR_ARGUMENT);
}

static void a_black_truth_has_no_relative_error(void) {
    match_figure figure = { .matched = 1, .difference_squared = 1.0 };
    CHECK(isinf(match_error(&figure)));
    figure.difference_squared = 0.0;
    CHECK_NEAR(match_error(&figure), 0.0, 0.0);
}

/* ---- an independent method: every probe against every triangle -------------------------------------------------- */

enum { BUMPY_SIDE = 24, BUMPY_TRIANGLES = 2 * BUMPY_SIDE * BUMPY_SIDE };

/* A height field over the unit square, so that the triangle under a point is known from its x and y. */
static float height(int i, int j) {
    return 0.02f * (float)((i * 7 + j * 11) % 5);
}

typedef struct bumpy {
    float positions[3 * (BUMPY_SIDE + 1) * (BUMPY_SIDE + 1)], radiance[3 * (BUMPY_SIDE + 1) * (BUMPY_SIDE + 1)];
    uint32_t indices[3 * BUMPY_TRIANGLES];
} bumpy;

static void make_bumpy(bumpy *b) {
    for (int j = 0; j <= BUMPY_SIDE; j++)
        for (int i = 0; i <= BUMPY_SIDE; i++) {
            int v = j * (BUMPY_SIDE + 1) + i;
            b->positions[3 * v] = (float)i / BUMPY_SIDE;
            b->positions[3 * v + 1] = (float)j / BUMPY_SIDE;
            b->positions[3 * v + 2] = height(i, j);
            for (int c = 0; c < 3; c++) b->radiance[3 * v + c] = (float)((v * 13 + c * 5) % 17);
        }
    uint32_t *out = b->indices;
    for (uint32_t j = 0; j < BUMPY_SIDE; j++)
        for (uint32_t i = 0; i < BUMPY_SIDE; i++) {
            uint32_t v = j * (BUMPY_SIDE + 1) + i, up = v + BUMPY_SIDE + 1;
            const uint32_t corners[6] = { v, v + 1, up, v + 1, up + 1, up };
            memcpy(out, corners, sizeof corners);
            out += 6;
        }
}

/* A probe in the middle of triangle t, off its centre by the given weights, with what is baked there. */
static probe probe_on(const bumpy *b, uint32_t t, const float weights[3]) {
    probe p = { .standard_error = 0.0f };
    float e[2][3], n[3];
    const uint32_t *corner = b->indices + 3 * t;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) {
            p.position[c] += weights[k] * b->positions[3 * corner[k] + (uint32_t)c];
            p.radiance[c] += weights[k] * b->radiance[3 * corner[k] + (uint32_t)c];
        }
    for (int c = 0; c < 3; c++) {
        e[0][c] = b->positions[3 * corner[1] + (uint32_t)c] - b->positions[3 * corner[0] + (uint32_t)c];
        e[1][c] = b->positions[3 * corner[2] + (uint32_t)c] - b->positions[3 * corner[0] + (uint32_t)c];
    }
    for (int c = 0; c < 3; c++) n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; c++) p.normal[c] = n[c] / length;
    return p;
}

static void every_probe_finds_the_triangle_it_was_put_on(void) {
    static bumpy b;
    static probe storage[BUMPY_TRIANGLES];
    const float weights[3] = { 0.2f, 0.5f, 0.3f };
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    make_bumpy(&b);
    for (uint32_t t = 0; t < BUMPY_TRIANGLES; t++) storage[t] = probe_on(&b, t, weights);
    hemi_mesh_desc desc = { .positions = b.positions,
                            .indices = b.indices,
                            .vertex_count = (BUMPY_SIDE + 1) * (BUMPY_SIDE + 1),
                            .triangle_count = BUMPY_TRIANGLES };
    match_mesh mesh = { "bumps", &desc, b.radiance };
    CHECK_EQUAL(probes_match(&mesh, 1, &(probe_set){ storage, BUMPY_TRIANGLES }, &result, message), HEMI_OK);
    CHECK_EQUAL(result.total.matched, BUMPY_TRIANGLES);
    /* Positions are float32 (1e-7 of the side) and the radiance changes by 17 over one cell, so 17*24*1e-7 at most. */
    CHECK(result.worst_difference < 4e-5 * sqrt(3.0));
    match_result_destroy(&result);
}

/* ---- speed ------------------------------------------------------------------------------------------------------ */

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A tessellated square of a million triangles, 6,000 probes. The limit is the promise of two seconds ten times over,
 * so that it holds under sanitizers; the time is printed. */
static void a_million_triangles_are_quick(void) {
    enum { N = 708, COUNT = 6000 };
    size_t vertices = (size_t)(N + 1) * (N + 1), triangles = 2 * (size_t)N * N;
    float *positions = malloc(3 * vertices * sizeof *positions), *radiance = malloc(3 * vertices * sizeof *radiance);
    uint32_t *indices = malloc(3 * triangles * sizeof *indices), *out = indices;
    probe *probes = calloc(COUNT, sizeof *probes);
    char message[PROBES_MESSAGE_SIZE];
    match_result result;
    for (size_t v = 0; v < vertices; v++) {
        positions[3 * v] = (float)(v % (N + 1)) / N;
        positions[3 * v + 1] = (float)(v / (N + 1)) / N;
        positions[3 * v + 2] = positions[3 * v]; /* sloped, so that boxes of triangles are fat */
        for (int c = 0; c < 3; c++) radiance[3 * v + (size_t)c] = 1.0f + positions[3 * v];
    }
    for (uint32_t j = 0; j < N; j++)
        for (uint32_t i = 0; i < N; i++, out += 6) {
            uint32_t v = j * (N + 1) + i;
            const uint32_t corners[6] = { v, v + 1, v + N + 2, v, v + N + 2, v + N + 1 };
            memcpy(out, corners, sizeof corners);
        }
    for (uint32_t i = 0; i < COUNT; i++) {
        float x = (float)((i * 2654435761u) >> 8) / 16777216.0f, y = (float)i / COUNT;
        probes[i] = (probe){ .position = { x, y, x }, .normal = { -0.70710678f, 0, 0.70710678f } };
        for (int c = 0; c < 3; c++) probes[i].radiance[c] = 1.0f + x;
    }
    hemi_mesh_desc desc = { .positions = positions, .indices = indices };
    desc.vertex_count = (uint32_t)vertices;
    desc.triangle_count = (uint32_t)triangles;
    match_mesh mesh = { "slope", &desc, radiance };
    double begin = seconds();
    CHECK_EQUAL(probes_match(&mesh, 1, &(probe_set){ probes, COUNT }, &result, message), HEMI_OK);
    double taken = seconds() - begin;
    printf("6,000 probes x %zu triangles: %.3f s\n", triangles, taken);
    CHECK(taken < 20.0);
    CHECK_EQUAL(result.total.matched, COUNT);
    CHECK_NEAR(match_error(&result.total), 0.0, 1e-6);
    match_result_destroy(&result);
    free(positions);
    free(radiance);
    free(indices);
    free(probes);
}

int main(void) {
    RUN(a_linear_ramp_has_no_error);
    RUN(an_offset_gives_its_closed_form);
    RUN(the_wrong_side_is_not_matched);
    RUN(a_probe_beyond_the_distance_is_not_matched);
    RUN(every_mesh_has_its_own_figure);
    RUN(the_worst_probe_is_named);
    RUN(the_middle_and_the_95th_percentile_are_of_each_probe_itself);
    RUN(a_mirrored_mesh_keeps_its_front);
    RUN(of_two_sheets_the_nearer_wins);
    RUN(of_two_facets_at_an_edge_the_better_facing_wins);
    RUN(triangles_without_area_are_passed_over);
    RUN(broken_meshes_are_refused_with_their_name);
    RUN(a_black_truth_has_no_relative_error);
    RUN(every_probe_finds_the_triangle_it_was_put_on);
    RUN(a_million_triangles_are_quick);
    return check_end();
}
