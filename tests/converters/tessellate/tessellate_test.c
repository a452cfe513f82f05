/* SPDX-License-Identifier: MIT
 * Do surfaces, patches and elements cover what the triangles covered, no more, no less, and without a crack?
 */
#include "base/splitmix.h"
#include "check.h"
#include "tessellate.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---- running it ---- */

typedef struct pieces {
    mesh_vertices vertices;
    scene scene;
    mesh mesh;
    tessellate_check check;
} pieces;

static void pieces_free(pieces *t) {
    tessellation_free(&(tessellation){ .vertices = &t->vertices, .scene = &t->scene, .mesh = &t->mesh });
    memset(t, 0, sizeof *t);
}

/* What fails leaves nothing. */
static hemi_result run(const hemi_mesh_desc *meshes, uint32_t count, const bool *double_sided, double element_size,
                       double patch_size, uint32_t max_elements, pieces *out) {
    static const bool single[8] = { false };
    tessellate_desc desc = { .meshes = meshes,
                             .double_sided = double_sided ? double_sided : single,
                             .mesh_count = count,
                             .element_size = element_size,
                             .patch_size = patch_size,
                             .max_elements = max_elements };
    memset(out, 0, sizeof *out);
    tessellation made = { .vertices = &out->vertices, .scene = &out->scene, .mesh = &out->mesh };
    hemi_result result = tessellate(&desc, &made);
    out->check = made.check;
    if (result != HEMI_OK) pieces_free(out);
    return result;
}

static bool cut(const hemi_mesh_desc *m, double element_size, double patch_size, pieces *out) {
    hemi_result result = run(m, 1, NULL, element_size, patch_size, 1000000, out);
    CHECK_EQUAL(result, HEMI_OK);
    return result == HEMI_OK;
}

static int corner_count(const uint32_t corner[4]) {
    return corner[3] == NO_INDEX ? 3 : 4;
}

static void sub(double out[3], const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static double length(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Half the sum of cross products. */
static void vector_area(const pieces *t, const uint32_t corner[4], double out[3]) {
    const double *a = t->vertices.positions + 3 * (size_t)corner[0];
    out[0] = out[1] = out[2] = 0.0;
    for (int i = 1; i + 1 < corner_count(corner); i++) {
        double u[3], v[3];
        sub(u, t->vertices.positions + 3 * (size_t)corner[i], a);
        sub(v, t->vertices.positions + 3 * (size_t)corner[i + 1], a);
        out[0] += 0.5 * (u[1] * v[2] - u[2] * v[1]);
        out[1] += 0.5 * (u[2] * v[0] - u[0] * v[2]);
        out[2] += 0.5 * (u[0] * v[1] - u[1] * v[0]);
    }
}

static double area_of(const pieces *t, const uint32_t corner[4]) {
    double v[3];
    vector_area(t, corner, v);
    return length(v);
}

static double mesh_area(const hemi_mesh_desc *m) {
    double sum = 0.0;
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], u[3], v[3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) p[i][k] = m->positions[3 * m->indices[3 * t + (uint32_t)i] + (uint32_t)k];
        sub(u, p[1], p[0]);
        sub(v, p[2], p[0]);
        const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
        sum += 0.5 * length(n);
    }
    return sum;
}

typedef struct areas {
    double surfaces, patches, elements;
} areas;

static areas sum_areas(const pieces *t) {
    areas a = { 0, 0, 0 };
    for (uint32_t i = 0; i < t->scene.surface_count; i++) a.surfaces += area_of(t, t->scene.surfaces[i].corner);
    for (uint32_t i = 0; i < t->mesh.patch_count; i++) a.patches += area_of(t, t->mesh.patches[i].corner);
    for (uint32_t i = 0; i < t->mesh.element_count; i++) a.elements += area_of(t, t->mesh.elements[i].corner);
    return a;
}

static double longest_edge(const pieces *t, const uint32_t corner[4]) {
    double longest = 0.0, edge[3];
    for (int i = 0; i < corner_count(corner); i++) {
        sub(edge, t->vertices.positions + 3 * (size_t)corner[i],
            t->vertices.positions + 3 * (size_t)corner[(i + 1) % corner_count(corner)]);
        longest = fmax(longest, length(edge));
    }
    return longest;
}

/* ---- meshes ---- */

static const float SQUARE[12] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0 };
static const uint32_t SQUARE_INDICES[6] = { 0, 1, 2, 0, 2, 3 };

static hemi_mesh_desc mesh_of(const float *positions, uint32_t vertices, const uint32_t *indices, uint32_t triangles) {
    return (hemi_mesh_desc){ .struct_size = sizeof(hemi_mesh_desc),
                             .positions = positions,
                             .vertex_count = vertices,
                             .indices = indices,
                             .triangle_count = triangles };
}

/* A rectangle of 2 x 1. */
static hemi_mesh_desc rectangle(void) {
    return mesh_of(SQUARE, 4, SQUARE_INDICES, 2);
}

static hemi_mesh_desc box(void) {
    static const float positions[24] = { 0, 0, 0,    3, 0, 0,    3, 2, 0,    0, 2, 0,
                                         0, 0, 1.3f, 3, 0, 1.3f, 3, 2, 1.3f, 0, 2, 1.3f };
    static const uint32_t indices[36] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                          1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7 };
    return mesh_of(positions, 8, indices, 12);
}

