/* SPDX-License-Identifier: MIT
 * Which faces and shared vertices does the control cage have? Sorting finds vertices with the same position, then the
 * edges that two triangles share; every order is one of indices, so the same mesh always gives the same cage. */
#include "cage.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct corner_point {
    float x[3];
    uint32_t vertex;
} corner_point;

typedef struct edge {
    uint32_t low, high; /* vertices */
    uint32_t triangle;
    uint8_t first;  /* the corner of the triangle that the edge leaves */
    uint8_t upward; /* it runs from low to high there */
} edge;

/* Two triangles that may be the halves of a quad: edges `first` and `first + 1` of the sorted list. */
typedef struct quad_candidate {
    double cost;
    size_t first;
} quad_candidate;

typedef struct builder {
    const hemi_mesh_desc *mesh;
    uint32_t *welded;    /* welded[v]: cage vertex of mesh vertex v */
    uint32_t *triangles; /* triangles[3*t+k]: cage vertices */
    uint32_t triangle_count;
    edge *edges;      /* sorted; three a triangle */
    size_t *partners; /* of triangle t: the first of the two edges it is paired at, or SIZE_MAX */
    cage *out;
    char *message;
} builder;

static hemi_result fail(hemi_result result, char *message, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, SUBDIVIDE_MESSAGE_SIZE, format, arguments);
    va_end(arguments);
    return result;
}

static hemi_result out_of_memory(const builder *b) {
    return fail(HEMI_ERROR_MEMORY, b->message, "out of memory for a control cage of %lu triangles",
                (unsigned long)b->mesh->triangle_count);
}

/* ---- checks ---------------------------------------------------------------------------------------------------- */

static hemi_result check_mesh(const builder *b) {
    const hemi_mesh_desc *mesh = b->mesh;
    if (mesh->triangle_count == 0) return fail(HEMI_ERROR_DATA, b->message, "a control cage without triangles");
    if (!mesh->positions || !mesh->indices)
        return fail(HEMI_ERROR_ARGUMENT, b->message, "a control cage without positions or indices");
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        uint32_t v = mesh->indices[i];
        if (v >= mesh->vertex_count)
            return fail(HEMI_ERROR_DATA, b->message, "index %lu of triangle %zu is out of range", (unsigned long)v,
                        i / 3);
        for (size_t k = 0; k < 3; k++)
            if (!isfinite(mesh->positions[3 * (size_t)v + k]))
                return fail(HEMI_ERROR_DATA, b->message, "vertex %lu is not finite", (unsigned long)v);
    }
    return HEMI_OK;
}

/* ---- welding --------------------------------------------------------------------------------------------------- */

static int compare_points(const void *left, const void *right) {
    const corner_point *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->x[k] != b->x[k]) return a->x[k] < b->x[k] ? -1 : 1;
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

static bool same_place(const corner_point *a, const corner_point *b) {
    return a->x[0] == b->x[0] && a->x[1] == b->x[1] && a->x[2] == b->x[2];
}

/* Points at all vertices that a triangle uses, one each. */
static uint32_t collect_points(const builder *b, corner_point *points) {
    uint32_t count = 0;
    for (uint32_t v = 0; v < b->mesh->vertex_count; v++) b->welded[v] = 0;
    for (size_t i = 0; i < 3 * (size_t)b->mesh->triangle_count; i++) b->welded[b->mesh->indices[i]] = 1;
    for (uint32_t v = 0; v < b->mesh->vertex_count; v++) {
        if (!b->welded[v]) continue;
        memcpy(points[count].x, b->mesh->positions + 3 * (size_t)v, sizeof points[count].x);
        points[count++].vertex = v;
    }
    return count;
}

/* welded[v] becomes the lowest mesh vertex at the place of v. */
static void find_lowest(const builder *b, corner_point *points, uint32_t count) {
    qsort(points, count, sizeof *points, compare_points);
    uint32_t lowest = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (i == 0 || !same_place(&points[i], &points[i - 1])) lowest = points[i].vertex;
        b->welded[points[i].vertex] = lowest;
    }
}

