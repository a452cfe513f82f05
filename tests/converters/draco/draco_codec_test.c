/* SPDX-License-Identifier: MIT
 * Does a mesh come out of Draco with every triangle, within the error that was reported, whatever its shape?
 */
#include "check.h"
#include "draco_codec.h"

#include <stdlib.h>

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

typedef struct test_mesh {
    uint32_t vertex_count, triangle_count;
    float *positions, *colors, *uvs, *ids;
    uint32_t *indices;
} test_mesh;

static test_mesh make_mesh(uint32_t vertex_count, uint32_t triangle_count) {
    test_mesh mesh = { .vertex_count = vertex_count, .triangle_count = triangle_count };
    mesh.positions = calloc(vertex_count, 12);
    mesh.colors = calloc(vertex_count, 12);
    mesh.uvs = calloc(vertex_count, 8);
    mesh.ids = calloc(vertex_count, 4);
    mesh.indices = calloc(triangle_count, 12);
    return mesh;
}

static void free_mesh(test_mesh *mesh) {
    free(mesh->positions);
    free(mesh->colors);
    free(mesh->uvs);
    free(mesh->ids);
    free(mesh->indices);
}

/* A curved sheet of n x n squares, 3 m across; every vertex has an id of its own. */
static test_mesh make_sheet(uint32_t n) {
    test_mesh mesh = make_mesh((n + 1) * (n + 1), 2 * n * n);
    uint32_t v = 0, t = 0;
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++, v++) {
            float x = (float)i / (float)n, z = (float)j / (float)n;
            mesh.positions[3 * v] = 3 * x;
            mesh.positions[3 * v + 1] = 0.5f * x * z;
            mesh.positions[3 * v + 2] = 3 * z;
            for (uint32_t c = 0; c < 3; c++) mesh.colors[3 * v + c] = (float)((v * 7 + c * 5) % 97) / 96.0f;
            mesh.uvs[2 * v] = x;
            mesh.uvs[2 * v + 1] = z;
            mesh.ids[v] = (float)v;
        }
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++, t += 2) {
            uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            uint32_t corners[6] = { a, c, b, b, c, d };
            memcpy(mesh.indices + 3 * t, corners, sizeof corners);
        }
    return mesh;
}

enum { POSITION, COLOR, UV, ID, ATTRIBUTES };

static hemi_result encode_mesh(const test_mesh *mesh, int level, bool with_ids, draco_codec_encoded *out) {
    draco_codec_attribute attributes[ATTRIBUTES] = {
        { DRACO_CODEC_POSITION, 3, 14, mesh->positions, NULL, 0 },
        { DRACO_CODEC_COLOR, 3, 12, mesh->colors, NULL, 0 },
        { DRACO_CODEC_TEXCOORD, 2, 12, mesh->uvs, NULL, 0 },
        { DRACO_CODEC_GENERIC, 1, 0, mesh->ids, NULL, 0 },
    };
    draco_codec_encode_desc desc = { attributes,
                                     with_ids ? ATTRIBUTES : ATTRIBUTES - 1,
                                     mesh->vertex_count,
                                     mesh->indices,
                                     mesh->triangle_count,
                                     level,
                                     false };
    return draco_codec_encode(&desc, out);
}

static draco_codec_mesh *decode_mesh(const draco_codec_encoded *encoded) {
    draco_codec_mesh *mesh = NULL;
    CHECK_EQUAL(draco_codec_decode(encoded->bytes, encoded->byte_count, UINT32_MAX, UINT32_MAX, &mesh), HEMI_OK);
    return mesh;
}