/* Thin and thick triangles around a point: no two of them a parallelogram. */
static hemi_mesh_desc fan(void) {
    static const float positions[] = { 0, 0,  0,    3, 0.2f,  0.5f, 2,    1,    0,  0.1f, 2.5f,
                                       0, -1, 0.3f, 0, -1.5f, -1,   0.7f, 0.4f, -2, 0 };
    static const uint32_t indices[] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6, 0, 6, 1 };
    return mesh_of(positions, 7, indices, 6);
}

enum {
    RINGS = 9,
    SEGMENTS = 14,
    SPHERE_VERTICES = 2 + (RINGS - 1) * SEGMENTS,
    SPHERE_TRIANGLES = 2 * SEGMENTS * (RINGS - 1)
};

/* Latitudes and longitudes, closed, smooth normals or none. */
static hemi_mesh_desc sphere(bool smooth) {
    static float positions[3 * SPHERE_VERTICES], normals[3 * SPHERE_VERTICES];
    static uint32_t indices[3 * SPHERE_TRIANGLES];
    uint32_t count = 0;
    for (int i = 1; i < RINGS; i++)
        for (int j = 0; j < SEGMENTS; j++) {
            double theta = PI * i / RINGS, phi = 2 * PI * j / SEGMENTS;
            float *p = positions + 3 * ((i - 1) * SEGMENTS + j);
            p[0] = (float)(sin(theta) * cos(phi)), p[1] = (float)(sin(theta) * sin(phi)), p[2] = (float)cos(theta);
        }
    positions[3 * (SPHERE_VERTICES - 2) + 2] = 1, positions[3 * (SPHERE_VERTICES - 1) + 2] = -1;
    memcpy(normals, positions, sizeof normals);
    for (uint32_t j = 0; j < SEGMENTS; j++) {
        uint32_t next = (j + 1) % SEGMENTS, last = (RINGS - 2) * SEGMENTS;
        const uint32_t caps[6] = { SPHERE_VERTICES - 2, j, next, last + j, SPHERE_VERTICES - 1, last + next };
        memcpy(indices + count, caps, sizeof caps);
        count += 6;
        for (uint32_t i = 0; i + 2 < RINGS; i++) {
            uint32_t a = i * SEGMENTS + j, b = a + SEGMENTS, c = (i + 1) * SEGMENTS + next, d = i * SEGMENTS + next;
            const uint32_t pair[6] = { a, b, c, a, c, d };
            memcpy(indices + count, pair, sizeof pair);
            count += 6;
        }
    }
    hemi_mesh_desc m = mesh_of(positions, SPHERE_VERTICES, indices, SPHERE_TRIANGLES);
    m.normals = smooth ? normals : NULL;
    return m;
}

typedef hemi_mesh_desc (*mesh_fn)(void);

static hemi_mesh_desc flat_sphere(void) {
    return sphere(false);
}

static hemi_mesh_desc smooth_sphere(void) {
    return sphere(true);
}

static const mesh_fn MESHES[] = { rectangle, box, fan, flat_sphere, smooth_sphere };
enum { MESH_COUNT = sizeof MESHES / sizeof *MESHES };
static const double SIZES[][2] = { { 10, 10 }, { 0.4, 0.9 }, { 0.05, 0.31 }, { 0.111, 0.111 } };
enum { SIZE_COUNT = sizeof SIZES / sizeof *SIZES };

/* ---- laws ---- */

static void areas_are_kept(void) {
    for (int i = 0; i < MESH_COUNT; i++)
        for (int k = 0; k < SIZE_COUNT; k++) {
            pieces t;
            hemi_mesh_desc m = MESHES[i]();
            if (!cut(&m, SIZES[k][0], SIZES[k][1], &t)) continue;
            areas a = sum_areas(&t);
            double exact = mesh_area(&m);
            /* A parallelogram's fourth corner may be off by a few float roundings, 2e-6 at most; the areas of its two
             * triangles are those of the quad all the same, since the fan is cut along either diagonal. The rest is
             * sums of a few thousand doubles. */
            CHECK_NEAR(a.surfaces / exact, 1.0, 1e-12);
            CHECK_NEAR(a.patches / exact, 1.0, 1e-12);
            CHECK_NEAR(a.elements / exact, 1.0, 1e-12);
            pieces_free(&t);
        }
}

static void no_edge_is_longer_than_asked_for(void) {
    for (int i = 0; i < MESH_COUNT; i++)
        for (int k = 0; k < SIZE_COUNT; k++) {
            pieces t;
            hemi_mesh_desc m = MESHES[i]();
            if (!cut(&m, SIZES[k][0], SIZES[k][1], &t)) continue;
            double of_elements = 0.0, of_patches = 0.0;
            for (uint32_t e = 0; e < t.mesh.element_count; e++)
                of_elements = fmax(of_elements, longest_edge(&t, t.mesh.elements[e].corner));
            for (uint32_t p = 0; p < t.mesh.patch_count; p++)
                of_patches = fmax(of_patches, longest_edge(&t, t.mesh.patches[p].corner));
            /* sqrt(2) times the size, as tessellate.h promises; sides that are alike to 1e-9 count as one length. */
            CHECK(of_elements <= sqrt(2.0) * SIZES[k][0] * (1 + 2e-9));
            CHECK(of_patches <= sqrt(2.0) * SIZES[k][1] * (1 + 2e-9));
            /* Nothing is cut for no reason: halves of an edge that was too long. */
            if (k == 2) CHECK(of_elements > 0.5 * SIZES[k][0]);
            pieces_free(&t);
        }
}

