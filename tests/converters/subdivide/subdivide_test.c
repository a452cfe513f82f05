/* SPDX-License-Identifier: MIT
 * Are the vertices on the limit surface, do topology and outline survive, and is what has no surface refused? */
#include "check.h"
#include "subdivide.h"

#include <stdlib.h>

/* ---- cages ------------------------------------------------------------------------------------------------------ */

/* Corner v of the cube from -1 to 1 is at the signs of its bits. Every face as two triangles, outward. */
static const uint32_t cube_indices[36] = { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                           2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };

static void cube_positions(float positions[24]) {
    for (int i = 0; i < 24; i++) positions[i] = (i / 3) >> (i % 3) & 1 ? 1.0f : -1.0f;
}

static const float octahedron_positions[18] = { 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1 };
static const uint32_t octahedron_indices[24] = {
    0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5
};

static const float tetrahedron_positions[12] = { 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1 };
static const uint32_t tetrahedron_indices[12] = { 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2 };

#define GOLDEN 1.6180339887f
static const float icosahedron_positions[36] = { -1, GOLDEN, 0, 1, GOLDEN,  0, -1, -GOLDEN, 0, 1, -GOLDEN, 0,      0,
                                                 -1, GOLDEN, 0, 1, GOLDEN,  0, -1, -GOLDEN, 0, 1, -GOLDEN, GOLDEN, 0,
                                                 -1, GOLDEN, 0, 1, -GOLDEN, 0, -1, -GOLDEN, 0, 1 };
static const uint32_t icosahedron_indices[60] = { 0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                                                  4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                                                  6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1 };

/* What the mesh that was described last is: tests have one at a time, and change it here. */
static hemi_subdivision_desc how;

static hemi_mesh_desc describe(const float *positions, uint32_t vertices, const uint32_t *indices, uint32_t triangles,
                               hemi_subdivision_scheme scheme, uint32_t level) {
    how = (hemi_subdivision_desc){ .struct_size = sizeof how, .scheme = scheme, .level = level };
    return (hemi_mesh_desc){ .struct_size = sizeof(hemi_mesh_desc),
                             .positions = positions,
                             .vertex_count = vertices,
                             .indices = indices,
                             .triangle_count = triangles,
                             .subdivision = &how };
}

static hemi_mesh_desc cube(float positions[24], uint32_t level) {
    cube_positions(positions);
    return describe(positions, 8, cube_indices, 12, HEMI_SUBDIVISION_CATMULL_CLARK, level);
}

static hemi_mesh_desc octahedron(uint32_t level) {
    return describe(octahedron_positions, 6, octahedron_indices, 8, HEMI_SUBDIVISION_LOOP, level);
}

/* ---- what a surface is ---- */

static subdivide_surface make(const hemi_mesh_desc *mesh) {
    char message[SUBDIVIDE_MESSAGE_SIZE];
    subdivide_surface surface;
    CHECK_EQUAL(subdivide_mesh(NULL, mesh, 0, &surface, message), HEMI_OK);
    CHECK_TEXT(message, "");
    return surface;
}

static void facet(const subdivide_surface *s, size_t triangle, double normal[3]) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        const uint32_t *c = s->indices + 3 * triangle;
        u[k] = (double)s->positions[3 * c[1] + (uint32_t)k] - s->positions[3 * c[0] + (uint32_t)k];
        v[k] = (double)s->positions[3 * c[2] + (uint32_t)k] - s->positions[3 * c[0] + (uint32_t)k];
    }
    for (int k = 0; k < 3; k++) normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

static int compare_edges(const void *a, const void *b) {
    return memcmp(a, b, 2 * sizeof(uint32_t));
}

/* Edges, each counted once. */
static size_t count_edges(const subdivide_surface *s) {
    size_t count = 3 * (size_t)s->triangle_count, distinct = 0;
    uint32_t(*edges)[2] = malloc(count * sizeof *edges);
    for (size_t i = 0; i < count; i++) {
        uint32_t a = s->indices[i], b = s->indices[i % 3 == 2 ? i - 2 : i + 1];
        edges[i][0] = a < b ? a : b;
        edges[i][1] = a < b ? b : a;
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t i = 0; i < count; i++) distinct += i == 0 || memcmp(edges[i], edges[i - 1], sizeof *edges) != 0;
    free(edges);
    return distinct;
}

