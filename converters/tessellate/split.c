/* SPDX-License-Identifier: MIT
 * How is a face split to patches and elements? Halved in the middle of its longest edge, again and again; where it is
 * long and thin, both long edges at once.
 *
 * One long edge at a time makes 3^log2(n) pieces of a sliver n times as long as they are, since each half has two long
 * edges again: 300 elements of each sliver around a hole of 512 corners. Both at once leave a sliver and a strip, and
 * of a strip two: 2 n. Either way an edge is halved in its middle and by its own length alone.
 */
#include "internal.h"

#include <math.h>
#include <string.h>

/* A corner of a piece: its vertex, and where it lies on the face (0,0 at corner 0; 1,0 at corner 1; 0,1 at the last).
 */
typedef struct corner {
    uint32_t vertex;
    double u, v;
} corner;

/* A triangle; a parallelogram; or a strip, whose long edges are from corner 0 to 1 and from 2 to 3. */
typedef struct piece {
    corner c[4];
    int count;
    bool is_strip;
} piece;

/* A sliver's short edge is shorter than this share of its longest: of fatter ones the few more pieces show more. */
static const double SLIVER_EDGE = 1.0 / 32;

/* No edge is longer than so many times the size that is meant: halves are longer than half of that. */
static const double LONGEST = 1.41421356237309505;

typedef struct splitter {
    builder *b;
    const face *f;
    hemi_result result;
} splitter;

static void set_source_in_grid(splitter *s, uint32_t vertex, double u, double v) {
    const surface_grid *g = s->f->grid;
    const hemi_mesh_desc *m = s->b->mesh;
    const source_mesh source = { .positions = m->positions, .indices = m->indices };
    double place[3];
    vec3_copy(place, g->origin);
    vec3_add_scaled(place, place, u, g->across);
    vec3_add_scaled(place, place, v, g->along);
    mesh_vertices_set_place(s->b->out->vertices, &source, surface_grid_triangles(g, place), place, vertex);
}

/* Barycentric coordinates in the source triangle that holds (u, v); a quad has two, on either side of u + v = 1. */
static void set_source(splitter *s, uint32_t vertex, double u, double v) {
    if (s->f->grid) {
        set_source_in_grid(s, vertex, u, v);
        return;
    }
    int second = s->f->triangle[1] != NO_INDEX && u + v > 1.0;
    const double first_weights[3] = { 1 - u - v, u, v }, second_weights[3] = { 1 - v, u + v - 1, 1 - u };
    const double *weights = second ? second_weights : first_weights;
    mesh_vertices *out = s->b->out->vertices;
    out->source_triangles[vertex] = s->f->triangle[second];
    for (int k = 0; k < 3; k++)
        out->source_weights[3 * (size_t)vertex + (k + s->f->rotation[second]) % 3] = (float)weights[k];
}

static corner midpoint(splitter *s, const corner *p, const corner *q) {
    bool added;
    corner m = { edge_midpoint(&s->b->midpoints, p->vertex, q->vertex, &added), 0.5 * (p->u + q->u),
                 0.5 * (p->v + q->v) };
    if (m.vertex == NO_INDEX)
        s->result = HEMI_ERROR_MEMORY, m.vertex = p->vertex;
    else if (added)
        set_source(s, m.vertex, m.u, m.v);
    return m;
}

static double edge_length(const splitter *s, const corner *p, const corner *q) {
    return mesh_vertices_distance(s->b->out->vertices, p->vertex, q->vertex);
}

/* Are pieces of the mesh larger away from what stands on it? */
static bool is_graded(const splitter *s) {
    const wide_ground *g = s->b->desc->ground;
    return g && g->is_there && !(s->b->mesh->element_size > 0.0);
}

/* Is an edge longer than this, and where pieces are graded than is meant there? */
static bool is_long(const splitter *s, const corner *p, const corner *q, double limit) {
    const double *at = s->b->out->vertices->positions;
    double length = edge_length(s, p, q);
    if (!(length > limit) || !is_graded(s)) return length > limit;
    return length >
           LONGEST * wide_ground_size(s->b->desc->ground, at + 3 * (size_t)p->vertex, at + 3 * (size_t)q->vertex);
}

/* Two edges of one length of a parallelogram, of which one may lie further out. */
static bool are_long(const splitter *s, const piece *p, int edge, double limit) {
    const corner *c = p->c;
    return is_long(s, &c[edge], &c[edge + 1], limit) ||
           (is_graded(s) && is_long(s, &c[edge + 2], &c[(edge + 3) % 4], limit));
}

/* The edges from corner 0 to 1 and from 2 to 3, both; or to two triangles where one of them is short enough and the
 * other is not, which is so in no parallelogram of pieces of one size. */
static void cut_across(splitter *s, const piece *p, double limit, piece parts[2]) {
    const corner *a = &p->c[0], *b = &p->c[1], *c = &p->c[2], *d = &p->c[3];
    if ((p->is_strip || is_graded(s)) && (!is_long(s, a, b, limit) || !is_long(s, c, d, limit))) {
        parts[0] = (piece){ { *a, *b, *c }, 3, false };
        parts[1] = (piece){ { *a, *c, *d }, 3, false };
        return;
    }
    corner m = midpoint(s, a, b), n = midpoint(s, c, d);
    parts[0] = (piece){ { *a, m, n, *d }, 4, p->is_strip };
    parts[1] = (piece){ { m, *b, *c, n }, 4, p->is_strip };
}

