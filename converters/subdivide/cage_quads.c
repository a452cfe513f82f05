/* SPDX-License-Identifier: MIT
 * Which two triangles of a cage were one quad? The most rectangular pairs of coplanar neighbours first. */
#include "cage_builder.h"

#include "geometry/plane.h"
#include "geometry/triangle.h"

#include <math.h>
#include <stdlib.h>

/* Two triangles that may be the halves of a quad: edges `first` and `first + 1` of the sorted list. */
typedef struct quad_candidate {
    double cost;
    size_t first;
} quad_candidate;

static const double *position(const cage_builder *b, uint32_t corner) {
    return b->out->positions + 3 * (size_t)b->corners[corner];
}

static bool normal_of(const cage_builder *b, uint32_t triangle, double normal[3]) {
    const double *p[3];
    for (uint32_t k = 0; k < 3; k++) p[k] = position(b, b->first[triangle] + k);
    triangle_cross(normal, p[0], p[1], p[2]);
    return !triangle_is_degenerate(vec3_normalize(normal), triangle_longest_squared(p[0], p[1], p[2]));
}

/* The quad of two triangles on one edge, from where the first one's side of the edge begins:
 *
 *         v ---- apex1       triangle 0: u v apex0, triangle 1: v u apex1,
 *        / \    /            quad: u apex1 v apex0
 *       /   \  /
 *  apex0 --- u
 */
void cage_quad_corners(const cage_builder *b, size_t first, uint32_t corners[4]) {
    for (size_t side = 0; side < 2; side++) {
        const cage_edge *e = &b->edges[first + side];
        uint32_t begin = b->first[e->face];
        corners[2 * side] = e->corner;
        corners[3 - 2 * side] = begin + (e->corner - begin + 2) % 3;
    }
}

/* How far the corners are from right angles (the largest cosine), or HUGE_VAL if they are not convex about normal. */
static double corner_cost(const cage_builder *b, const uint32_t corners[4], const double normal[3]) {
    double worst = 0.0;
    for (int k = 0; k < 4; k++) {
        double in[3], out[3], turn[3];
        vec3_sub(in, position(b, corners[k]), position(b, corners[(k + 3) % 4]));
        vec3_sub(out, position(b, corners[(k + 1) % 4]), position(b, corners[k]));
        vec3_cross(turn, in, out);
        double lengths = sqrt(vec3_dot(in, in) * vec3_dot(out, out));
        if (!(vec3_dot(turn, normal) > CAGE_CONVEX * lengths)) return HUGE_VAL;
        worst = fmax(worst, fabs(vec3_dot(in, out)) / lengths);
    }
    return worst;
}

/* A seam of attributes or the rim of a hole along the edge keeps its triangles apart. */
static bool may_pair(const cage_builder *b, const cage_edge *e0, const cage_edge *e1) {
    return b->holes[b->origins[e0->face]] == b->holes[b->origins[e1->face]] &&
           cage_same_values(b, e0->corner, e1->next) && cage_same_values(b, e0->next, e1->corner);
}

/* HUGE_VAL: the two triangles at this edge are not a planar convex quad. */
static double pair_cost(const cage_builder *b, size_t first) {
    double n0[3], n1[3];
    uint32_t corners[4], t0 = b->edges[first].face, t1 = b->edges[first + 1].face;
    if (!may_pair(b, &b->edges[first], &b->edges[first + 1])) return HUGE_VAL;
    if (!normal_of(b, t0, n0) || !normal_of(b, t1, n1)) return HUGE_VAL;
    if (!plane_continues(n0, n1, TOLERANCE_SAME_PLANE_CAGE)) return HUGE_VAL;
    cage_quad_corners(b, first, corners);
    return corner_cost(b, corners, n0) * (t1 == t0 + 1 ? CAGE_NEIGHBOUR : 1.0);
}

static int compare_candidates(const void *left, const void *right) {
    const quad_candidate *a = left, *b = right;
    if (a->cost != b->cost) return a->cost < b->cost ? -1 : 1;
    return a->first < b->first ? -1 : a->first > b->first;
}

/* Greedy: the most rectangular first. A largest matching would find more quads, but not more of the true ones. */
hemi_result cage_pair_triangles(cage_builder *b) {
    size_t edge_count = b->corner_count, count = 0;
    quad_candidate *candidates = hemi_allocate(b->out->memory, edge_count / 2 * sizeof *candidates + 1);
    if (!candidates) return cage_out_of_memory(b);
    for (size_t i = 0; i + 1 < edge_count; i++) {
        if (!cage_same_edge(&b->edges[i], &b->edges[i + 1])) continue;
        double cost = pair_cost(b, i);
        if (cost < HUGE_VAL) candidates[count++] = (quad_candidate){ cost, i };
    }
    qsort(candidates, count, sizeof *candidates, compare_candidates);
    for (size_t i = 0; i < count; i++) {
        size_t first = candidates[i].first;
        uint32_t t0 = b->edges[first].face, t1 = b->edges[first + 1].face;
        if (b->partners[t0] != SIZE_MAX || b->partners[t1] != SIZE_MAX) continue;
        b->partners[t0] = b->partners[t1] = first;
        b->out->quad_count++;
    }
    hemi_deallocate(b->out->memory, candidates);
    return HEMI_OK;
}