/* An undirected edge between two places, and how many elements have it. */
typedef struct edge {
    double p[2][3];
    int turns; /* +1 for each element that runs along it, -1 for each against */
} edge;

static int compare_places(const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_edges(const void *a, const void *b) {
    const edge *x = a, *y = b;
    int first = compare_places(x->p[0], y->p[0]);
    return first ? first : compare_places(x->p[1], y->p[1]);
}

typedef struct seam_count {
    int interior, border, broken;
    double border_length;
} seam_count;

/* Counts edges by place, so that creases, where vertices are double, count too. A T-junction shows as edges that one
 * element alone has. */
static seam_count count_seams(const pieces *t) {
    edge *edges = calloc(4 * (size_t)t->mesh.element_count, sizeof *edges);
    size_t count = 0;
    seam_count seams = { 0, 0, 0, 0 };
    for (uint32_t e = 0; edges && e < t->mesh.element_count; e++) {
        const uint32_t *corner = t->mesh.elements[e].corner;
        for (int i = 0; i < corner_count(corner); i++) {
            const double *a = t->vertices.positions + 3 * (size_t)corner[i];
            const double *b = t->vertices.positions + 3 * (size_t)corner[(i + 1) % corner_count(corner)];
            bool swap = compare_places(a, b) > 0;
            memcpy(edges[count].p[0], swap ? b : a, sizeof edges->p[0]);
            memcpy(edges[count].p[1], swap ? a : b, sizeof edges->p[1]);
            edges[count++].turns = swap ? -1 : 1;
        }
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t i = 0, next; i < count; i = next) {
        int turns = 0;
        for (next = i; next < count && compare_edges(&edges[i], &edges[next]) == 0; next++) turns += edges[next].turns;
        if (next - i == 2 && turns == 0) {
            seams.interior++;
        } else if (next - i == 1) {
            double along[3];
            sub(along, edges[i].p[1], edges[i].p[0]);
            seams.border++;
            seams.border_length += length(along);
        } else {
            seams.broken++;
        }
    }
    free(edges);
    return seams;
}

static void neighbours_share_whole_edges(void) {
    /* What each mesh has of border. */
    double fan_border = 0.0;
    hemi_mesh_desc f = fan();
    for (uint32_t i = 0; i < 6; i++) {
        double a[3], b[3];
        for (int k = 0; k < 3; k++)
            a[k] = f.positions[3 * (i + 1) + (uint32_t)k], b[k] = f.positions[3 * ((i + 1) % 6 + 1) + (uint32_t)k];
        sub(a, a, b);
        fan_border += length(a);
    }
    const double border[] = { 6, 0, fan_border, 0, 0 };
    for (int i = 0; i < MESH_COUNT; i++)
        for (int k = 0; k < SIZE_COUNT; k++) {
            pieces t;
            hemi_mesh_desc m = MESHES[i]();
            if (!cut(&m, SIZES[k][0], SIZES[k][1], &t)) continue;
            seam_count seams = count_seams(&t);
            CHECK_EQUAL(seams.broken, 0);
            /* T-junctions would add their edges to the border; sums of a few hundred lengths. */
            CHECK_NEAR(seams.border_length, border[i], 1e-9);
            if (i == 1 || i > 2) CHECK_EQUAL(seams.border, 0);
            CHECK(seams.interior + seams.border > 0);
            pieces_free(&t);
        }
}

/* A wheel of 1000 spokes, each 160 times as long as it is wide, or as 64 elements are. */
static void slivers_take_elements_by_their_length(void) {
    enum { SPOKES = 1000, ROW = 64 };
    static float positions[3 * (SPOKES + 1)];
    static uint32_t indices[3 * SPOKES];
    for (uint32_t i = 0; i < SPOKES; i++) {
        positions[3 * i + 3] = (float)cos(2 * PI * i / SPOKES);
        positions[3 * i + 5] = (float)sin(2 * PI * i / SPOKES);
        indices[3 * i] = 0, indices[3 * i + 1] = 1 + (i + 1) % SPOKES, indices[3 * i + 2] = 1 + i;
    }
    const hemi_mesh_desc m = { .struct_size = sizeof m,
                               .positions = positions,
                               .vertex_count = SPOKES + 1,
                               .indices = indices,
                               .triangle_count = SPOKES };
    for (int patches = 1; patches <= 4; patches *= 4) {
        pieces t;
        if (!cut(&m, 1.01 / ROW / sqrt(2.0), 1.01 / patches / sqrt(2.0), &t)) return;
        seam_count seams = count_seams(&t);
        const double rim = 2 * SPOKES * sin(PI / SPOKES), area = 0.5 * SPOKES * sin(2 * PI / SPOKES);
        CHECK_EQUAL(seams.broken, 0);
        CHECK_NEAR(seams.border_length, rim, 1e-6); /* positions are floats */
        CHECK_NEAR(sum_areas(&t).elements, area, 1e-6);
        CHECK_NEAR(sum_areas(&t).patches, area, 1e-6);
        /* Two a strip, and twice that where patches are halves of strips; one edge at a time takes 729 a spoke. */
        CHECK(t.mesh.element_count <= SPOKES * 6 * ROW);
        pieces_free(&t);
    }
}

static void patches_own_contiguous_elements_of_their_own_area(void) {
    pieces t;
    hemi_mesh_desc m = sphere(true);
    if (!cut(&m, 0.1, 0.3, &t)) return;
    uint32_t next = 0;
    for (uint32_t p = 0; p < t.mesh.patch_count; p++) {
        CHECK_EQUAL(t.mesh.patches[p].first_element, next);
        CHECK(t.mesh.patches[p].element_count > 0);
        CHECK(t.mesh.patches[p].surface < t.scene.surface_count);
        double sum = 0.0;
        for (uint32_t e = 0; e < t.mesh.patches[p].element_count; e++)
            sum += area_of(&t, t.mesh.elements[next + e].corner);
        next += t.mesh.patches[p].element_count;
        /* Parts of a planar piece. */
        CHECK_NEAR(sum / area_of(&t, t.mesh.patches[p].corner), 1.0, 1e-12);
    }
    CHECK_EQUAL(next, t.mesh.element_count);
    pieces_free(&t);
}

/* ---- pairing ---- */

static uint32_t surfaces_of(const hemi_mesh_desc *m) {
    pieces t;
    uint32_t count = 0;
    if (!cut(m, 100, 100, &t)) return 0;
    count = t.scene.surface_count;
    pieces_free(&t);
    return count;
}

static void two_triangles_of_a_rectangle_are_one_quad(void) {
    pieces t;
    hemi_mesh_desc m = rectangle();
    if (!cut(&m, 100, 100, &t)) return;
    CHECK_EQUAL(t.scene.surface_count, 1);
    CHECK_EQUAL(t.mesh.element_count, 1);
    CHECK_EQUAL(t.vertices.count, 4);
    CHECK_EQUAL(corner_count(t.scene.surfaces[0].corner), 4);
    double n[3];
    vector_area(&t, t.scene.surfaces[0].corner, n);
    /* The front stays the front, and 2 x 1 is exact. */
    CHECK_NEAR(n[2], 2.0, 0);
    pieces_free(&t);
}

static void every_way_to_start_the_two_triangles_pairs_them(void) {
    for (uint32_t first = 0; first < 3; first++)
        for (uint32_t second = 0; second < 3; second++) {
            uint32_t indices[6];
            for (uint32_t k = 0; k < 3; k++) {
                indices[k] = SQUARE_INDICES[(k + first) % 3];
                indices[3 + k] = SQUARE_INDICES[3 + (k + second) % 3];
            }
            hemi_mesh_desc m = mesh_of(SQUARE, 4, indices, 2);
            CHECK_EQUAL(surfaces_of(&m), 1);
        }
}

static void only_parallelograms_pair(void) {
    static const float trapezoid[12] = { 0, 0, 0, 2, 0, 0, 1.5f, 1, 0, 0, 1, 0 };
    static const float bent[12] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0.01f };
    static const float sheared[12] = { 0, 0, 0, 2, 0, 0, 2.5f, 1, 0, 0.5f, 1, 0 };
    hemi_mesh_desc m = mesh_of(trapezoid, 4, SQUARE_INDICES, 2);
    CHECK_EQUAL(surfaces_of(&m), 2);
    m = mesh_of(bent, 4, SQUARE_INDICES, 2);
    CHECK_EQUAL(surfaces_of(&m), 2);
    m = mesh_of(sheared, 4, SQUARE_INDICES, 2);
    CHECK_EQUAL(surfaces_of(&m), 1);
    m = box();
    CHECK_EQUAL(surfaces_of(&m), 6);
    m = fan();
    CHECK_EQUAL(surfaces_of(&m), 6);
}

