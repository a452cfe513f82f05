/* SPDX-License-Identifier: MIT
 * Which edges have a vertex of another triangle in their middle? Only edges of one triangle can (elsewhere surfaces
 * close), and only against the ends of such edges: those are sorted into the cells of a grid, and each edge looks into
 * the cells along it.
 */
#include "internal.h"

#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>

/* Of a mesh that would ask for more comparisons the edges looked at so far are counted. */
static const uint64_t COMPARISONS_MAX = UINT64_C(100000000);

typedef struct end {
    uint64_t cell;
    double at[3];
} end;

typedef struct grid {
    end *ends; /* two to an open edge: ends[2*i] and ends[2*i+1] before they are sorted */
    end *sorted;
    size_t count;
    double cell_size, near;
    uint64_t comparisons;
} grid;

static uint64_t cell_of(const grid *g, const double at[3], int dx, int dy, int dz) {
    const int step[3] = { dx, dy, dz };
    uint64_t h = 0x243f6a8885a308d3u;
    for (int k = 0; k < 3; k++) {
        int64_t i = (int64_t)floor(at[k] / g->cell_size) + step[k];
        h = (h ^ (uint64_t)i) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    return h;
}

static int compare(const void *a, const void *b) {
    const end *x = a, *y = b;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

static bool lies_between(const grid *g, const double a[3], const double b[3], const double p[3]) {
    double length = vec3_distance(a, b), t = 0.0, edge[3], foot[3];
    if (vec3_distance(a, p) <= g->near || vec3_distance(b, p) <= g->near) return false;
    vec3_sub(edge, b, a);
    for (int k = 0; k < 3; k++) t += (p[k] - a[k]) * edge[k] / (length * length);
    vec3_add_scaled(foot, a, t, edge);
    return t > 0.0 && t < 1.0 && vec3_distance(foot, p) <= g->near;
}

static bool any_in_cell(grid *g, uint64_t cell, const double a[3], const double b[3]) {
    size_t low = 0, high = g->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (g->sorted[middle].cell < cell)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < g->count && g->sorted[low].cell == cell; low++, g->comparisons++)
        if (lies_between(g, a, b, g->sorted[low].at)) return true;
    return false;
}

static bool has_vertex_inside(grid *g, const double a[3], const double b[3]) {
    int steps = (int)fmin(ceil(vec3_distance(a, b) / g->cell_size), 1e6);
    for (int i = 0; i <= steps && g->comparisons < COMPARISONS_MAX; i++) {
        double at[3];
        for (int k = 0; k < 3; k++) at[k] = a[k] + (steps ? (double)i / steps : 0.0) * (b[k] - a[k]);
        for (int c = 0; c < 27; c++, g->comparisons++)
            if (any_in_cell(g, cell_of(g, at, c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1), a, b)) return true;
    }
    return false;
}

/* Ends of the edges that one triangle has. */
static bool list_open(builder *b, const double *normals, grid *g) {
    double largest = 0.0, length = 0.0;
    for (size_t c = 0; c < 3 * (size_t)b->mesh->triangle_count; c++) {
        const double *n = normals + 3 * (c / 3);
        uint32_t p = b->mesh->indices[c], q = b->mesh->indices[c % 3 == 2 ? c - 2 : c + 1];
        uint64_t high, low = pair_order(b->place[p], b->place[q], &high);
        if (vec3_is_zero(n)) continue;
        uint32_t *uses = pair_map_at(&b->edges, low, high, 0);
        if (!uses) return false;
        if (*uses != 1) continue;
        end *ends = g->ends + g->count;
        hemi_transform_point(b->mesh->transform, b->mesh->positions + 3 * (size_t)p, ends[0].at);
        hemi_transform_point(b->mesh->transform, b->mesh->positions + 3 * (size_t)q, ends[1].at);
        for (int k = 0; k < 3; k++) largest = fmax(largest, fmax(fabs(ends[0].at[k]), fabs(ends[1].at[k])));
        length += vec3_distance(ends[0].at, ends[1].at);
        g->count += 2;
    }
    g->near = TOLERANCE_OVERLAP * largest;
    g->cell_size = g->count ? fmax(2.0 * length / (double)g->count, 4.0 * g->near) : 1.0;
    return true;
}

hemi_result t_junctions_count(builder *b, const double *normals) {
    size_t most = 6 * (size_t)b->mesh->triangle_count + 1;
    grid g = { .ends = block_new(b->desc->memory, most * sizeof *g.ends) };
    bool ok = g.ends && list_open(b, normals, &g);
    g.sorted = block_new(b->desc->memory, (g.count + 1) * sizeof *g.sorted);
    ok = ok && g.sorted;
    for (size_t i = 0; ok && i < g.count; i++) {
        g.sorted[i] = g.ends[i];
        g.sorted[i].cell = cell_of(&g, g.ends[i].at, 0, 0, 0);
    }
    if (ok) qsort(g.sorted, g.count, sizeof *g.sorted, compare);
    for (size_t i = 0; ok && i < g.count && g.comparisons < COMPARISONS_MAX; i += 2)
        b->out->check.junction_count += has_vertex_inside(&g, g.ends[i].at, g.ends[i + 1].at);
    block_free(g.ends);
    block_free(g.sorted);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
