/* SPDX-License-Identifier: MIT
 * See flat_sides.h.
 */
#include "scene/flat_sides.h"

#include "base/union_find.h"
#include "scene/surface_edges.h"

#include <string.h>

/* Does the other surface at the edge go on where this one ends? Its middle lies beyond the edge. */
static bool continues_flat(const scene *s, const surface_edge *x, const surface_edge *y) {
    const surface *f = &s->surfaces[x->corner / 4], *g = &s->surfaces[y->corner / 4];
    if (fabs(vec3_dot(f->normal, g->normal)) < FLAT_SIDES_PARALLEL) return false;
    return vec3_dot(f->normal, g->normal) > 0.0 ? x->back != y->back : x->back == y->back;
}

/* How far the surface reaches in front of another's plane, or, where that is more, behind it: below 0. */
static double reach_over(const scene *s, const surface *over, const surface *f) {
    double most = 0.0;
    for (int k = 0; k < surface_corner_count(f); k++) {
        double height = surface_height(over, scene_vertex(s, f->corner[k]));
        if (fabs(height) > fabs(most)) most = height;
    }
    return most;
}

/* The edges in one place: where surfaces go on, and what adjoins those that do not. */
static void look_at(const scene *s, const surface_edge *edges, size_t count, flat_sides *out) {
    for (size_t i = 0; i < count; i++) {
        uint32_t own = edges[i].corner / 4;
        bool ends = true, behind = false, before = false;
        for (size_t k = 0; k < count; k++) {
            uint32_t other = edges[k].corner / 4;
            if (k == i) continue;
            if (continues_flat(s, &edges[i], &edges[k])) {
                ends = false;
                if (vec3_dot(s->surfaces[own].normal, s->surfaces[other].normal) > 0.0)
                    union_find_join(out->side, own, other);
                continue;
            }
            double reach = reach_over(s, &s->surfaces[own], &s->surfaces[other]);
            behind |= reach<0.0, before |= reach> 0.0;
        }
        out->ends[edges[i].corner] = ends;
        if (ends) out->open[0][own] |= !behind, out->open[1][own] |= !before;
    }
}

static double edge_length(const scene *s, const surface *f, uint32_t k, uint32_t count) {
    return vec3_distance(scene_vertex(s, f->corner[k]), scene_vertex(s, f->corner[(k + 1) % count]));
}

/* What holds of surfaces holds of their sides. */
static void gather(const scene *s, flat_sides *out) {
    for (uint32_t i = 0; i < s->surface_count; i++) {
        uint32_t first = out->side[i] = union_find_root(out->side, i);
        out->area[first] += s->surfaces[i].area;
        for (int b = 0; b < 2; b++) out->open[b][first] |= out->open[b][i];
        for (uint32_t k = 0, n = (uint32_t)surface_corner_count(&s->surfaces[i]); k < n; k++)
            if (out->ends[4 * i + k]) out->outline[first] += edge_length(s, &s->surfaces[i], k, n);
    }
}

bool flat_sides_find(const scene *s, const uint32_t *places, flat_sides *out) {
    size_t surfaces = s->surface_count + 1, count;
    surface_edge *edges = surface_edges_sorted(s, places, true, &count);
    *out = (flat_sides){ .ends = block_zeroed(s->memory, 4 * surfaces, sizeof *out->ends),
                         .side = block_new(s->memory, surfaces * sizeof *out->side),
                         .area = block_zeroed(s->memory, surfaces, sizeof *out->area),
                         .outline = block_zeroed(s->memory, surfaces, sizeof *out->outline),
                         .open = { block_zeroed(s->memory, surfaces, sizeof(bool)),
                                   block_zeroed(s->memory, surfaces, sizeof(bool)) } };
    bool ok = edges && out->ends && out->side && out->area && out->outline && out->open[0] && out->open[1];
    for (uint32_t i = 0; ok && i < s->surface_count; i++) out->side[i] = i;
    for (size_t first = 0, end; ok && first < count; first = end) {
        end = surface_edges_end_of_place(edges, count, first);
        look_at(s, edges + first, end - first, out);
    }
    if (ok) gather(s, out);
    block_free(edges);
    return ok;
}

void flat_sides_free(flat_sides *f) {
    block_free_all(f->ends, f->side, f->area, f->outline, f->open[0], f->open[1]);
    memset(f, 0, sizeof *f);
}