static void triangles_wound_against_each_other_do_not_pair(void) {
    static const uint32_t against[6] = { 0, 1, 2, 0, 3, 2 };
    hemi_mesh_desc m = mesh_of(SQUARE, 4, against, 2);
    CHECK_EQUAL(surfaces_of(&m), 2);
}

static void a_third_triangle_on_the_diagonal_keeps_them_apart(void) {
    static const float positions[15] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 1, 0.5f, 1 };
    static const uint32_t indices[9] = { 0, 2, 4, 0, 1, 2, 0, 2, 3 };
    static const float up[15] = { 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1 };
    hemi_mesh_desc m = mesh_of(positions, 5, indices, 3);
    m.normals = up;
    CHECK_EQUAL(surfaces_of(&m), 3);
    /* Without normals the third is of another plane, has corners of its own, and is in no one's way. */
    m.normals = NULL;
    CHECK_EQUAL(surfaces_of(&m), 2);
}

static void attributes_that_are_not_affine_keep_triangles_apart(void) {
    static const float affine[8] = { 0, 0, 2, 0, 2, 1, 0, 1 }, broken[8] = { 0, 0, 2, 0, 2, 1, 0.3f, 1 };
    hemi_mesh_desc m = rectangle();
    m.attribute_count = 2;
    m.attributes = affine;
    CHECK_EQUAL(surfaces_of(&m), 1);
    m.attributes = broken;
    CHECK_EQUAL(surfaces_of(&m), 2);
}

static void a_break_in_the_texture_coordinates_keeps_triangles_apart(void) {
    /* The same rectangle with the corners of the diagonal double, as exporters write a seam. */
    static const float positions[18] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 1, 0 };
    static const float seam[12] = { 0, 0, 2, 0, 2, 1, 5, 5, 7, 6, 5, 6 };
    static const uint32_t indices[6] = { 0, 1, 2, 3, 4, 5 };
    hemi_mesh_desc m = mesh_of(positions, 6, indices, 2);
    m.attributes = seam;
    m.attribute_count = 2;
    CHECK_EQUAL(surfaces_of(&m), 2);
}

