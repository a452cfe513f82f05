/* SPDX-License-Identifier: MIT
 * Which edges have a vertex of another triangle in their middle? Only edges of one triangle can (elsewhere surfaces
 * close), and only against the ends of such edges: a tree of those says which are near to each edge.
 */
#include "internal.h"

#include "base/tolerance.h"
#include "geometry/bvh.h"
#include "geometry/vec3.h"

#include <hemibake/mesh_transform.h>

#include <math.h>

/* Of a mesh that would ask for more comparisons, as one of very many triangles that have one corner in common, the
 * edges looked at so far are counted. */
static const uint64_t COMPARISONS_MAX = UINT64_C(20000000);

typedef struct open_edges {
    double (*ends)[3]; /* ends[2*i] and ends[2*i+1] of edge i */
    size_t count;      /* of ends */
    double near;
    bvh tree; /* of the ends */
    uint64_t comparisons;
    size_t own; /* the first end of the edge that is looked along */
} open_edges;

static bool lies_between(const open_edges *g, const double a[3], const double b[3], const double p[3]) {
    double length = vec3_distance(a, b), t = 0.0, edge[3], foot[3];
    if (vec3_distance(a, p) <= g->near || vec3_distance(b, p) <= g->near) return false;
    vec3_sub(edge, b, a);
    for (int k = 0; k < 3; k++) t += (p[k] - a[k]) * edge[k] / (length * length);
    vec3_add_scaled(foot, a, t, edge);
    return t > 0.0 && t < 1.0 && vec3_distance(foot, p) <= g->near;
}

/* Ends of the edges that one triangle has. */
static bool list_open(builder *b, const double *normals, open_edges *g) {
    double largest = 0.0;
    for (size_t c = 0; c < 3 * (size_t)b->mesh->triangle_count; c++) {
        const double *n = normals + 3 * (c / 3);
        uint32_t p = b->mesh->indices[c], q = b->mesh->indices[c % 3 == 2 ? c - 2 : c + 1];
        uint64_t high, low = pair_order(b->place[p], b->place[q], &high);
        if (vec3_is_zero(n)) continue;
        uint32_t *uses = pair_map_at(&b->edges, low, high, 0);
        if (!uses) return false;
        if (*uses != 1) continue;
        double(*ends)[3] = g->ends + g->count;
        hemi_transform_point(b->mesh->transform, b->mesh->positions + 3 * (size_t)p, ends[0]);
        hemi_transform_point(b->mesh->transform, b->mesh->positions + 3 * (size_t)q, ends[1]);
        for (int k = 0; k < 3; k++) largest = fmax(largest, fmax(fabs(ends[0][k]), fabs(ends[1][k])));
        g->count += 2;
    }
    g->near = TOLERANCE_OVERLAP * largest;
    return true;
}

static bool build_tree(allocator *memory, open_edges *g) {
    bvh_box *boxes = block_new(memory, (g->count + 1) * sizeof *boxes);
    g->tree.nodes = block_new(memory, (2 * g->count + 1) * sizeof *g->tree.nodes);
    g->tree.items = block_new(memory, (g->count + 1) * sizeof *g->tree.items);
    bool ok = boxes && g->tree.nodes && g->tree.items;
    for (size_t i = 0; ok && i < g->count; i++)
        bvh_box_set(&boxes[i], (uint32_t)i, (const double(*)[3])g->ends[i], 1, g->near);
    if (ok && g->count > 0) bvh_build(NULL, &g->tree, boxes, g->count);
    block_free(boxes);
    return ok;
}

static bool is_inside(void *user, const uint32_t *items, uint32_t count) {
    open_edges *g = user;
    g->comparisons += count;
    for (uint32_t i = 0; i < count; i++)
        if (lies_between(g, g->ends[g->own], g->ends[g->own + 1], g->ends[items[i]])) return true;
    return g->comparisons >= COMPARISONS_MAX;
}

hemi_result t_junctions_count(builder *b, const double *normals) {
    size_t most = 6 * (size_t)b->mesh->triangle_count + 1;
    open_edges g = { .ends = block_new(b->desc->memory, most * sizeof *g.ends) };
    bool ok = g.ends && list_open(b, normals, &g) && build_tree(b->desc->memory, &g);
    for (; ok && g.own < g.count && g.comparisons < COMPARISONS_MAX; g.own += 2) {
        bool has_inside = bvh_segment(&g.tree, g.ends[g.own], g.ends[g.own + 1], is_inside, &g);
        b->out->check.junction_count += has_inside && g.comparisons < COMPARISONS_MAX;
    }
    block_free_all(g.ends, g.tree.nodes, g.tree.items);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