static double distance(const float *a, const float *b) {
    double x = (double)a[0] - b[0], y = (double)a[1] - b[1], z = (double)a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

/* ---- what survives ----------------------------------------------------------------------------------------------- */

/* The errors as the lossless ids tell them, which is another way than the codec's own. */
static void check_against_ids(const test_mesh *mesh, const draco_codec_encoded *encoded) {
    draco_codec_mesh *decoded = decode_mesh(encoded);
    if (!decoded) return;
    uint32_t points = draco_codec_mesh_point_count(decoded);
    float *positions = calloc(points, 12), *colors = calloc(points, 12), *ids = calloc(points, 4);
    CHECK(draco_codec_mesh_values(decoded, encoded->unique_ids[POSITION], 3, positions));
    CHECK(draco_codec_mesh_values(decoded, encoded->unique_ids[COLOR], 3, colors));
    CHECK(draco_codec_mesh_values(decoded, encoded->unique_ids[ID], 1, ids));
    double worst_position = 0, worst_color = 0;
    for (uint32_t p = 0; p < points; p++) {
        uint32_t v = (uint32_t)ids[p];
        worst_position = fmax(worst_position, distance(positions + 3 * p, mesh->positions + 3 * v));
        for (int c = 0; c < 3; c++)
            worst_color = fmax(worst_color, fabs((double)colors[3 * p + c] - mesh->colors[3 * v + c]));
    }
    CHECK_EQUAL(points, mesh->vertex_count);
    CHECK_NEAR(worst_position, encoded->max_error[POSITION], 0);
    CHECK_NEAR(worst_color, encoded->max_error[COLOR], 0);
    /* half a step an axis: the range over 2^bits - 1; 1e-6: floats of a few metres */
    CHECK(worst_position <= sqrt(3.0) * 0.5 * 3 / 16383 + 1e-6);
    CHECK(worst_color <= 0.5 / 4095 + 1e-6);
    free(positions);
    free(colors);
    free(ids);
    draco_codec_mesh_destroy(decoded);
}

static void reported_errors_are_those_that_lossless_ids_show(void) {
    test_mesh mesh = make_sheet(20);
    for (int level = 0; level <= 10; level++) {
        draco_codec_encoded encoded;
        CHECK_EQUAL(encode_mesh(&mesh, level, true, &encoded), HEMI_OK);
        CHECK_NEAR(encoded.max_error[ID], 0, 0);
        CHECK_EQUAL(encoded.face_count, mesh.triangle_count);
        check_against_ids(&mesh, &encoded);
        draco_codec_encoded_free(&encoded);
    }
    free_mesh(&mesh);
}

static int compare_triangles(const void *a, const void *b) {
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* Ids of corners, the smallest first, so that equal triangles have equal numbers; then the triangles in order. */
static void sort_triangles(uint32_t *corners, uint32_t count) {
    for (uint32_t t = 0; t < count; t++) {
        uint32_t *c = corners + 3 * t, turned[3];
        int first = c[0] < c[1] ? (c[0] < c[2] ? 0 : 2) : (c[1] < c[2] ? 1 : 2);
        for (int k = 0; k < 3; k++) turned[k] = c[(first + k) % 3];
        memcpy(c, turned, sizeof turned);
    }
    qsort(corners, count, 3 * sizeof *corners, compare_triangles);
}

static void the_same_triangles_come_back_wound_the_same_way(void) {
    test_mesh mesh = make_sheet(16);
    for (int level = 0; level <= 10; level += 5) {
        draco_codec_encoded encoded;
        CHECK_EQUAL(encode_mesh(&mesh, level, true, &encoded), HEMI_OK);
        draco_codec_mesh *decoded = decode_mesh(&encoded);
        if (!decoded) continue;
        uint32_t faces = draco_codec_mesh_face_count(decoded), points = draco_codec_mesh_point_count(decoded);
        uint32_t *corners = calloc(faces, 12), *expected = calloc(mesh.triangle_count, 12);
        float *ids = calloc(points, 4);
        draco_codec_mesh_indices(decoded, corners);
        draco_codec_mesh_values(decoded, encoded.unique_ids[ID], 1, ids);
        for (uint32_t i = 0; i < 3 * faces; i++) corners[i] = (uint32_t)ids[corners[i]];
        memcpy(expected, mesh.indices, 12 * mesh.triangle_count);
        CHECK_EQUAL(faces, mesh.triangle_count);
        sort_triangles(corners, faces);
        sort_triangles(expected, faces);
        CHECK_EQUAL(memcmp(corners, expected, 12 * faces), 0);
        free(corners);
        free(expected);
        free(ids);
        draco_codec_mesh_destroy(decoded);
        draco_codec_encoded_free(&encoded);
    }
    free_mesh(&mesh);
}

static void equal_vertices_are_merged_and_counted(void) {
    test_mesh sheet = make_sheet(8), soup = make_mesh(3 * sheet.triangle_count, sheet.triangle_count);
    for (uint32_t i = 0; i < 3 * sheet.triangle_count; i++) { /* every triangle with corners of its own */
        memcpy(soup.positions + 3 * i, sheet.positions + 3 * sheet.indices[i], 12);
        memcpy(soup.colors + 3 * i, sheet.colors + 3 * sheet.indices[i], 12);
        memcpy(soup.uvs + 2 * i, sheet.uvs + 2 * sheet.indices[i], 8);
        soup.indices[i] = i;
    }
    draco_codec_encoded encoded;
    CHECK_EQUAL(encode_mesh(&soup, 7, false, &encoded), HEMI_OK);
    CHECK_EQUAL(encoded.point_count, sheet.vertex_count);
    CHECK_EQUAL(encoded.face_count, sheet.triangle_count);
    CHECK(!encoded.sequential);
    draco_codec_encoded_free(&encoded);
    free_mesh(&sheet);
    free_mesh(&soup);
}

static void triangles_without_area_are_not_lost(void) {
    test_mesh mesh = make_sheet(4);
    mesh.indices[3] = mesh.indices[4] = mesh.indices[5]; /* one triangle is a point, ... */
    memcpy(mesh.positions + 3 * mesh.indices[30], mesh.positions + 3 * mesh.indices[31], 12); /* ... one a line */
    draco_codec_encoded encoded;
    CHECK_EQUAL(encode_mesh(&mesh, 7, false, &encoded), HEMI_OK);
    CHECK(encoded.sequential);
    CHECK_EQUAL(encoded.face_count, mesh.triangle_count);
    draco_codec_encoded_free(&encoded);
    free_mesh(&mesh);
}

static void bounds_hold_for_the_decoded_values(void) {
    test_mesh mesh = make_sheet(9);
    draco_codec_encoded encoded;
    CHECK_EQUAL(encode_mesh(&mesh, 7, false, &encoded), HEMI_OK);
    draco_codec_mesh *decoded = decode_mesh(&encoded);
    uint32_t points = draco_codec_mesh_point_count(decoded);
    float *positions = calloc(points, 12);
    draco_codec_mesh_values(decoded, encoded.unique_ids[POSITION], 3, positions);
    for (uint32_t i = 0; i < 3 * points; i++)
        CHECK(positions[i] >= encoded.lower[POSITION][i % 3] && positions[i] <= encoded.upper[POSITION][i % 3]);
    free(positions);
    draco_codec_mesh_destroy(decoded);
    draco_codec_encoded_free(&encoded);
    free_mesh(&mesh);
}

static void higher_levels_are_not_larger(void) {
    test_mesh mesh = make_sheet(60);
    draco_codec_encoded fast, small;
    CHECK_EQUAL(encode_mesh(&mesh, 0, false, &fast), HEMI_OK);
    CHECK_EQUAL(encode_mesh(&mesh, 10, false, &small), HEMI_OK);
    CHECK(small.byte_count <= fast.byte_count);
    CHECK(fast.byte_count < 32 * mesh.vertex_count + 12 * mesh.triangle_count);
    draco_codec_encoded_free(&fast);
    draco_codec_encoded_free(&small);
    free_mesh(&mesh);
}

/* ---- what is refused ---- */

static void broken_meshes_are_refused(void) {
    test_mesh mesh = make_sheet(2);
    draco_codec_encoded encoded;
    CHECK_EQUAL(encode_mesh(&mesh, 11, false, &encoded), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(encode_mesh(&mesh, -1, false, &encoded), HEMI_ERROR_ARGUMENT);
    mesh.indices[0] = mesh.vertex_count;
    CHECK_EQUAL(encode_mesh(&mesh, 7, false, &encoded), HEMI_ERROR_ARGUMENT);
    mesh.indices[0] = 0;
    mesh.colors[5] = NAN;
    CHECK_EQUAL(encode_mesh(&mesh, 7, false, &encoded), HEMI_ERROR_ARGUMENT);
    CHECK(encoded.bytes == NULL);
    CHECK_EQUAL(draco_codec_encode(NULL, &encoded), HEMI_ERROR_ARGUMENT);
    free_mesh(&mesh);
}

static void limits_are_kept_before_memory_is_spent(void) {
    test_mesh mesh = make_sheet(10);
    draco_codec_encoded encoded;
    draco_codec_mesh *decoded = NULL;
    CHECK_EQUAL(encode_mesh(&mesh, 7, false, &encoded), HEMI_OK);
    CHECK_EQUAL(draco_codec_decode(encoded.bytes, encoded.byte_count, 10, 1000, &decoded), HEMI_ERROR_LIMIT);
    CHECK_EQUAL(draco_codec_decode(encoded.bytes, encoded.byte_count, 1000, 10, &decoded), HEMI_ERROR_LIMIT);
    CHECK_EQUAL(draco_codec_decode((const uint8_t *)"DRACO", 5, 10, 10, &decoded), HEMI_ERROR_DATA);
    CHECK_EQUAL(draco_codec_decode(NULL, 0, 10, 10, &decoded), HEMI_ERROR_ARGUMENT);
    CHECK(decoded == NULL);
    draco_codec_encoded_free(&encoded);
    free_mesh(&mesh);
}

/* Decodes a copy of exactly that size, so that the sanitizers see a step too far. */
static void try_bytes(const uint8_t *bytes, size_t size, int *decoded_count) {
    uint8_t *copy = malloc(size ? size : 1);
    memcpy(copy, bytes, size);
    draco_codec_mesh *mesh = NULL;
    if (draco_codec_decode(copy, size, 10000, 10000, &mesh) == HEMI_OK) {
        uint32_t points = draco_codec_mesh_point_count(mesh), faces = draco_codec_mesh_face_count(mesh);
        float *values = calloc((size_t)points + 1, 16);
        uint32_t *indices = calloc((size_t)faces + 1, 12);
        draco_codec_mesh_indices(mesh, indices);
        for (uint32_t id = 0; id < ATTRIBUTES; id++)
            draco_codec_mesh_values(mesh, id, draco_codec_mesh_components(mesh, id), values);
        free(values);
        free(indices);
        (*decoded_count)++;
    }
    draco_codec_mesh_destroy(mesh);
    free(copy);
}

/* Some mutants take libdraco seconds: it believes counts of up to 2^31 texture seams. */
static void mutilated_bytes_do_no_harm(void) {
    test_mesh mesh = make_sheet(6);
    uint32_t state = 1989;
    for (int level = 0; level <= 10; level += 5) {
        draco_codec_encoded encoded;
        int decoded = 0;
        CHECK_EQUAL(encode_mesh(&mesh, level, true, &encoded), HEMI_OK);
        for (size_t size = 0; size < encoded.byte_count; size++) try_bytes(encoded.bytes, size, &decoded);
        for (int i = 0; i < 1200; i++) {
            state = state * 1664525u + 1013904223u;
            size_t at = (state >> 8) % encoded.byte_count;
            uint8_t was = encoded.bytes[at];
            encoded.bytes[at] = (uint8_t)(state >> 24) ^ (uint8_t)i;
            try_bytes(encoded.bytes, encoded.byte_count, &decoded);
            encoded.bytes[at] = was;
        }
        CHECK(decoded > 0);
        draco_codec_encoded_free(&encoded);
    }
    free_mesh(&mesh);
}

/* Its part is what the errors are measured by. */
static void a_second_thread_leaves_no_trace(void) {
    test_mesh mesh = make_sheet(60);
    draco_codec_attribute attributes[] = { { DRACO_CODEC_POSITION, 3, 14, mesh.positions, NULL, 0 },
                                           { DRACO_CODEC_COLOR, 3, 12, mesh.colors, NULL, 0 } };
    draco_codec_encoded encoded[2];
    for (int i = 0; i < 2; i++) {
        draco_codec_encode_desc desc = {
            attributes, 2, mesh.vertex_count, mesh.indices, mesh.triangle_count, 7, i == 1
        };
        CHECK_EQUAL(draco_codec_encode(&desc, &encoded[i]), HEMI_OK);
    }
    CHECK_EQUAL(encoded[0].byte_count, encoded[1].byte_count);
    CHECK(encoded[0].bytes && memcmp(encoded[0].bytes, encoded[1].bytes, encoded[0].byte_count) == 0);
    for (int a = 0; a < 2; a++) {
        CHECK(encoded[0].max_error[a] > 0);
        CHECK_NEAR(encoded[1].max_error[a], encoded[0].max_error[a], 0);
    }
    for (int i = 0; i < 2; i++) draco_codec_encoded_free(&encoded[i]);
    free_mesh(&mesh);
}

int main(void) {
    RUN(reported_errors_are_those_that_lossless_ids_show);
    RUN(the_same_triangles_come_back_wound_the_same_way);
    RUN(equal_vertices_are_merged_and_counted);
    RUN(triangles_without_area_are_not_lost);
    RUN(a_second_thread_leaves_no_trace);
    RUN(bounds_hold_for_the_decoded_values);
    RUN(higher_levels_are_not_larger);
    RUN(broken_meshes_are_refused);
    RUN(limits_are_kept_before_memory_is_spent);
    RUN(mutilated_bytes_do_no_harm);
    return check_end();
}