static void creases_keep_triangles_apart_and_meshes_never_mix(void) {
    static const float positions[18] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 1, 0 };
    static const float crease[18] = { 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f };
    static const uint32_t indices[6] = { 0, 1, 2, 3, 4, 5 };
    hemi_mesh_desc m = mesh_of(positions, 6, indices, 2);
    m.normals = crease;
    CHECK_EQUAL(surfaces_of(&m), 2);
    /* One corner whose normal leans: bilinear shading is not what the two triangles have. */
    static const float flat[12] = { 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1 };
    static const float leaning[12] = { 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0.6f, 0.8f };
    m = rectangle();
    m.normals = flat;
    CHECK_EQUAL(surfaces_of(&m), 1);
    m.normals = leaning;
    CHECK_EQUAL(surfaces_of(&m), 2);
    /* Each material is a mesh: the halves of a rectangle in two meshes stay two surfaces with nodes of their own. */
    hemi_mesh_desc halves[2] = { mesh_of(SQUARE, 4, SQUARE_INDICES, 1), mesh_of(SQUARE, 4, SQUARE_INDICES + 3, 1) };
    pieces t;
    CHECK_EQUAL(run(halves, 2, NULL, 100, 100, 100, &t), HEMI_OK);
    CHECK_EQUAL(t.scene.surface_count, 2);
    CHECK_EQUAL(t.vertices.node_count, 6);
    CHECK_EQUAL(t.scene.surfaces[1].mesh, 1);
    CHECK_EQUAL(t.mesh.patches[1].surface, 1);
    CHECK_EQUAL(t.mesh.patches[1].first_element, 1);
    CHECK_EQUAL(t.mesh.elements[1].corner[0], 3);
    pieces_free(&t);
}

/* ---- colour nodes ---- */

static void without_normals_every_plane_has_nodes_of_its_own(void) {
    pieces t;
    hemi_mesh_desc m = box();
    if (!cut(&m, 100, 100, &t)) return;
    /* Six faces of four corners. */
    CHECK_EQUAL(t.vertices.node_count, 24);
    CHECK_EQUAL(t.vertices.count, 24);
    pieces_free(&t);
}

static void smooth_neighbours_share_nodes_even_where_vertices_are_double(void) {
    static const float positions[18] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 1, 0 };
    static const float up[18] = { 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1 };
    static const uint32_t indices[6] = { 0, 1, 2, 3, 4, 5 };
    static const float seam[6] = { 0, 0, 0, 1, 1, 1 };
    hemi_mesh_desc m = mesh_of(positions, 6, indices, 2);
    m.normals = up;
    pieces t;
    /* Those that are double in all that they have are one. */
    if (!cut(&m, 100, 100, &t)) return;
    CHECK_EQUAL(t.vertices.count, 4);
    pieces_free(&t);
    m.attributes = seam, m.attribute_count = 1;
    if (!cut(&m, 100, 100, &t)) return;
    CHECK_EQUAL(t.vertices.count, 6);
    CHECK_EQUAL(t.vertices.node_count, 4);
    pieces_free(&t);
    /* And so do the midpoints of the edge that they share. */
    if (!cut(&m, 0.2, 0.2, &t)) return;
    CHECK(t.vertices.node_count < t.vertices.count);
    for (uint32_t v = 0; v < t.vertices.count; v++)
        for (uint32_t w = 0; w < v; w++) {
            bool same_place =
                compare_places(t.vertices.positions + 3 * (size_t)v, t.vertices.positions + 3 * (size_t)w) == 0;
            CHECK_EQUAL(t.vertices.nodes[v] == t.vertices.nodes[w], same_place);
        }
    pieces_free(&t);
    m = sphere(true);
    if (!cut(&m, 100, 100, &t)) return;
    CHECK_EQUAL(t.vertices.node_count, SPHERE_VERTICES);
    pieces_free(&t);
}

/* ---- sides ---- */

static void a_double_sided_mesh_has_a_twin_for_everything(void) {
    static const bool both[1] = { true };
    pieces t;
    hemi_mesh_desc m = fan();
    CHECK_EQUAL(run(&m, 1, both, 0.3, 0.8, 1000000, &t), HEMI_OK);
    CHECK_EQUAL(t.scene.surface_count, 12);
    CHECK_EQUAL(t.mesh.element_count % 2, 0);
    CHECK_EQUAL(t.mesh.patch_count % 2, 0);
    /* A side has as much area as the other: sums of a few hundred. */
    CHECK_NEAR(sum_areas(&t).elements / mesh_area(&m), 2.0, 1e-12);
    for (uint32_t i = 0; i < t.scene.surface_count; i++) {
        uint32_t twin = t.scene.surfaces[i].twin;
        CHECK(twin < t.scene.surface_count && t.scene.surfaces[twin].twin == i);
        double front[3], back[3];
        vector_area(&t, t.scene.surfaces[i].corner, front);
        vector_area(&t, t.scene.surfaces[twin].corner, back);
        /* The same corners the other way round: a rounding. */
        for (int k = 0; k < 3; k++) CHECK_NEAR(front[k], -back[k], 1e-14);
    }
    uint32_t half = t.mesh.patch_count / 2;
    for (uint32_t p = 0; p < half; p++) {
        CHECK_EQUAL(t.scene.surfaces[t.mesh.patches[p].surface].twin, t.mesh.patches[p + half].surface);
        CHECK_EQUAL(t.mesh.patches[p].element_count, t.mesh.patches[p + half].element_count);
        CHECK_EQUAL(t.mesh.patches[p + half].first_element, t.mesh.patches[p].first_element + t.mesh.element_count / 2);
    }
    /* Backs share neither vertices nor colours with fronts. */
    for (uint32_t e = 0; e < t.mesh.element_count; e++)
        for (int i = 0; i < corner_count(t.mesh.elements[e].corner); i++) {
            uint32_t v = t.mesh.elements[e].corner[i];
            CHECK_EQUAL(v >= t.vertices.count / 2, e >= t.mesh.element_count / 2);
            CHECK_EQUAL(t.vertices.nodes[v] >= t.vertices.node_count / 2, e >= t.mesh.element_count / 2);
        }
    pieces_free(&t);
}

