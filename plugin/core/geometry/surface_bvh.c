/* SPDX-License-Identifier: MIT
 * See surface_bvh.h.
 */
#include "geometry/surface_bvh.h"

#include "base/block.h"
#include "base/tolerance.h"
#include "visibility/occlusion.h"

#include <stdlib.h>

enum { LEAF_SURFACES = 4, DEPTH_MOST = 64 };

/* Boxes are this much wider than what is in them, relative to the scene's radius, so that a path along a face of one is
 * not lost to a rounding; occlusion.h decides. */
static const double BOX_MARGIN = 1e-9;

typedef struct node {
    double low[3], high[3];
    uint32_t first, count; /* a leaf's surfaces; count 0: the child that does not follow this node */
} node;

struct surface_bvh {
    node *nodes;
    uint32_t *surfaces;
    uint32_t node_count;
};

/* A surface while the tree is built. */
typedef struct placed {
    double low[3], high[3], key;
    uint32_t surface;
} placed;

static int compare_keys(const void *a, const void *b) {
    const placed *p = a, *q = b;
    if (p->key != q->key) return p->key < q->key ? -1 : 1;
    return (p->surface > q->surface) - (p->surface < q->surface);
}

static void place(const scene *s, uint32_t index, placed *out) {
    const surface *f = &s->surfaces[index];
    *out = (placed){ .surface = index };
    for (int k = 0; k < 3; k++) out->low[k] = INFINITY, out->high[k] = -INFINITY;
    for (int i = 0; i < surface_corner_count(f); i++)
        for (int k = 0; k < 3; k++) {
            out->low[k] = fmin(out->low[k], scene_vertex(s, f->corner[i])[k]);
            out->high[k] = fmax(out->high[k], scene_vertex(s, f->corner[i])[k]);
        }
}

static void enclose(const scene *s, const placed *all, uint32_t count, node *out) {
    for (int k = 0; k < 3; k++) {
        out->low[k] = INFINITY, out->high[k] = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            out->low[k] = fmin(out->low[k], all[i].low[k]);
            out->high[k] = fmax(out->high[k], all[i].high[k]);
        }
        out->low[k] -= BOX_MARGIN * s->radius;
        out->high[k] += BOX_MARGIN * s->radius;
    }
}

/* Halves by the middles along the longest side of the box. */
static void build(surface_bvh *tree, const scene *s, placed *all, uint32_t first, uint32_t count) {
    node *n = &tree->nodes[tree->node_count++];
    enclose(s, all + first, count, n);
    n->first = first, n->count = count;
    if (count <= LEAF_SURFACES) return;
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (n->high[k] - n->low[k] > n->high[axis] - n->low[axis]) axis = k;
    for (uint32_t i = first; i < first + count; i++) all[i].key = all[i].low[axis] + all[i].high[axis];
    qsort(all + first, count, sizeof *all, compare_keys);
    n->count = 0;
    build(tree, s, all, first, count / 2);
    n->first = tree->node_count;
    build(tree, s, all, first + count / 2, count - count / 2);
}

surface_bvh *surface_bvh_create(const scene *s) {
    surface_bvh *tree = block_zeroed(s->memory, 1, sizeof *tree);
    placed *all = block_new(s->memory, (s->surface_count + 1) * sizeof *all);
    uint32_t count = 0;
    if (tree) {
        tree->nodes = block_new(s->memory, (2 * s->surface_count + 2) * sizeof *tree->nodes);
        tree->surfaces = block_new(s->memory, (s->surface_count + 1) * sizeof *tree->surfaces);
    }
    if (!tree || !all || !tree->nodes || !tree->surfaces) {
        block_free(all);
        surface_bvh_destroy(tree);
        return NULL;
    }
    for (uint32_t i = 0; i < s->surface_count; i++)
        if (surface_sheet(s, i) == i) place(s, i, &all[count++]);
    build(tree, s, all, 0, count);
    for (uint32_t i = 0; i < count; i++) tree->surfaces[i] = all[i].surface;
    block_free(all);
    return tree;
}

void surface_bvh_destroy(surface_bvh *tree) {
    if (!tree) return;
    block_free(tree->nodes);
    block_free(tree->surfaces);
    block_free(tree);
}

/* Does the segment from + t d, t in [0, 1], meet the box? inverse: 1 / d, infinite where d is 0. */
static bool meets(const node *n, const double from[3], const double inverse[3]) {
    double enter = 0.0, leave = 1.0;
    for (int k = 0; k < 3; k++) {
        if (isinf(inverse[k])) {
            if (from[k] < n->low[k] || from[k] > n->high[k]) return false;
            continue;
        }
        double a = (n->low[k] - from[k]) * inverse[k], b = (n->high[k] - from[k]) * inverse[k];
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    return enter <= leave;
}

static bool leaf_blocks(const surface_bvh *tree, const scene *s, const node *n, uint32_t own, const double from[3],
                        const double to[3]) {
    for (uint32_t i = n->first; i < n->first + n->count; i++) {
        const surface *f = &s->surfaces[tree->surfaces[i]];
        double t;
        if (tree->surfaces[i] == own || !occlusion_crossing(f, from, to, &t)) continue;
        if (t > TOLERANCE_SEGMENT_END && t < 1 - TOLERANCE_SEGMENT_END && occlusion_inside(s, f, from, to, t))
            return true;
    }
    return false;
}

bool surface_bvh_blocks(const surface_bvh *tree, const scene *s, uint32_t own, const double from[3],
                        const double to[3]) {
    uint32_t waiting[DEPTH_MOST], count = 1;
    double inverse[3];
    for (int k = 0; k < 3; k++) inverse[k] = 1.0 / (to[k] - from[k]);
    waiting[0] = 0;
    while (count > 0) {
        uint32_t at = waiting[--count];
        const node *n = &tree->nodes[at];
        if (!meets(n, from, inverse)) continue;
        if (n->count > 0) {
            if (leaf_blocks(tree, s, n, own, from, to)) return true;
        } else { /* halves: no deeper than 32 levels */
            waiting[count++] = n->first;
            waiting[count++] = at + 1;
        }
    }
    return false;
}