/* From the corner where the long edges of a sliver meet; false: it is none that has two to halve. */
static bool cut_sliver(splitter *s, const piece *p, double limit, piece parts[2]) {
    double length[3], longest = 0.0;
    for (int i = 0; i < 3; i++) {
        length[i] = edge_length(s, &p->c[i], &p->c[(i + 1) % 3]);
        longest = fmax(longest, length[i]);
    }
    for (int i = 0; i < 3; i++) { /* edge i is the short one */
        int next = (i + 1) % 3, last = (i + 2) % 3;
        const corner *tip = &p->c[last], *a = &p->c[i], *b = &p->c[next];
        if (length[i] > SLIVER_EDGE * longest || is_long(s, a, b, limit)) continue;
        if (!(is_long(s, b, tip, limit) && is_long(s, tip, a, limit))) return false;
        corner m = midpoint(s, tip, a), n = midpoint(s, b, tip);
        parts[0] = (piece){ { *tip, m, n }, 3, false };
        parts[1] = (piece){ { m, *a, *b, n }, 4, true };
        return true;
    }
    return false;
}

/* Cuts a piece in two, in the middle of the longest of its edges that are too long; false: none is. */
static bool cut(splitter *s, const piece *p, double limit, piece parts[2]) {
    int longest = -1, n = p->count;
    double length = 0.0;
    if (p->is_strip) {
        cut_across(s, p, limit, parts);
        return true;
    }
    if (n == 3 && cut_sliver(s, p, limit, parts)) return true;
    for (int i = 0; i < (n == 4 ? 2 : 3); i++) {
        const corner *from = &p->c[i], *to = &p->c[(i + 1) % n];
        double l = edge_length(s, from, to);
        /* A rounding must not decide between the sides of a square. */
        if (!(l > length * (1 + 1e-9))) continue;
        if (n == 4 ? are_long(s, p, i, limit) : is_long(s, from, to, limit)) length = l, longest = i;
    }
    if (longest < 0) return false;
    const corner *a = &p->c[longest], *b = &p->c[(longest + 1) % n], *c = &p->c[(longest + 2) % n];
    if (n == 4) {
        const piece turned = { { *a, *b, *c, p->c[(longest + 3) % n] }, 4, false };
        cut_across(s, &turned, limit, parts);
        return true;
    }
    corner m = midpoint(s, a, b);
    parts[0] = (piece){ { *a, m, *c }, 3, false };
    parts[1] = (piece){ { m, *b, *c }, 3, false };
    return true;
}

static void set_corners(uint32_t out[4], const piece *p) {
    for (int i = 0; i < 4; i++) out[i] = i < p->count ? p->c[i].vertex : NO_INDEX;
}

static double element_size(const splitter *s) {
    double own = s->b->mesh->element_size;
    return own > 0.0 ? own : s->b->desc->element_size;
}

static void split_to_elements(splitter *s, const piece *p) {
    piece half[2];
    if (s->result != HEMI_OK) return;
    if (!cut(s, p, LONGEST * element_size(s), half)) {
        uint32_t vertices[4];
        set_corners(vertices, p);
        s->result = builder_add_element(s->b, vertices);
        return;
    }
    split_to_elements(s, &half[0]);
    split_to_elements(s, &half[1]);
}

static void split_to_patches(splitter *s, const piece *p, uint32_t surface_index) {
    piece half[2];
    mesh *m = s->b->out->mesh;
    if (s->result != HEMI_OK) return;
    if (cut(s, p, LONGEST * fmax(s->b->desc->patch_size, element_size(s)), half)) {
        split_to_patches(s, &half[0], surface_index);
        split_to_patches(s, &half[1], surface_index);
        return;
    }
    patch *out = builder_add_patch(s->b);
    if (!out) {
        s->result = HEMI_ERROR_MEMORY;
        return;
    }
    out->surface = surface_index;
    out->first_element = (uint32_t)m->element_count;
    set_corners(out->corner, p);
    split_to_elements(s, p);
    out->element_count = (uint32_t)m->element_count - out->first_element;
}

hemi_result split_face(builder *b, const face *f) {
    static const double u[2][4] = { { 0, 1, 0, 0 }, { 0, 1, 1, 0 } }, v[2][4] = { { 0, 0, 1, 0 }, { 0, 0, 1, 1 } };
    splitter s = { b, f, HEMI_OK };
    piece whole = { .count = f->corner[3] == NO_INDEX ? 3 : 4 };
    surface *out = builder_add_surface(b);
    if (!out) return HEMI_ERROR_MEMORY;
    out->mesh = b->mesh_index;
    out->material = b->mesh->material;
    out->twin = NO_INDEX;
    out->grid = f->grid;
    memcpy(out->triangle, f->triangle, sizeof f->triangle);
    memcpy(out->corner, f->corner, sizeof f->corner);
    for (int i = 0; i < whole.count; i++) {
        whole.c[i] = (corner){ f->corner[i], u[whole.count - 3][i], v[whole.count - 3][i] };
        set_source(&s, whole.c[i].vertex, whole.c[i].u, whole.c[i].v);
    }
    split_to_patches(&s, &whole, (uint32_t)b->out->scene->surface_count - 1);
    return s.result;
}