static void a_single_sided_mesh_has_no_twins(void) {
    pieces t;
    hemi_mesh_desc m = box();
    if (!cut(&m, 1, 1, &t)) return;
    for (uint32_t i = 0; i < t.scene.surface_count; i++) CHECK_EQUAL(t.scene.surfaces[i].twin, NO_INDEX);
    pieces_free(&t);
}

static void a_transform_moves_everything(void) {
    pieces t;
    hemi_mesh_desc m = rectangle();
    /* Columns: x -> 3 z, y -> x, z -> y; then a shift. */
    const double transform[16] = { 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0, 0, 10, 20, 30, 1 };
    memcpy(m.transform, transform, sizeof transform);
    if (!cut(&m, 100, 100, &t)) return;
    double n[3];
    vector_area(&t, t.scene.surfaces[0].corner, n);
    /* 2 x 1 becomes 6 x 1, and z x x = y; all exact. */
    CHECK_NEAR(n[1], 6.0, 0);
    int found = 0;
    for (uint32_t v = 0; v < t.vertices.count; v++) {
        const double *p = t.vertices.positions + 3 * (size_t)v;
        found += p[0] == 11 && p[1] == 20 && p[2] == 36;
    }
    CHECK_EQUAL(found, 1);
    pieces_free(&t);
}

static void a_mirror_keeps_fronts_in_front(void) {
    static const bool sides[2] = { false, true };
    for (int i = 0; i < 2; i++) {
        pieces plain, mirrored;
        hemi_mesh_desc m = box();
        CHECK_EQUAL(run(&m, 1, &sides[i], 0.4, 0.9, 100000, &plain), HEMI_OK);
        const double mirror[16] = { -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
        memcpy(m.transform, mirror, sizeof mirror);
        CHECK_EQUAL(run(&m, 1, &sides[i], 0.4, 0.9, 100000, &mirrored), HEMI_OK);
        CHECK_EQUAL(mirrored.mesh.element_count, plain.mesh.element_count);
        for (uint32_t e = 0; e < plain.mesh.element_count; e++) {
            double a[3], b[3];
            vector_area(&plain, plain.mesh.elements[e].corner, a);
            vector_area(&mirrored, mirrored.mesh.elements[e].corner, b);
            /* Mirrored normals, of quads from another corner: roundings of 0.1. */
            CHECK_NEAR(b[0], -a[0], 1e-16);
            CHECK_NEAR(b[1], a[1], 1e-16);
            CHECK_NEAR(b[2], a[2], 1e-16);
        }
        pieces_free(&plain);
        pieces_free(&mirrored);
    }
}

/* ---- limits ---- */

static void triangles_without_area_are_counted_and_dropped(void) {
    static const float positions[21] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 1, 0, 0, 1e6f, 0, 0, 5e5f, 1e-9f, 0 };
    /* A repeated corner, three corners on a line, a needle whose height is lost in rounding, and two good ones. */
    static const uint32_t indices[15] = { 0, 0, 1, 0, 4, 1, 0, 5, 6, 0, 1, 2, 0, 2, 3 };
    pieces t;
    hemi_mesh_desc m = mesh_of(positions, 7, indices, 5);
    if (!cut(&m, 100, 100, &t)) return;
    CHECK_EQUAL(t.check.degenerate_count, 3);
    CHECK_EQUAL(t.scene.surface_count, 1);
    CHECK_NEAR(sum_areas(&t).surfaces, 2.0, 0);
    pieces_free(&t);
    /* Nothing at all is no error here. */
    m = mesh_of(positions, 7, indices, 0);
    CHECK_EQUAL(run(&m, 1, NULL, 1, 1, 10, &t), HEMI_OK);
    CHECK_EQUAL(t.mesh.element_count, 0);
    pieces_free(&t);
}

static void duplicates_are_counted_and_dropped(void) {
    /* A square, one half again from another corner and by other vertices, the other half turned over, and a fin. */
    static const float positions[24] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 2, 1, 0, 0, 0, -0.0f, 2, 0, 0, 1, 1, 1 };
    static const uint32_t indices[15] = { 0, 1, 2, 0, 2, 3, 4, 5, 6, 3, 2, 0, 0, 2, 7 };
    for (int both = 0; both < 2; both++) {
        bool sides = both;
        pieces t;
        hemi_mesh_desc m = mesh_of(positions, 8, indices, 5);
        CHECK_EQUAL(run(&m, 1, &sides, 100, 100, 1000, &t), HEMI_OK);
        CHECK_EQUAL(t.check.duplicate_count, both ? 2 : 1);
        CHECK_EQUAL(t.check.degenerate_count, 0);
        /* The diagonal has the square's halves, the fin, and the half that was turned over where it stays. */
        CHECK_EQUAL(t.check.nonmanifold_count, 1);
        /* Square 2, fin sqrt(5) * height / 2 = sqrt(6) / 2, half of the square turned over 1; twice with backs. */
        double fin = 0.5 * sqrt(6.0);
        CHECK_NEAR(sum_areas(&t).surfaces, both ? 2 * (2 + fin) : 3 + fin, 1e-6);
        pieces_free(&t);
    }
}