static long euler(const subdivide_surface *s) {
    return (long)s->vertex_count - (long)count_edges(s) + (long)s->triangle_count;
}

/* A closed surface around the origin, star-shaped: facets have area and face outward, and so do the unit normals. */
static void check_closed(const subdivide_surface *s) {
    CHECK_EQUAL(euler(s), 2);
    CHECK_EQUAL(2 * count_edges(s), 3 * (size_t)s->triangle_count);
    for (size_t t = 0; t < s->triangle_count; t++) {
        double n[3], outward = 0.0;
        facet(s, t, n);
        for (int k = 0; k < 3; k++) outward += n[k] * s->positions[3 * s->indices[3 * t] + (uint32_t)k];
        CHECK(sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) > 0.0);
        CHECK(outward > 0.0);
    }
    for (size_t v = 0; v < s->vertex_count; v++) {
        const float *n = s->normals + 3 * v, *x = s->positions + 3 * v;
        CHECK_NEAR(sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]), 1.0, 1e-6);
        CHECK((double)n[0] * x[0] + (double)n[1] * x[1] + (double)n[2] * x[2] > 0.0);
    }
}

/* Index of the vertex nearest to a place; the distance is checked. */
static size_t find(const subdivide_surface *s, double x, double y, double z, double tolerance) {
    size_t best = 0;
    double nearest = HUGE_VAL;
    for (size_t v = 0; v < s->vertex_count; v++) {
        const float *p = s->positions + 3 * v;
        double distance = hypot(hypot(p[0] - x, p[1] - y), p[2] - z);
        if (distance < nearest) {
            nearest = distance;
            best = v;
        }
    }
    CHECK_NEAR(nearest, 0.0, tolerance);
    return best;
}

/* ---- Catmull-Clark ---------------------------------------------------------------------------------------------- */

/* The limit of a vertex of n quads is (n^2 v + 4 sum of edge neighbours + sum of opposite corners) / (n (n + 5))
 * [Halstead93]. For a corner of the cube, n = 3: (9 + 4 - 1) / 24 = 1/2 on each axis. The other two come from the first
 * refinement: face point 1, edge point (3/4, 0, 3/4), vertex point 5/9, n = 4:
 *     middle of a face: (16 + 4 * 3 + 4 * 5/9) / 36 = 68/81
 *     middle of an edge: (16 * 3/4 + 4 * (1 + 2 * 5/9) + 2 * 3/4) / 36 = 395/648 */
static void a_cube_has_its_closed_form_limit(void) {
    float positions[24];
    for (uint32_t level = 1; level <= 4; level++) {
        hemi_mesh_desc mesh = cube(positions, level);
        subdivide_surface s = make(&mesh);
        /* Doubles rounded to float32 once: half of 2^-24 on three axes. */
        find(&s, 0.5, 0.5, 0.5, 6e-8);
        find(&s, -0.5, 0.5, -0.5, 6e-8);
        find(&s, 0.0, 0.0, 68.0 / 81.0, 6e-8);
        find(&s, 0.0, -68.0 / 81.0, 0.0, 6e-8);
        find(&s, 395.0 / 648.0, 0.0, -395.0 / 648.0, 6e-8);
        CHECK_EQUAL(s.cage_faces, 6);
        CHECK_EQUAL(s.cage_quads, 6);
        CHECK_EQUAL(s.triangle_count, 12u << 2 * level);
        CHECK_EQUAL(s.vertex_count, (6u << 2 * level) + 2);
        check_closed(&s);
        subdivide_surface_destroy(&s);
    }
}

/* All its edges as hard as edges get: the corners stay, and edges and faces with them. */
static void a_cube_of_hard_edges_stays_a_cube(void) {
    float positions[24], sharpness[12];
    uint32_t edges[24], count = 0;
    for (uint32_t i = 0; i < 8; i++)
        for (uint32_t bit = 1; bit < 8; bit *= 2)
            if (!(i & bit)) edges[2 * count] = i, edges[2 * count + 1] = i | bit, sharpness[count++] = 10.0f;
    CHECK_EQUAL(count, 12);
    hemi_mesh_desc mesh = cube(positions, 2);
    how.crease_edges = edges, how.crease_sharpness = sharpness, how.crease_count = count;
    subdivide_surface s = make(&mesh);
    find(&s, 1.0, 1.0, 1.0, 6e-8);
    find(&s, 1.0, 0.0, -1.0, 6e-8);
    find(&s, 0.0, 0.0, 1.0, 6e-8);
    subdivide_surface_destroy(&s);
}

