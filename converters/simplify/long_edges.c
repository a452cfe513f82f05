/* SPDX-License-Identifier: MIT
 * See long_edges.h.
 */
#include "long_edges.h"

#include "base/pair_map.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <string.h>

/* What is narrower than this share of the limit is a sliver: it shows little light, and is only cut where what lies
 * beside it is. */
static const double SLIVER = 1.0 / 16.0;

typedef struct corner {
    uint32_t vertex;
    float weights[3];
} corner;

/* is_long[k]: the edge from corner k may be cut. */
typedef struct piece {
    corner c[3];
    bool is_long[3];
} piece;

typedef struct cutting {
    const hemi_mesh_desc *dense;
    const uint32_t *indices;
    double limit;
    pair_map marked, middles; /* edges by vertices of the dense mesh; two vertices: the one between them */
    uint32_t triangle;
    bool is_wide;
    cut_mesh *out;
} cutting;

static void place_of(const cutting *g, const corner *at, double out[3]) {
    double local[3] = { 0, 0, 0 };
    for (size_t k = 0; k < 3; k++)
        for (size_t c = 0; c < 3; c++)
            local[c] += (double)at->weights[k] *
                        (double)g->dense->positions[3 * (size_t)g->dense->indices[3 * (size_t)g->triangle + k] + c];
    const float place[3] = { (float)local[0], (float)local[1], (float)local[2] };
    hemi_transform_point(g->dense->transform, place, out);
}

static piece whole(const cutting *g, uint32_t triangle) {
    piece p = { .c = { { .vertex = 0 } } };
    for (int k = 0; k < 3; k++) {
        p.c[k].vertex = g->indices[3 * (size_t)triangle + (size_t)k];
        p.c[k].weights[k] = 1.0f;
    }
    return p;
}

/* Lengths of the edges of a piece, world. */
static void measure(const cutting *g, const piece *p, double length[3], double *area) {
    double at[3][3];
    for (int k = 0; k < 3; k++) place_of(g, &p->c[k], at[k]);
    for (int k = 0; k < 3; k++) length[k] = vec3_distance(at[k], at[(k + 1) % 3]);
    *area = triangle_area(at[0], at[1], at[2]);
}

static bool is_wide(double limit, const double length[3], double area) {
    double longest = fmax(length[0], fmax(length[1], length[2]));
    return 2.0 * area > SLIVER * limit * longest;
}

/* By the source vertices of an edge, so that it is the same from either side. */
static uint32_t *mark_of(cutting *g, uint32_t triangle, int k) {
    const uint32_t *source = g->dense->indices + 3 * (size_t)triangle;
    uint64_t high, low = pair_order(source[k], source[(k + 1) % 3], &high);
    return pair_map_at(&g->marked, low, high, 0);
}

static bool mark_edges(cutting *g) {
    for (uint32_t t = 0; t < g->dense->triangle_count; t++) {
        double length[3], area;
        g->triangle = t;
        const piece p = whole(g, t);
        measure(g, &p, length, &area);
        for (int k = 0; k < 3 && is_wide(g->limit, length, area); k++) {
            uint32_t *mark = length[k] > g->limit ? mark_of(g, t, k) : NULL;
            if (mark) *mark = 1;
            if (length[k] > g->limit && !mark) return false;
        }
    }
    return true;
}

static bool add_vertex(cut_mesh *out, const cut_vertex *v) {
    if (!block_grow(out->memory, (void **)&out->vertices, &out->vertex_room, out->vertex_count, sizeof *v))
        return false;
    out->vertices[out->vertex_count++] = *v;
    return true;
}

static bool add_triangle(cut_mesh *out, const piece *p) {
    for (int k = 0; k < 3; k++) {
        size_t at = 3 * (size_t)out->triangle_count + (size_t)k;
        if (!block_grow(out->memory, (void **)&out->indices, &out->index_room, at, sizeof *out->indices)) return false;
        out->indices[at] = p->c[k].vertex;
    }
    out->triangle_count++;
    return true;
}

static bool set_middle(cutting *g, const corner *a, const corner *b, corner *out) {
    uint64_t high, low = pair_order(a->vertex, b->vertex, &high);
    uint32_t next = g->out->vertex_count, *middle = pair_map_at(&g->middles, low, high, next);
    cut_vertex v = { .triangle = g->triangle };
    if (!middle) return false;
    out->vertex = *middle;
    for (int k = 0; k < 3; k++) v.weights[k] = out->weights[k] = 0.5f * (a->weights[k] + b->weights[k]);
    return *middle != next || add_vertex(g->out, &v);
}