/* How many elements there are by their area, of a mesh at a size, against how many there are. */
static double crowding_of_pieces(const hemi_mesh_desc *m, double element_size) {
    pieces t;
    if (!cut(m, element_size, 10.0 * element_size, &t)) return 0.0;
    double count = (double)t.mesh.element_count;
    pieces_free(&t);
    return count / (mesh_area(m) / (element_size * element_size));
}

/* A sphere whose triangles are much larger than elements, and much smaller: from the halving of a triangle until its
 * longest edge is at most 1.41 elements follow 2 to 4 elements to a square of their size, and from triangles smaller
 * than elements one of each. */
static void crowding_is_that_of_the_pieces(void) {
    const hemi_mesh_desc m = sphere(true);
    double diameter = sqrt(mesh_area(&m) / PI);
    for (double size = 0.01; size < 3.0; size *= 3.0) {
        double guess = tessellate_crowding(NULL, &m, 1, size * diameter),
               truth = crowding_of_pieces(&m, size * diameter);
        CHECK(guess > 0.5 * truth && guess < 2.0 * truth);
    }
    CHECK(tessellate_crowding(NULL, &m, 1, 10.0 * diameter) > 100.0);
}

/* A sphere of small triangles beside a square: of a quarter of all area are those no larger than its largest, unless
 * the square has more than three times as much. */
static void what_a_quarter_of_the_area_is_of_is_found(void) {
    const hemi_mesh_desc ball = sphere(true);
    const uint32_t corners[] = { 0, 1, 2, 0, 2, 3 };
    const double quads = sqrt(2.0 * mesh_area(&ball) / ball.triangle_count);
    for (double times = 1.0; times < 5.0; times += 3.0) {
        const float side = (float)sqrt(times * mesh_area(&ball));
        const float p[] = { 0, 0, 0, 0, 0, side, side, 0, side, side, 0, 0 };
        const hemi_mesh_desc both[] = { { .positions = p,
                                          .indices = corners,
                                          .vertex_count = 4,
                                          .triangle_count = 2,
                                          .transform = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } },
                                        ball };
        double found = tessellate_common_size(NULL, both, 2);
        if (times < 3.0)
            CHECK(found > 0.7 * quads && found < 1.4 * quads);
        else
            CHECK(found >= 0.99 * (double)side && found < 1.15 * (double)side);
    }
    CHECK(isinf(tessellate_common_size(NULL, &ball, 0)));
}

/* Of a sphere those that are smaller than a patch go together, some dozens of them, with normals or without; what is
 * larger does not. */
static void small_triangles_shoot_together(void) {
    hemi_mesh_desc m = sphere(true);
    double diameter = sqrt(mesh_area(&m) / PI);
    size_t small = tessellate_shooters(NULL, &m, 0.5 * diameter),
           large = tessellate_shooters(NULL, &m, 1e-3 * diameter);
    printf("%u triangles: %zu shooters\n", m.triangle_count, small);
    CHECK(small >= 6 && small < m.triangle_count / 2);
    CHECK_EQUAL(large, m.triangle_count);
    m.normals = NULL;
    CHECK_EQUAL(tessellate_shooters(NULL, &m, 0.5 * diameter), small);
}

static void the_limit_of_elements_is_kept(void) {
    static const bool both[1] = { true };
    pieces t;
    hemi_mesh_desc m = rectangle();
    CHECK_EQUAL(run(&m, 1, NULL, 0.25, 0.25, 1000000, &t), HEMI_OK);
    uint32_t needed = t.mesh.element_count;
    pieces_free(&t);
    CHECK(needed >= 16);
    CHECK_EQUAL(run(&m, 1, NULL, 0.25, 0.25, needed, &t), HEMI_OK);
    pieces_free(&t);
    CHECK_EQUAL(run(&m, 1, NULL, 0.25, 0.25, needed - 1, &t), HEMI_ERROR_LIMIT);
    CHECK(t.vertices.positions == NULL && t.mesh.elements == NULL && t.mesh.element_count == 0);
    CHECK_EQUAL(run(&m, 1, both, 0.25, 0.25, 2 * needed - 1, &t), HEMI_ERROR_LIMIT);
    CHECK_EQUAL(run(&m, 1, both, 0.25, 0.25, 2 * needed, &t), HEMI_OK);
    pieces_free(&t);
    /* A size that would need millions of times the limit is refused soon. */
    CHECK_EQUAL(run(&m, 1, NULL, 1e-7, 1e-7, 1000, &t), HEMI_ERROR_LIMIT);
    pieces_free(&t);
}

/* ---- sources ---- */

static void source_weights_reproduce_positions(void) {
    static const bool both[1] = { true };
    for (int i = 0; i < MESH_COUNT; i++) {
        pieces t;
        hemi_mesh_desc m = MESHES[i]();
        CHECK_EQUAL(run(&m, 1, both, 0.07, 0.3, 1000000, &t), HEMI_OK);
        double worst = 0.0, sum_off = 0.0, least = 0.0;
        for (uint32_t v = 0; v < t.vertices.count; v++) {
            const float *w = t.vertices.source_weights + 3 * (size_t)v;
            double off[3];
            CHECK(t.vertices.source_triangles[v] < m.triangle_count);
            for (int k = 0; k < 3; k++) {
                off[k] = -t.vertices.positions[3 * (size_t)v + (size_t)k];
                for (uint32_t c = 0; c < 3; c++)
                    off[k] +=
                        w[c] * (double)m.positions[3 * m.indices[3 * t.vertices.source_triangles[v] + c] + (uint32_t)k];
                least = fmin(least, w[k]);
            }
            worst = fmax(worst, length(off));
            sum_off = fmax(sum_off, fabs((double)w[0] + w[1] + w[2] - 1));
        }
        /* Weights are floats, half a rounding of 1.2e-7 each, on positions of up to 3. */
        CHECK_NEAR(worst, 0.0, 1e-6);
        CHECK_NEAR(sum_off, 0.0, 2e-7);
        /* Inside their triangle. */
        CHECK_NEAR(least, 0.0, 1e-7);
        pieces_free(&t);
    }
}