static void limit_normals_of_a_cube_follow_its_symmetry(void) {
    float positions[24];
    hemi_mesh_desc mesh = cube(positions, 2);
    subdivide_surface s = make(&mesh);
    size_t corner = find(&s, 0.5, 0.5, 0.5, 6e-8), face = find(&s, 0.0, 0.0, 68.0 / 81.0, 6e-8);
    for (size_t k = 0; k < 3; k++) CHECK_NEAR(s.normals[3 * corner + k], 1.0 / sqrt(3.0), 1e-7);
    CHECK_NEAR(s.normals[3 * face + 2], 1.0, 1e-7);
    subdivide_surface_destroy(&s);
}

/* Exporters split vertices for their normals: 24 of them, some at -0. The surface must not tear. */
static void split_vertices_are_welded(void) {
    float positions[24], split[36 * 3];
    uint32_t indices[36];
    hemi_mesh_desc mesh = cube(positions, 2);
    subdivide_surface whole = make(&mesh);
    for (uint32_t i = 0; i < 36; i++) {
        memcpy(split + 3 * i, positions + 3 * cube_indices[i], 3 * sizeof *split);
        indices[i] = i;
    }
    hemi_mesh_desc torn = describe(split, 36, indices, 12, HEMI_SUBDIVISION_CATMULL_CLARK, 2);
    subdivide_surface s = make(&torn);
    CHECK_EQUAL(s.vertex_count, whole.vertex_count);
    CHECK_EQUAL(s.triangle_count, whole.triangle_count);
    CHECK_EQUAL(euler(&s), 2);
    subdivide_surface_destroy(&s);
    subdivide_surface_destroy(&whole);
}

/* A square at z = 0 and -0, its two halves with vertices of their own. */
static void minus_zero_is_zero(void) {
    const float positions[18] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, -0.0f, 0, -0.0f, 1, 1, -0.0f, 0, 1, 0 };
    const uint32_t indices[6] = { 0, 1, 2, 3, 4, 5 };
    hemi_mesh_desc mesh = describe(positions, 6, indices, 2, HEMI_SUBDIVISION_CATMULL_CLARK, 1);
    subdivide_surface s = make(&mesh);
    CHECK_EQUAL(s.cage_quads, 1);
    CHECK_EQUAL(s.vertex_count, 9);
    subdivide_surface_destroy(&s);
}

enum { GRID = 5, GRID_VERTICES = (GRID + 1) * (GRID + 1), GRID_TRIANGLES = 2 * GRID * GRID };

/* Squares in a plane, all lower triangles before all upper ones, so that the order in the file says nothing. */
static void make_grid(float *positions, uint32_t *indices) {
    for (uint32_t v = 0; v < GRID_VERTICES; v++) {
        positions[3 * v] = (float)(v % (GRID + 1));
        positions[3 * v + 1] = (float)(v / (GRID + 1));
        positions[3 * v + 2] = 0.25f * positions[3 * v]; /* a tilted plane */
    }
    for (uint32_t q = 0; q < GRID * GRID; q++) {
        uint32_t v = q / GRID * (GRID + 1) + q % GRID, up = v + GRID + 1;
        const uint32_t lower[3] = { v, v + 1, up + 1 }, upper[3] = { v, up + 1, up };
        memcpy(indices + 3 * q, lower, sizeof lower);
        memcpy(indices + 3 * (q + GRID * GRID), upper, sizeof upper);
    }
}

static void a_triangulated_grid_is_paired_back_into_its_squares(void) {
    float positions[3 * GRID_VERTICES];
    uint32_t indices[3 * GRID_TRIANGLES];
    make_grid(positions, indices);
    hemi_mesh_desc mesh =
        describe(positions, GRID_VERTICES, indices, GRID_TRIANGLES, HEMI_SUBDIVISION_CATMULL_CLARK, 1);
    subdivide_surface s = make(&mesh);
    CHECK_EQUAL(s.cage_faces, GRID * GRID);
    CHECK_EQUAL(s.cage_quads, GRID * GRID);
    /* Midpoints of the squares exist only if the squares do; the grid is regular, so the limit keeps them. */
    find(&s, 2.5, 2.5, 0.625, 1e-6);
    subdivide_surface_destroy(&s);
}

