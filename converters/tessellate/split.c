/* SPDX-License-Identifier: MIT
 * How is a face cut to patches and elements? Halved in the middle of its longest edge, again and again.
 */
#include "internal.h"

#include "geometry/vec3.h"

#include <math.h>
#include <string.h>

/* A corner of a piece: its vertex, and where it lies on the face (0,0 at corner 0; 1,0 at corner 1; 0,1 at the last).
 */
typedef struct corner {
    uint32_t vertex;
    double u, v;
} corner;

typedef struct piece {
    corner c[4];
    int count;
} piece;

typedef struct splitter {
    builder *b;
    const face *f;
    hemi_result result;
} splitter;

static double edge_length(const builder *b, const corner *p, const corner *q) {
    const double *a = b->out->positions + 3 * (size_t)p->vertex, *c = b->out->positions + 3 * (size_t)q->vertex;
    return vec3_distance(a, c);
}

/* Barycentric coordinates in the source triangle that holds (u, v); a quad has two, on either side of u + v = 1. */
static void set_source(splitter *s, uint32_t vertex, double u, double v) {
    int second = s->f->triangle[1] != TESSELLATE_NONE && u + v > 1.0;
    const double first_weights[3] = { 1 - u - v, u, v }, second_weights[3] = { 1 - v, u + v - 1, 1 - u };
    const double *weights = second ? second_weights : first_weights;
    tessellation *out = s->b->out;
    out->source_triangles[vertex] = s->f->triangle[second];
    for (int k = 0; k < 3; k++)
        out->source_weights[3 * (size_t)vertex + (k + s->f->rotation[second]) % 3] = (float)weights[k];
}

static uint32_t node_between(builder *b, uint32_t p, uint32_t q) {
    uint32_t low = p < q ? p : q, high = p < q ? q : p;
    uint32_t *node = pair_map_at(&b->node_midpoints, low, high, TESSELLATE_NONE);
    if (!node) return TESSELLATE_NONE;
    if (*node == TESSELLATE_NONE) *node = b->out->node_count++;
    return *node;
}

static corner midpoint(splitter *s, const corner *p, const corner *q) {
    builder *b = s->b;
    corner m = { TESSELLATE_NONE, 0.5 * (p->u + q->u), 0.5 * (p->v + q->v) };
    uint32_t low = p->vertex < q->vertex ? p->vertex : q->vertex, high = p->vertex < q->vertex ? q->vertex : p->vertex;
    uint32_t *known = pair_map_at(&b->midpoints, low, high, TESSELLATE_NONE);
    if (known && *known == TESSELLATE_NONE) {
        double position[3];
        uint32_t node = node_between(b, b->out->nodes[low], b->out->nodes[high]);
        for (int k = 0; k < 3; k++)
            position[k] = 0.5 * (b->out->positions[3 * (size_t)low + k] + b->out->positions[3 * (size_t)high + k]);
        *known = node == TESSELLATE_NONE ? node : builder_add_vertex(b, position, node);
        if (*known != TESSELLATE_NONE) set_source(s, *known, m.u, m.v);
    }
    if (known) m.vertex = *known;
    if (m.vertex == TESSELLATE_NONE) s->result = HEMI_ERROR_MEMORY, m.vertex = low;
    return m;
}

/* Halves a piece whose longest edge is longer than the limit. */
static bool halve(splitter *s, const piece *p, double limit, piece half[2]) {
    int longest = 0, n = p->count;
    double length = -1.0;
    for (int i = 0; i < (n == 4 ? 2 : 3); i++) {
        double l = edge_length(s->b, &p->c[i], &p->c[(i + 1) % n]);
        /* A rounding must not decide between the sides of a square. */
        if (l > length * (1 + 1e-9)) length = l, longest = i;
    }
    if (!(length > limit)) return false;
    const corner *a = &p->c[longest], *b = &p->c[(longest + 1) % n], *c = &p->c[(longest + 2) % n];
    corner m = midpoint(s, a, b);
    if (n == 3) {
        half[0] = (piece){ { *a, m, *c }, 3 };
        half[1] = (piece){ { m, *b, *c }, 3 };
        return true;
    }
    const corner *d = &p->c[(longest + 3) % n];
    corner opposite = midpoint(s, c, d);
    half[0] = (piece){ { *a, m, opposite, *d }, 4 };
    half[1] = (piece){ { m, *b, *c, opposite }, 4 };
    return true;
}

static void set_corners(uint32_t out[4], const piece *p) {
    for (int i = 0; i < 4; i++) out[i] = i < p->count ? p->c[i].vertex : TESSELLATE_NONE;
}

static void add_element(splitter *s, const piece *p) {
    tessellation *out = s->b->out;
    if (out->element_count >= s->b->desc->max_elements) {
        s->result = HEMI_ERROR_LIMIT;
        return;
    }
    if (!builder_grow(s->b, (void **)&out->elements, &s->b->element_capacity, out->element_count,
                      sizeof *out->elements)) {
        s->result = HEMI_ERROR_MEMORY;
        return;
    }
    set_corners(out->elements[out->element_count++].corner, p);
}

static void split_to_elements(splitter *s, const piece *p) {
    piece half[2];
    if (s->result != HEMI_OK) return;
    if (!halve(s, p, sqrt(2.0) * s->b->desc->element_size, half)) {
        add_element(s, p);
        return;
    }
    split_to_elements(s, &half[0]);
    split_to_elements(s, &half[1]);
}

static void split_to_patches(splitter *s, const piece *p, uint32_t surface) {
    piece half[2];
    tessellation *out = s->b->out;
    if (s->result != HEMI_OK) return;
    if (halve(s, p, sqrt(2.0) * s->b->desc->patch_size, half)) {
        split_to_patches(s, &half[0], surface);
        split_to_patches(s, &half[1], surface);
        return;
    }
    if (!builder_grow(s->b, (void **)&out->patches, &s->b->patch_capacity, out->patch_count, sizeof *out->patches)) {
        s->result = HEMI_ERROR_MEMORY;
        return;
    }
    uint32_t index = out->patch_count++, first = out->element_count;
    out->patches[index] = (tessellate_patch){ .surface = surface, .first_element = first };
    set_corners(out->patches[index].corner, p);
    split_to_elements(s, p);
    out->patches[index].element_count = out->element_count - first;
}

hemi_result split_face(builder *b, const face *f) {
    static const double u[2][4] = { { 0, 1, 0, 0 }, { 0, 1, 1, 0 } }, v[2][4] = { { 0, 0, 1, 0 }, { 0, 0, 1, 1 } };
    tessellation *out = b->out;
    splitter s = { b, f, HEMI_OK };
    piece whole = { .count = f->corner[3] == TESSELLATE_NONE ? 3 : 4 };
    if (!builder_grow(b, (void **)&out->surfaces, &b->surface_capacity, out->surface_count, sizeof *out->surfaces))
        return HEMI_ERROR_MEMORY;
    uint32_t index = out->surface_count++;
    out->surfaces[index] = (tessellate_surface){ .mesh = b->mesh_index,
                                                 .triangle = { f->triangle[0], f->triangle[1] },
                                                 .twin = TESSELLATE_NONE };
    memcpy(out->surfaces[index].corner, f->corner, sizeof f->corner);
    for (int i = 0; i < whole.count; i++) {
        whole.c[i] = (corner){ f->corner[i], u[whole.count - 3][i], v[whole.count - 3][i] };
        set_source(&s, whole.c[i].vertex, whole.c[i].u, whole.c[i].v);
    }
    split_to_patches(&s, &whole, index);
    return s.result;
}
