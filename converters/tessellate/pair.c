/* SPDX-License-Identifier: MIT
 * Which two triangles were one parallelogram? Those that share an edge (r p q | p s q) with r + s = p + q, in position
 * and in every attribute: then bilinear interpolation over the quad is what each triangle has, and nothing changes but
 * the number of pieces.
 */
#include "internal.h"

#include "base/tolerance.h"

#include <math.h>

/* How many triangles have it, and the sum of their numbers. */
typedef struct shared_edge {
    uint32_t uses, sum;
} shared_edge;

typedef struct pairing {
    builder *b;
    shared_edge *edges; /* of the mesh */
    uint32_t *edge;     /* edge[3*t+k] from corner k of triangle t */
    bool *taken;        /* taken[t]: it is in a face */
} pairing;

static bool number_edges(pairing *p) {
    builder *b = p->b;
    uint32_t count = 0;
    for (size_t c = 0; c < 3 * (size_t)b->mesh->triangle_count; c++) {
        const uint32_t *corner = b->triangles + c - c % 3;
        if (corner[0] == NO_INDEX) continue;
        uint64_t high, low = pair_order(corner[c % 3], corner[(c + 1) % 3], &high);
        uint32_t *number = pair_map_at(&b->edges, low, high, count);
        if (!number) return false;
        if (*number == count) p->edges[count++] = (shared_edge){ 0, 0 };
        p->edge[c] = *number;
        p->edges[*number].uses++, p->edges[*number].sum += (uint32_t)(c / 3);
    }
    return true;
}

/* The other triangle on the edge from corner k of triangle t, or NO_INDEX (border, or more than two). */
static uint32_t neighbour(const pairing *p, uint32_t t, int k) {
    const shared_edge *e = &p->edges[p->edge[3 * (size_t)t + (size_t)k]];
    return e->uses == 2 ? e->sum - t : NO_INDEX;
}

static bool is_affine(const float *values, uint32_t stride, const uint32_t index[4], double tolerance) {
    for (uint32_t k = 0; values && k < stride; k++) {
        double v[4], size = 1.0;
        for (int i = 0; i < 4; i++) {
            v[i] = values[(size_t)stride * index[i] + k];
            size = fmax(size, fabs(v[i]));
        }
        if (!(fabs(v[0] + v[2] - v[1] - v[3]) <= tolerance * size)) return false;
    }
    return true;
}

static bool is_parallelogram(const builder *b, const uint32_t corner[4], const uint32_t index[4]) {
    double longest = fmax(mesh_vertices_distance(b->out->vertices, corner[0], corner[1]),
                          mesh_vertices_distance(b->out->vertices, corner[1], corner[2])),
           off = 0.0;
    double size = longest;
    for (int k = 0; k < 3; k++) {
        double v[4];
        for (int i = 0; i < 4; i++) v[i] = b->out->vertices->positions[3 * (size_t)corner[i] + k];
        off = fmax(off, fabs(v[0] + v[2] - v[1] - v[3]));
        for (int i = 0; i < 4; i++) size = fmax(size, 0.1 * fabs(v[i]));
    }
    return off <= TOLERANCE_AFFINE * size && is_affine(b->mesh->normals, 3, index, TOLERANCE_AFFINE_NORMAL) &&
           is_affine(b->mesh->attributes, b->mesh->attribute_count, index, TOLERANCE_AFFINE);
}

static int corner_of(const uint32_t triangle[3], uint32_t v) {
    for (int k = 0; k < 3; k++)
        if (triangle[k] == v) return k;
    return -1;
}

/* The quad of triangle t and its neighbour across the edge from its corner k, if they are one. */
static bool make_quad(const pairing *of, uint32_t t, int k, face *out) {
    const builder *b = of->b;
    uint32_t other = neighbour(of, t, k);
    if (other == NO_INDEX || of->taken[other]) return false;
    const uint32_t *mine = b->triangles + 3 * (size_t)t, *theirs = b->triangles + 3 * (size_t)other;
    int r = (k + 2) % 3, p = k, q = (k + 1) % 3, p_other = corner_of(theirs, mine[p]);
    if (p_other < 0 || theirs[(p_other + 2) % 3] != mine[q]) return false; /* wound against each other */
    const uint32_t *index = b->mesh->indices + 3 * (size_t)t, *index_other = b->mesh->indices + 3 * (size_t)other;
    *out = (face){ .corner = { mine[r], mine[p], theirs[(p_other + 1) % 3], mine[q] },
                   .triangle = { t, other },
                   .rotation = { (uint8_t)r, (uint8_t)p_other } };
    const uint32_t indices[4] = { index[r], index[p], index_other[(p_other + 1) % 3], index[q] };
    return is_parallelogram(b, out->corner, indices);
}

static face pair_triangle(const pairing *p, uint32_t t) {
    const builder *b = p->b;
    const uint32_t *corner = b->triangles + 3 * (size_t)t;
    double length[3];
    face out;
    for (int k = 0; k < 3; k++) length[k] = mesh_vertices_distance(b->out->vertices, corner[k], corner[(k + 1) % 3]);
    for (int tries = 0; tries < 3; tries++) {
        int longest = length[0] >= length[1] ? 0 : 1;
        if (length[2] > length[longest]) longest = 2;
        length[longest] = -1.0;
        if (make_quad(p, t, longest, &out)) return out;
    }
    return (face){ .corner = { corner[0], corner[1], corner[2], NO_INDEX }, .triangle = { t, NO_INDEX } };
}

static void pair_all(pairing *p) {
    builder *b = p->b;
    for (uint32_t t = 0; t < b->mesh->triangle_count; t++) {
        if (p->taken[t] || b->triangles[3 * (size_t)t] == NO_INDEX) continue;
        p->taken[t] = true;
        face f = pair_triangle(p, t);
        if (f.triangle[1] != NO_INDEX) p->taken[f.triangle[1]] = true;
        b->faces[b->face_count++] = f;
    }
}

hemi_result pair_triangles(builder *b) {
    size_t corners = 3 * (size_t)b->mesh->triangle_count;
    pairing p = { .b = b,
                  .edges = block_new(b->desc->memory, (corners + 1) * sizeof *p.edges),
                  .edge = block_new(b->desc->memory, (corners + 1) * sizeof *p.edge),
                  .taken = block_zeroed(b->desc->memory, b->mesh->triangle_count + (size_t)1, sizeof *p.taken) };
    bool ok = p.edges && p.edge && p.taken && number_edges(&p);
    if (ok) pair_all(&p);
    block_free_all(p.edges, p.edge, p.taken);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