static void an_open_sheet_keeps_its_plane_outline_and_corners(void) {
    float positions[3 * GRID_VERTICES];
    uint32_t indices[3 * GRID_TRIANGLES];
    make_grid(positions, indices);
    for (int scheme = HEMI_SUBDIVISION_CATMULL_CLARK; scheme <= HEMI_SUBDIVISION_LOOP; scheme++) {
        hemi_mesh_desc mesh =
            describe(positions, GRID_VERTICES, indices, GRID_TRIANGLES, (hemi_subdivision_scheme)scheme, 3);
        subdivide_surface s = make(&mesh);
        CHECK_EQUAL(euler(&s), 1);
        for (size_t v = 0; v < s.vertex_count; v++) {
            const float *p = s.positions + 3 * v, *n = s.normals + 3 * v;
            CHECK_NEAR(p[2], 0.25 * p[0], 1e-6);
            CHECK(p[0] > -1e-6f && p[0] < GRID + 1e-6f && p[1] > -1e-6f && p[1] < GRID + 1e-6f);
            CHECK_NEAR(n[0] * -0.25 + n[2], sqrt(1.0625), 1e-6); /* along the plane's own normal */
        }
        double area = 0.0;
        for (size_t t = 0; t < s.triangle_count; t++) {
            double n[3];
            facet(&s, t, n);
            CHECK(n[2] > 0.0);
            area += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        }
        /* The corner where two triangles meet belongs to two Loop faces, which is no sharp corner: it is cut. */
        double whole = GRID * GRID * sqrt(1.0625);
        if (scheme == HEMI_SUBDIVISION_CATMULL_CLARK)
            CHECK_NEAR(area, whole, 1e-5);
        else
            CHECK(area < whole && area > 0.98 * whole);
        subdivide_surface_destroy(&s);
    }
}

/* Triangles that were no quad stay: the octahedron has no coplanar pairs. */
static void catmull_clark_takes_triangles_too(void) {
    hemi_mesh_desc mesh = octahedron(2);
    how.scheme = HEMI_SUBDIVISION_CATMULL_CLARK;
    subdivide_surface s = make(&mesh);
    CHECK_EQUAL(s.cage_faces, 8);
    CHECK_EQUAL(s.cage_quads, 0);
    CHECK_EQUAL(s.triangle_count, 8 * 3 * 4 * 2);
    check_closed(&s);
    subdivide_surface_destroy(&s);
}

/* A dart (a quad with a corner that points inward) is two triangles. */
static void quads_that_are_not_convex_are_not_made(void) {
    const float positions[12] = { 0, 0, 0, 2, -1, 0, 0.5f, 0, 0, 2, 1, 0 };
    const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    hemi_mesh_desc mesh = describe(positions, 4, indices, 2, HEMI_SUBDIVISION_CATMULL_CLARK, 1);
    subdivide_surface s = make(&mesh);
    CHECK_EQUAL(s.cage_quads, 0);
    CHECK_EQUAL(s.cage_faces, 2);
    subdivide_surface_destroy(&s);
}

/* ---- Loop ------------------------------------------------------------------------------------------------------- */

/* The limit of a vertex of n triangles is (1 - n chi) v + chi sum of neighbours, chi = 1 / (3 / (8 beta) + n) [Loop87];
 * in these solids the neighbours sum to s v. Returns the factor on v. */
static double loop_limit(int n, double neighbour_sum) {
    double inner = 0.375 + 0.25 * cos(2.0 * acos(-1.0) / n), beta = (0.625 - inner * inner) / n;
    double chi = 1.0 / (0.375 / beta + n);
    return 1.0 - n * chi + chi * neighbour_sum;
}

static void check_solid(hemi_mesh_desc mesh, double factor) {
    for (uint32_t level = 1; level <= 4; level++) {
        how.level = level;
        subdivide_surface s = make(&mesh);
        CHECK_EQUAL(s.triangle_count, mesh.triangle_count << 2 * level);
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            const float *p = mesh.positions + 3 * v;
            size_t found = find(&s, factor * p[0], factor * p[1], factor * p[2], 1.5e-7);
            double length = sqrt((double)p[0] * p[0] + (double)p[1] * p[1] + (double)p[2] * p[2]);
            for (size_t k = 0; k < 3; k++) CHECK_NEAR(s.normals[3 * found + k], p[k] / length, 1e-6);
        }
        check_closed(&s);
        subdivide_surface_destroy(&s);
    }
}