/* An edge that is cut has two that may be, and between them is one of the triangle's own. */
static bool cut(cutting *g, const piece *p) {
    double length[3], area;
    int longest = -1;
    measure(g, p, length, &area);
    for (int k = 0; k < 3; k++) /* A rounding must not decide between edges that are as long. */
        if (p->is_long[k] && length[k] > g->limit && (longest < 0 || length[k] > length[longest] * (1 + 1e-6)))
            longest = k;
    if (longest < 0) return add_triangle(g->out, p);
    int next = (longest + 1) % 3, last = (longest + 2) % 3;
    corner middle;
    if (!set_middle(g, &p->c[longest], &p->c[next], &middle)) return false;
    const piece one = { { p->c[longest], middle, p->c[last] }, { true, g->is_wide, p->is_long[last] } };
    const piece two = { { middle, p->c[next], p->c[last] }, { true, p->is_long[next], g->is_wide } };
    return cut(g, &one) && cut(g, &two);
}

static bool cut_triangle(cutting *g, uint32_t triangle) {
    double length[3], area;
    g->triangle = triangle;
    piece p = whole(g, triangle);
    measure(g, &p, length, &area);
    g->is_wide = is_wide(g->limit, length, area);
    for (int k = 0; k < 3; k++) {
        const uint32_t *source = g->dense->indices + 3 * (size_t)triangle;
        uint64_t high, low = pair_order(source[k], source[(k + 1) % 3], &high);
        p.is_long[k] = pair_map_get(&g->marked, low, high, 0);
    }
    return cut(g, &p);
}

bool long_edges_cut(allocator *memory, const hemi_mesh_desc *dense, const uint32_t *indices, const uint32_t *source,
                    uint32_t vertex_count, double limit, cut_mesh *out) {
    cutting g = { .dense = dense,
                  .indices = indices,
                  .limit = limit,
                  .marked = { .memory = memory },
                  .middles = { .memory = memory },
                  .out = out };
    *out = (cut_mesh){ .memory = memory };
    bool ok = true;
    for (uint32_t v = 0; ok && v < vertex_count; v++) {
        cut_vertex one = { .triangle = source[v] / 3 };
        one.weights[source[v] % 3] = 1.0f;
        ok = add_vertex(out, &one);
    }
    ok = ok && mark_edges(&g);
    for (uint32_t t = 0; ok && t < dense->triangle_count; t++) ok = cut_triangle(&g, t);
    pair_map_free(&g.marked);
    pair_map_free(&g.middles);
    return ok;
}

void cut_mesh_free(cut_mesh *c) {
    block_free_all(c->vertices, c->indices);
    memset(c, 0, sizeof *c);
}

/* ---- places ---- */

/* What is known at the corners of the triangle that a vertex lies on, where it lies; at[k]: of corner k, in values,
 * which has so many a vertex. */
static void mix(const cut_vertex *v, const uint32_t at[3], const float *values, size_t count, float *out) {
    for (size_t c = 0; c < count; c++) {
        double sum = 0.0;
        for (int k = 0; k < 3; k++)
            if (v->weights[k] != 0.0f) sum += (double)v->weights[k] * (double)values[count * at[k] + c];
        out[c] = (float)sum;
    }
}

static void set_normal(const float *given, const float *mean, bool back, float out[3]) {
    double length = sqrt(vec3_dot_floats(given, given));
    if (!(length > 1e-6)) given = mean, length = 1.0;
    for (int k = 0; k < 3; k++) out[k] = (float)(given[k] / length) * (back ? -1.0f : 1.0f);
}

void cut_vertex_place(const cut_vertex *v, const hemi_mesh_desc *dense, const uint32_t *indices, const float *normals,
                      bool back, const cut_place *out) {
    const uint32_t *source = dense->indices + 3 * (size_t)v->triangle, *own = indices + 3 * (size_t)v->triangle;
    float mean[3], given[3];
    mix(v, source, dense->positions, 3, out->position);
    mix(v, own, normals, 3, mean);
    mix(v, dense->normals ? source : own, dense->normals ? dense->normals : normals, 3, given);
    if (out->attributes) mix(v, source, dense->attributes, dense->attribute_count, out->attributes);
    set_normal(given, mean, back, out->normal);
    for (int k = 0; k < 3; k++) out->facing[k] = back ? -mean[k] : mean[k];
}

void cut_mesh_triangles(const cut_mesh *m, uint32_t sides, uint32_t *indices) {
    for (size_t side = 0; side < sides; side++)
        for (size_t t = 0; t < m->triangle_count; t++) {
            uint32_t *to = indices + 3 * (side * m->triangle_count + t);
            for (size_t k = 0; k < 3; k++)
                to[side ? 2 - k : k] = m->indices[3 * t + k] + (uint32_t)side * m->vertex_count;
        }
}
