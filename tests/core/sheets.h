/* SPDX-License-Identifier: MIT
 * Grids of triangles with colours, as decimation gets them, and what must be true of what it leaves.
 */
#ifndef HEMIBAKE_TESTS_SHEETS_H
#define HEMIBAKE_TESTS_SHEETS_H

#include "check.h"
#include "geometry/vec3.h"
#include "reconstruct/decimate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FACES_MAX = 8 };

static const double TOLERANCE = 0.01;

/* Grids of n x m cells, each a face; vertices and nodes of their own, which places join. */
typedef struct sheets {
    double *positions, *values, *tolerance;
    uint32_t *nodes;
    uint32_t vertex_count, first_vertex[FACES_MAX], n[FACES_MAX], m[FACES_MAX], face_count;
    decimate_triangles triangles;
    uint32_t before;
} sheets;

typedef double (*field)(int band, const double x[3]);

static inline void add_sheet(sheets *s, uint32_t n, uint32_t m, const double origin[3], const double u[3],
                             const double v[3]) {
    uint32_t first = s->vertex_count, face = s->face_count++;
    s->first_vertex[face] = first, s->n[face] = n, s->m[face] = m;
    s->vertex_count += (n + 1) * (m + 1);
    s->positions = realloc(s->positions, 3 * s->vertex_count * sizeof *s->positions);
    s->triangles.corners = realloc(s->triangles.corners, (3 * s->triangles.count + 6 * n * m) * sizeof(uint32_t));
    s->triangles.faces = realloc(s->triangles.faces, (s->triangles.count + 2 * n * m) * sizeof(uint32_t));
    for (uint32_t j = 0; j <= m; j++)
        for (uint32_t i = 0; i <= n; i++)
            for (size_t k = 0; k < 3; k++)
                s->positions[3 * (first + j * (n + 1) + i) + k] = origin[k] + i * u[k] / n + j * v[k] / m;
    for (uint32_t j = 0; j < m; j++)
        for (uint32_t i = 0; i < n; i++) {
            uint32_t a = first + j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1, turn = (i + j) % 2;
            uint32_t six[] = { a, b, turn ? d : c, turn ? b : a, c, d };
            memcpy(s->triangles.corners + 3 * s->triangles.count, six, sizeof six);
            s->triangles.faces[s->triangles.count++] = face;
            s->triangles.faces[s->triangles.count++] = face;
        }
    s->before = s->triangles.count;
}

static inline void fill(sheets *s, field f) {
    s->values = malloc(3 * s->vertex_count * sizeof *s->values);
    s->tolerance = malloc(s->vertex_count * sizeof *s->tolerance);
    s->nodes = malloc(s->vertex_count * sizeof *s->nodes);
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        s->nodes[v] = v;
        s->tolerance[v] = TOLERANCE;
        for (int c = 0; c < 3; c++) s->values[3 * v + (uint32_t)c] = f(c, s->positions + 3 * v);
    }
}

static inline decimate_result merge_by(sheets *s, unsigned threads, const bool *kept, decimate_record *record) {
    jobs *workers = jobs_create(threads);
    const decimate_input in = { .jobs = workers,
                                .positions = s->positions,
                                .nodes = s->nodes,
                                .vertex_count = s->vertex_count,
                                .kept = kept,
                                .fields = { { s->values, s->tolerance } },
                                .field_count = 1,
                                .record = record };
    decimate_result out;
    CHECK(decimate(&in, &s->triangles, &out));
    jobs_destroy(workers);
    return out;
}

static inline void free_sheets(sheets *s) {
    free(s->positions), free(s->values), free(s->tolerance), free(s->nodes);
    free(s->triangles.corners), free(s->triangles.faces);
    memset(s, 0, sizeof *s);
}

/* ---- fields ---- */

static inline double even(int band, const double x[3]) {
    (void)x;
    return 1.0 + band;
}

/* The shadow of a disc with a soft edge, and light that falls off. */
static inline double penumbra(int band, const double x[3]) {
    double r = hypot(x[0] - 0.4, x[1] - 0.55), t = fmin(fmax((r - 0.2) / 0.15, 0.0), 1.0);
    return (0.2 + (band ? 0.8 : 0.5) * t * t * (3 - 2 * t)) / (1.0 + x[0] * x[0] + x[1] * x[1]);
}

/* ---- what is looked at ---- */

static inline const double *corner(const sheets *s, uint32_t t, uint32_t k) {
    return s->positions + 3 * (size_t)s->triangles.corners[3 * t + k % 3];
}

/* Twice its area, along the normal. */
static inline void area_of(const sheets *s, uint32_t t, double out[3]) {
    double u[3], v[3];
    vec3_sub(u, corner(s, t, 1), corner(s, t, 0));
    vec3_sub(v, corner(s, t, 2), corner(s, t, 0));
    vec3_cross(out, u, v);
}

/* Every triangle turns as its face does and is no needle; all have the area there was. */
static inline void check_shapes(const sheets *s, double shape, double area) {
    double sum = 0.0, worst = INFINITY;
    for (uint32_t t = 0; t < s->triangles.count; t++) {
        double a[3], first[3], longest = 0.0;
        area_of(s, t, a);
        for (uint32_t k = 0; k < 3; k++) longest = fmax(longest, vec3_distance(corner(s, t, k), corner(s, t, k + 1)));
        uint32_t f = s->triangles.faces[t], at = s->first_vertex[f];
        double u[3], v[3];
        vec3_sub(u, s->positions + 3 * (at + 1), s->positions + 3 * at);
        vec3_sub(v, s->positions + 3 * (at + s->n[f] + 1), s->positions + 3 * at);
        vec3_cross(first, u, v);
        CHECK(vec3_dot(a, first) > 0.0);
        worst = fmin(worst, vec3_length(a) / (longest * longest));
        sum += vec3_length(a) / 2;
    }
    /* Off by the roundings of coordinates in the plane. */
    if (!(worst >= shape * (1 - 1e-12))) printf("%.17g\n", worst);
    CHECK(worst >= shape * (1 - 1e-12));
    /* Sums of some thousand numbers of that size. */
    CHECK_NEAR(sum, area, 1e-12 * area);
}

static inline bool same_place(const double *a, const double *b) {
    return memcmp(a, b, 3 * sizeof *a) == 0;
}

/* Of edges on the line x = 1, z = 0, y in [0,1]: how many have no other with the same ends. */
static inline int lone_edges(const sheets *s, int *all) {
    int lone = 0;
    *all = 0;
    for (uint32_t i = 0; i < 3 * s->triangles.count; i++) {
        const double *a = corner(s, i / 3, i), *b = corner(s, i / 3, i % 3 + 1);
        bool paired = false;
        if (a[0] != 1.0 || b[0] != 1.0 || a[2] != 0.0 || b[2] != 0.0) continue;
        ++*all;
        for (uint32_t j = 0; j < 3 * s->triangles.count && !paired; j++) {
            const double *c = corner(s, j / 3, j), *d = corner(s, j / 3, j % 3 + 1);
            paired = s->triangles.faces[i / 3] != s->triangles.faces[j / 3] &&
                     ((same_place(a, c) && same_place(b, d)) || (same_place(a, d) && same_place(b, c)));
        }
        lone += !paired;
    }
    return lone;
}

static const double O[3] = { 0, 0, 0 }, X[3] = { 1, 0, 0 }, Y[3] = { 0, 1, 0 }, Z[3] = { 0, 0, 1 };

#endif