static void the_solids_have_their_closed_form_loop_limits(void) {
    CHECK_NEAR(loop_limit(4, 0.0), 24.0 / 55.0, 1e-15);
    check_solid(octahedron(1), 24.0 / 55.0);
    check_solid(describe(tetrahedron_positions, 4, tetrahedron_indices, 4, HEMI_SUBDIVISION_LOOP, 1),
                loop_limit(3, -1.0));
    check_solid(describe(icosahedron_positions, 12, icosahedron_indices, 20, HEMI_SUBDIVISION_LOOP, 1),
                loop_limit(5, sqrt(5.0)));
}

/* Halving the edges divides the distance between facets and surface by four: the volume converges at that rate. */
static double volume(const subdivide_surface *s) {
    double sum = 0.0;
    for (size_t t = 0; t < s->triangle_count; t++) {
        double n[3];
        facet(s, t, n);
        for (int k = 0; k < 3; k++) sum += n[k] * s->positions[3 * s->indices[3 * t] + (uint32_t)k] / 6.0;
    }
    return sum;
}

static void volumes_converge_with_second_order(void) {
    float positions[24];
    for (int scheme = HEMI_SUBDIVISION_CATMULL_CLARK; scheme <= HEMI_SUBDIVISION_LOOP; scheme++) {
        double v[4];
        for (uint32_t level = 2; level <= 5; level++) {
            hemi_mesh_desc mesh = scheme == HEMI_SUBDIVISION_LOOP ? octahedron(level) : cube(positions, level);
            subdivide_surface s = make(&mesh);
            v[level - 2] = volume(&s);
            subdivide_surface_destroy(&s);
        }
        for (int i = 0; i < 2; i++) CHECK_NEAR((v[i + 1] - v[i]) / (v[i + 2] - v[i + 1]), 4.0, 0.3);
    }
}

/* ---- hard and broken cages -------------------------------------------------------------------------------------- */

static hemi_result attempt(const hemi_mesh_desc *mesh, uint32_t max_triangles, char *message) {
    subdivide_surface s;
    hemi_result result = subdivide_mesh(NULL, mesh, max_triangles, &s, message);
    CHECK((result == HEMI_OK) == (message[0] == '\0'));
    CHECK((result == HEMI_OK) == (s.positions != NULL));
    subdivide_surface_destroy(&s);
    return result;
}

static void bad_levels_and_schemes_are_refused(void) {
    char message[SUBDIVIDE_MESSAGE_SIZE];
    float positions[24];
    hemi_mesh_desc mesh = cube(positions, 0);
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_ARGUMENT);
    how.level = SUBDIVIDE_LEVEL_MAX + 1;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_ARGUMENT);
    how.level = 1;
    how.scheme = HEMI_SUBDIVISION_NONE;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(attempt(NULL, 0, message), HEMI_ERROR_ARGUMENT);
    how.scheme = HEMI_SUBDIVISION_LOOP;
    mesh.positions = NULL;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_ARGUMENT);
}

static void the_limit_on_triangles_is_exact(void) {
    char message[SUBDIVIDE_MESSAGE_SIZE];
    float positions[24];
    hemi_mesh_desc mesh = cube(positions, 3);
    CHECK_EQUAL(attempt(&mesh, 768, message), HEMI_OK);
    CHECK_EQUAL(attempt(&mesh, 767, message), HEMI_ERROR_LIMIT);
    CHECK(strstr(message, "768") && strstr(message, "767"));
}

static void the_deepest_level_works(void) {
    hemi_mesh_desc mesh = octahedron(SUBDIVIDE_LEVEL_MAX);
    subdivide_surface s = make(&mesh);
    CHECK_EQUAL(s.triangle_count, 8u << 16);
    subdivide_surface_destroy(&s);
}