/* Cage vertices are numbered in the order in which the mesh vertices come. */
static void number_vertices(const builder *b, const corner_point *points, uint32_t count, uint32_t *used) {
    cage *out = b->out;
    for (uint32_t i = 0; i < count; i++) used[points[i].vertex] = 1;
    for (uint32_t v = 0; v < b->mesh->vertex_count; v++) {
        if (!used[v]) continue;
        if (b->welded[v] != v) {
            b->welded[v] = b->welded[b->welded[v]]; /* the lowest has its number already */
            continue;
        }
        for (size_t k = 0; k < 3; k++)
            out->positions[3 * (size_t)out->vertex_count + k] = b->mesh->positions[3 * (size_t)v + k];
        b->welded[v] = out->vertex_count++;
    }
}

static hemi_result weld(builder *b) {
    size_t vertices = b->mesh->vertex_count;
    corner_point *points = malloc(vertices * sizeof *points);
    uint32_t *used = calloc(vertices, sizeof *used);
    b->welded = malloc(vertices * sizeof *b->welded);
    b->out->positions = malloc(3 * vertices * sizeof *b->out->positions);
    hemi_result result = HEMI_OK;
    if (points && used && b->welded && b->out->positions) {
        uint32_t count = collect_points(b, points);
        find_lowest(b, points, count);
        number_vertices(b, points, count, used);
    } else {
        result = out_of_memory(b);
    }
    free(points);
    free(used);
    return result;
}

static hemi_result weld_triangles(builder *b) {
    b->triangles = malloc(3 * (size_t)b->mesh->triangle_count * sizeof *b->triangles);
    if (!b->triangles) return out_of_memory(b);
    for (size_t t = 0; t < b->mesh->triangle_count; t++) {
        uint32_t *corners = b->triangles + 3 * (size_t)b->triangle_count;
        for (size_t k = 0; k < 3; k++) corners[k] = b->welded[b->mesh->indices[3 * t + k]];
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            b->out->dropped_triangles++;
        else
            b->triangle_count++;
    }
    if (b->triangle_count == 0)
        return fail(HEMI_ERROR_DATA, b->message, "no triangle of the control cage has three different corners");
    return HEMI_OK;
}

/* ---- edges ----------------------------------------------------------------------------------------------------- */