/* ---- vertices in the middle of edges ---- */

enum { APART = 120, LATTICE = 6 };

static bool is_between(const float *a, const float *b, const float *p) {
    double t = 0.0, square = 0.0, off = 0.0;
    for (int k = 0; k < 3; k++) t += (double)(p[k] - a[k]) * (b[k] - a[k]), square += pow(b[k] - a[k], 2.0);
    for (int k = 0; k < 3; k++) off += pow(a[k] + t / square * (b[k] - a[k]) - p[k], 2.0);
    return t > 0.0 && t < square && off < 1e-12;
}

/* Of edge i from corner i to the next of its triangle. */
static size_t edge_end(size_t i) {
    return i % 3 == 2 ? i - 2 : i + 1;
}

static bool is_same_edge(const float *p, size_t i, size_t k) {
    const size_t size = 3 * sizeof *p;
    const float *a = p + 3 * i, *b = p + 3 * edge_end(i), *c = p + 3 * k, *d = p + 3 * edge_end(k);
    return (memcmp(a, c, size) == 0 && memcmp(b, d, size) == 0) || (memcmp(a, d, size) == 0 && memcmp(b, c, size) == 0);
}

/* By looking at every vertex from every edge that one triangle has. */
static uint32_t count_junctions(const float *p) {
    uint32_t count = 0;
    for (size_t i = 0; i < 3 * APART; i++) {
        bool is_open = true, any = false;
        for (size_t k = 0; k < 3 * APART; k++) is_open = is_open && (k == i || !is_same_edge(p, i, k));
        for (size_t k = 0; k < 3 * APART; k++) any = any || is_between(p + 3 * i, p + 3 * edge_end(i), p + 3 * k);
        count += is_open && any;
    }
    return count;
}

static double doubled_area(const float *p) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = p[3 + k] - p[k], v[k] = p[6 + k] - p[k];
    const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
    return length(n);
}

/* Triangles between the points of a small lattice meet in corners, along edges, and in the middle of them. */
static void vertices_in_the_middle_of_edges_are_counted(void) {
    float p[9 * APART];
    uint32_t indices[3 * APART], drawn = 0;
    for (size_t t = 0; t < APART; t++) do
            for (size_t k = 0; k < 9; k++) p[9 * t + k] = (float)(splitmix(drawn++) % LATTICE);
        while (!(doubled_area(p + 9 * t) > 0.0));
    for (uint32_t i = 0; i < 3 * APART; i++) indices[i] = i;
    const hemi_mesh_desc m = { .positions = p, .indices = indices, .vertex_count = 3 * APART, .triangle_count = APART };
    uint32_t expected = count_junctions(p);
    pieces t;
    if (!cut(&m, 10.0, 20.0, &t)) return;
    printf("%u of %d edges have a vertex in the middle\n", expected, 3 * APART);
    CHECK(expected > APART / 4 && expected < 3 * APART);
    CHECK_EQUAL(t.check.duplicate_count, 0);
    CHECK_EQUAL(t.check.junction_count, expected);
    pieces_free(&t);
}

int main(void) {
    RUN(areas_are_kept);
    RUN(no_edge_is_longer_than_asked_for);
    RUN(neighbours_share_whole_edges);
    RUN(slivers_take_elements_by_their_length);
    RUN(patches_own_contiguous_elements_of_their_own_area);
    RUN(two_triangles_of_a_rectangle_are_one_quad);
    RUN(every_way_to_start_the_two_triangles_pairs_them);
    RUN(only_parallelograms_pair);
    RUN(triangles_wound_against_each_other_do_not_pair);
    RUN(a_third_triangle_on_the_diagonal_keeps_them_apart);
    RUN(attributes_that_are_not_affine_keep_triangles_apart);
    RUN(a_break_in_the_texture_coordinates_keeps_triangles_apart);
    RUN(creases_keep_triangles_apart_and_meshes_never_mix);
    RUN(without_normals_every_plane_has_nodes_of_its_own);
    RUN(smooth_neighbours_share_nodes_even_where_vertices_are_double);
    RUN(a_double_sided_mesh_has_a_twin_for_everything);
    RUN(a_single_sided_mesh_has_no_twins);
    RUN(a_transform_moves_everything);
    RUN(a_mirror_keeps_fronts_in_front);
    RUN(triangles_without_area_are_counted_and_dropped);
    RUN(duplicates_are_counted_and_dropped);
    RUN(vertices_in_the_middle_of_edges_are_counted);
    RUN(crowding_is_that_of_the_pieces);
    RUN(what_a_quarter_of_the_area_is_of_is_found);
    RUN(small_triangles_shoot_together);
    RUN(the_limit_of_elements_is_kept);
    RUN(source_weights_reproduce_positions);
    return check_end();
}