static void malformed_meshes_are_refused(void) {
    char message[SUBDIVIDE_MESSAGE_SIZE];
    float positions[24];
    uint32_t indices[36];
    hemi_mesh_desc mesh = cube(positions, 1);
    memcpy(indices, cube_indices, sizeof indices);
    mesh.indices = indices;
    indices[7] = 8;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "triangle 2"));
    indices[7] = UINT32_MAX;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
    indices[7] = 5;
    positions[4] = NAN;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "vertex 1"));
    positions[4] = INFINITY;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
    mesh.triangle_count = 0;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
}

/* A fin on a cube, and a face turned round. */
static void cages_that_are_no_manifold_are_refused(void) {
    char message[SUBDIVIDE_MESSAGE_SIZE];
    float positions[27] = { 0 };
    uint32_t indices[39];
    for (int scheme = HEMI_SUBDIVISION_CATMULL_CLARK; scheme <= HEMI_SUBDIVISION_LOOP; scheme++) {
        hemi_mesh_desc mesh = cube(positions, 1);
        how.scheme = (hemi_subdivision_scheme)scheme;
        memcpy(indices, cube_indices, sizeof cube_indices);
        mesh.indices = indices;
        indices[0] = 3;
        indices[1] = 2;
        indices[2] = 0;
        CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
        CHECK(strstr(message, "wound against"));
        memcpy(indices, cube_indices, sizeof cube_indices);
        positions[24] = positions[25] = positions[26] = 3.0f;
        indices[36] = 3;
        indices[37] = 2;
        indices[38] = 8;
        mesh.vertex_count = 9;
        mesh.triangle_count = 13;
        CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
        CHECK(strstr(message, "more than two faces"));
    }
}

/* A sphere's pole as exporters write it: triangles with two corners in one place. */
static void collapsed_triangles_are_dropped_and_counted(void) {
    char message[SUBDIVIDE_MESSAGE_SIZE];
    float positions[27];
    uint32_t indices[42];
    hemi_mesh_desc mesh = cube(positions, 1);
    memcpy(positions + 24, positions, 3 * sizeof *positions); /* vertex 8 is where vertex 0 is */
    memcpy(indices, cube_indices, sizeof cube_indices);
    const uint32_t collapsed[6] = { 0, 8, 1, 5, 5, 5 };
    memcpy(indices + 36, collapsed, sizeof collapsed);
    mesh.indices = indices;
    mesh.vertex_count = 9;
    mesh.triangle_count = 14;
    subdivide_surface s = make(&mesh);
    CHECK_EQUAL(s.dropped_triangles, 2);
    CHECK_EQUAL(s.cage_quads, 6);
    check_closed(&s);
    subdivide_surface_destroy(&s);
    mesh.indices = indices + 36;
    mesh.triangle_count = 2;
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_DATA);
}

/* Two octahedra tip to tip: no edge has more than two faces, but the tip belongs to two sheets and is a sharp point of
 * each. Around a sharp point Loop's surface is a cusp: its ring shrinks by 5/8 towards the axis and by 3/8 across it,
 * so the normals of the four pairs of faces that mirror each other are all across the axis, and are shared. */
static void a_point_where_the_cage_touches_itself_stays(void) {
    float positions[36];
    uint32_t indices[48];
    for (int i = 0; i < 36; i++) positions[i] = octahedron_positions[i % 18] + (i % 3 == 0 && i >= 18 ? 2.0f : 0.0f);
    for (uint32_t i = 0; i < 48; i++) indices[i] = octahedron_indices[i % 24] + (i >= 24 ? 6 : 0);
    hemi_mesh_desc mesh = describe(positions, 12, indices, 16, HEMI_SUBDIVISION_LOOP, 3);
    subdivide_surface s = make(&mesh);
    size_t at_tip = 0;
    for (size_t i = 0; i < s.vertex_count; i++) {
        const float *n = s.normals + 3 * i, *p = s.positions + 3 * i;
        at_tip += p[0] == 1.0f && p[1] == 0.0f && p[2] == 0.0f;
        CHECK_NEAR(sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]), 1.0, 1e-6);
    }
    CHECK_EQUAL(at_tip, 4);
    subdivide_surface_destroy(&s);
}