static int compare_edges(const void *left, const void *right) {
    const edge *a = left, *b = right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static bool same_edge(const edge *a, const edge *b) {
    return a->low == b->low && a->high == b->high;
}

static hemi_result sort_edges(builder *b) {
    size_t count = 3 * (size_t)b->triangle_count;
    b->edges = malloc(count * sizeof *b->edges);
    if (!b->edges) return out_of_memory(b);
    for (size_t i = 0; i < count; i++) {
        size_t triangle = i / 3, first = i % 3;
        uint32_t from = b->triangles[i], to = b->triangles[3 * triangle + (first + 1) % 3];
        b->edges[i] =
            (edge){ from < to ? from : to, from < to ? to : from, (uint32_t)triangle, (uint8_t)first, from < to };
    }
    qsort(b->edges, count, sizeof *b->edges, compare_edges);
    return HEMI_OK;
}

static hemi_result bad_edge(const builder *b, const edge *e, const char *fault) {
    const double *p = b->out->positions + 3 * (size_t)e->low, *q = b->out->positions + 3 * (size_t)e->high;
    return fail(HEMI_ERROR_DATA, b->message, "the edge from (%g %g %g) to (%g %g %g) %s", p[0], p[1], p[2], q[0], q[1],
                q[2], fault);
}

static hemi_result check_edges(const builder *b) {
    size_t count = 3 * (size_t)b->triangle_count;
    for (size_t i = 1; i < count; i++) {
        const edge *e = &b->edges[i];
        if (!same_edge(e, e - 1)) continue;
        if (i >= 2 && same_edge(e, e - 2))
            return bad_edge(b, e, "has more than two faces: a subdivision surface has at most two");
        if (e->upward == (e - 1)->upward) return bad_edge(b, e, "has two faces that are wound against each other");
    }
    return HEMI_OK;
}

static hemi_result check_valence(const builder *b) {
    uint32_t *valence = calloc(b->out->vertex_count, sizeof *valence);
    if (!valence) return out_of_memory(b);
    uint32_t most = 0;
    for (size_t i = 0; i < 3 * (size_t)b->triangle_count; i++) {
        if (i > 0 && same_edge(&b->edges[i], &b->edges[i - 1])) continue;
        uint32_t low = ++valence[b->edges[i].low], high = ++valence[b->edges[i].high];
        if (low > most) most = low;
        if (high > most) most = high;
    }
    free(valence);
    if (most <= CAGE_VALENCE_MAX) return HEMI_OK;
    return fail(HEMI_ERROR_LIMIT, b->message, "%lu edges of the control cage meet in one vertex; at most %d may",
                (unsigned long)most, CAGE_VALENCE_MAX);
}

/* ---- quads ----------------------------------------------------------------------------------------------------- */

static void subtract(const double *a, const double *b, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static bool normal_of(const builder *b, uint32_t triangle, double normal[3]) {
    const double *p[3];
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) p[k] = b->out->positions + 3 * (size_t)b->triangles[3 * (size_t)triangle + (size_t)k];
    subtract(p[1], p[0], u);
    subtract(p[2], p[0], v);
    subtract(p[2], p[1], w);
    cross(u, v, normal);
    double area = sqrt(dot(normal, normal)), longest = fmax(dot(u, u), fmax(dot(v, v), dot(w, w)));
    if (!(area > CAGE_DEGENERATE * longest)) return false;
    for (int k = 0; k < 3; k++) normal[k] /= area;
    return true;
}

/* The quad of two triangles on one edge, from where the first one's side of the edge begins:
 *
 *         v ---- apex1       triangle 0: u v apex0, triangle 1: v u apex1,
 *        / \    /            quad: u apex1 v apex0
 *       /   \  /
 *  apex0 --- u
 */
static void quad_corners(const builder *b, size_t first_edge, uint32_t corners[4]) {
    for (size_t side = 0; side < 2; side++) {
        const edge *e = &b->edges[first_edge + side];
        const uint32_t *triangle = b->triangles + 3 * (size_t)e->triangle;
        corners[2 * side] = triangle[e->first];
        corners[3 - 2 * side] = triangle[(e->first + 2) % 3];
    }
}

/* How far the corners are from right angles (the largest cosine), or HUGE_VAL if they are not convex about normal. */
static double corner_cost(const builder *b, const uint32_t corners[4], const double normal[3]) {
    double worst = 0.0;
    for (int k = 0; k < 4; k++) {
        const double *before = b->out->positions + 3 * (size_t)corners[(k + 3) % 4];
        const double *here = b->out->positions + 3 * (size_t)corners[k];
        const double *after = b->out->positions + 3 * (size_t)corners[(k + 1) % 4];
        double in[3], out[3], turn[3];
        subtract(here, before, in);
        subtract(after, here, out);
        cross(in, out, turn);
        double lengths = sqrt(dot(in, in) * dot(out, out));
        if (!(dot(turn, normal) > CAGE_CONVEX * lengths)) return HUGE_VAL;
        worst = fmax(worst, fabs(dot(in, out)) / lengths);
    }
    return worst;
}

/* HUGE_VAL: the two triangles at this edge are not a planar convex quad. */
static double pair_cost(const builder *b, size_t first_edge) {
    double n0[3], n1[3], turn[3];
    uint32_t corners[4], t0 = b->edges[first_edge].triangle, t1 = b->edges[first_edge + 1].triangle;
    if (!normal_of(b, t0, n0) || !normal_of(b, t1, n1)) return HUGE_VAL;
    cross(n0, n1, turn);
    if (dot(n0, n1) <= 0.0 || dot(turn, turn) > CAGE_COPLANAR * CAGE_COPLANAR) return HUGE_VAL;
    quad_corners(b, first_edge, corners);
    return corner_cost(b, corners, n0) * (t1 == t0 + 1 ? CAGE_NEIGHBOUR : 1.0);
}

static int compare_candidates(const void *left, const void *right) {
    const quad_candidate *a = left, *b = right;
    if (a->cost != b->cost) return a->cost < b->cost ? -1 : 1;
    return a->first < b->first ? -1 : a->first > b->first;
}

/* Greedy: the most rectangular first. A largest matching would find more quads, but not more of the true ones. */
static hemi_result pair_triangles(builder *b) {
    size_t edge_count = 3 * (size_t)b->triangle_count, count = 0;
    quad_candidate *candidates = malloc(edge_count / 2 * sizeof *candidates + 1);
    if (!candidates) return out_of_memory(b);
    for (size_t i = 0; i + 1 < edge_count; i++) {
        if (!same_edge(&b->edges[i], &b->edges[i + 1])) continue;
        double cost = pair_cost(b, i);
        if (cost < HUGE_VAL) candidates[count++] = (quad_candidate){ cost, i };
    }
    qsort(candidates, count, sizeof *candidates, compare_candidates);
    for (size_t i = 0; i < count; i++) {
        size_t first = candidates[i].first;
        uint32_t t0 = b->edges[first].triangle, t1 = b->edges[first + 1].triangle;
        if (b->partners[t0] != SIZE_MAX || b->partners[t1] != SIZE_MAX) continue;
        b->partners[t0] = b->partners[t1] = first;
        b->out->quad_count++;
    }
    free(candidates);
    return HEMI_OK;
}

/* ---- faces ----------------------------------------------------------------------------------------------------- */

static void add_face(cage *out, const uint32_t *corners, int size) {
    for (int k = 0; k < size; k++) out->corners[out->corner_count++] = (int)corners[k];
    out->sizes[out->face_count++] = size;
}

static hemi_result make_faces(builder *b) {
    cage *out = b->out;
    out->sizes = malloc(b->triangle_count * sizeof *out->sizes);
    out->corners = malloc(3 * (size_t)b->triangle_count * sizeof *out->corners);
    if (!out->sizes || !out->corners) return out_of_memory(b);
    for (uint32_t t = 0; t < b->triangle_count; t++) {
        uint32_t corners[4];
        if (b->partners[t] == SIZE_MAX) {
            add_face(out, b->triangles + 3 * (size_t)t, 3);
        } else if (b->edges[b->partners[t]].triangle == t) { /* the later triangle of a quad adds nothing */
            quad_corners(b, b->partners[t], corners);
            add_face(out, corners, 4);
        }
    }
    return HEMI_OK;
}

static hemi_result make_partners(builder *b) {
    b->partners = malloc(b->triangle_count * sizeof *b->partners);
    if (!b->partners) return out_of_memory(b);
    for (uint32_t t = 0; t < b->triangle_count; t++) b->partners[t] = SIZE_MAX;
    return b->mesh->subdivision == HEMI_SUBDIVISION_CATMULL_CLARK ? pair_triangles(b) : HEMI_OK;
}

hemi_result cage_create(const hemi_mesh_desc *mesh, cage *out, char message[SUBDIVIDE_MESSAGE_SIZE]) {
    builder b = { .mesh = mesh, .out = out, .message = message };
    *out = (cage){ 0 };
    hemi_result result = check_mesh(&b);
    if (result == HEMI_OK) result = weld(&b);
    if (result == HEMI_OK) result = weld_triangles(&b);
    if (result == HEMI_OK) result = sort_edges(&b);
    if (result == HEMI_OK) result = check_edges(&b);
    if (result == HEMI_OK) result = check_valence(&b);
    if (result == HEMI_OK) result = make_partners(&b);
    if (result == HEMI_OK) result = make_faces(&b);
    free(b.welded);
    free(b.triangles);
    free(b.edges);
    free(b.partners);
    if (result != HEMI_OK) cage_destroy(out);
    return result;
}

void cage_destroy(cage *c) {
    free(c->positions);
    free(c->sizes);
    free(c->corners);
    *c = (cage){ 0 };
}