static void more_edges_at_a_vertex_than_opensubdiv_holds_are_refused(void) {
    enum { SPOKES = 65536 };
    char message[SUBDIVIDE_MESSAGE_SIZE];
    float *positions = calloc(3 * (SPOKES + 1), sizeof *positions);
    uint32_t *indices = malloc(3 * SPOKES * sizeof *indices);
    for (uint32_t i = 0; i < SPOKES; i++) {
        positions[3 * i] = cosf((float)i * 9.58738e-5f) + (float)i; /* any places do, if no two are alike */
        positions[3 * i + 1] = sinf((float)i * 9.58738e-5f);
        indices[3 * i] = SPOKES;
        indices[3 * i + 1] = i;
        indices[3 * i + 2] = (i + 1) % SPOKES;
    }
    positions[3 * SPOKES + 2] = 1.0f;
    hemi_mesh_desc mesh = describe(positions, SPOKES + 1, indices, SPOKES, HEMI_SUBDIVISION_LOOP, 1);
    CHECK_EQUAL(attempt(&mesh, 0, message), HEMI_ERROR_LIMIT);
    CHECK(strstr(message, "65536"));
    free(positions);
    free(indices);
}

/* Triangles at random over few vertices: touching sheets, needles, everything. An answer, finite numbers, no crash. */
static void random_cages_get_an_answer(void) {
    uint32_t state = 7;
    size_t done = 0;
    for (int round = 0; round < 3000; round++) {
        float positions[3 * 10];
        uint32_t indices[3 * 6], count;
        char message[SUBDIVIDE_MESSAGE_SIZE];
        subdivide_surface s;
        for (int i = 0; i < 30; i++) positions[i] = (float)((state = state * 1664525u + 1013904223u) >> 30);
        for (int i = 0; i < 18; i++) indices[i] = ((state = state * 1664525u + 1013904223u) >> 16) % 10;
        count = 1 + (state >> 8) % 6;
        hemi_mesh_desc mesh =
            describe(positions, 10, indices, count, (hemi_subdivision_scheme)(1 + round % 2), 1 + state % 2);
        hemi_result result = subdivide_mesh(NULL, &mesh, 0, &s, message);
        CHECK(result == HEMI_OK || result == HEMI_ERROR_DATA);
        done += result == HEMI_OK;
        for (size_t i = 0; i < 3 * (size_t)s.vertex_count; i++)
            if (!isfinite(s.positions[i]) || !(fabsf(s.normals[i]) <= 1.0f + 1e-6f)) CHECK(!"finite");
        subdivide_surface_destroy(&s);
    }
    CHECK(done > 300); /* the generator makes enough cages that are manifold */
}

static void the_same_cage_gives_the_same_bits(void) {
    hemi_mesh_desc mesh = octahedron(4);
    subdivide_surface a = make(&mesh), b = make(&mesh);
    CHECK(memcmp(a.positions, b.positions, 3 * a.vertex_count * sizeof *a.positions) == 0);
    CHECK(memcmp(a.normals, b.normals, 3 * a.vertex_count * sizeof *a.normals) == 0);
    CHECK(memcmp(a.indices, b.indices, 3 * a.triangle_count * sizeof *a.indices) == 0);
    subdivide_surface_destroy(&a);
    subdivide_surface_destroy(&b);
}

int main(void) {
    RUN(a_cube_has_its_closed_form_limit);
    RUN(a_cube_of_hard_edges_stays_a_cube);
    RUN(limit_normals_of_a_cube_follow_its_symmetry);
    RUN(split_vertices_are_welded);
    RUN(minus_zero_is_zero);
    RUN(a_triangulated_grid_is_paired_back_into_its_squares);
    RUN(an_open_sheet_keeps_its_plane_outline_and_corners);
    RUN(catmull_clark_takes_triangles_too);
    RUN(quads_that_are_not_convex_are_not_made);
    RUN(the_solids_have_their_closed_form_loop_limits);
    RUN(volumes_converge_with_second_order);
    RUN(bad_levels_and_schemes_are_refused);
    RUN(the_limit_on_triangles_is_exact);
    RUN(the_deepest_level_works);
    RUN(malformed_meshes_are_refused);
    RUN(cages_that_are_no_manifold_are_refused);
    RUN(collapsed_triangles_are_dropped_and_counted);
    RUN(a_point_where_the_cage_touches_itself_stays);
    RUN(more_edges_at_a_vertex_than_opensubdiv_holds_are_refused);
    RUN(random_cages_get_an_answer);
    RUN(the_same_cage_gives_the_same_bits);
    return check_end();
}
