/* SPDX-License-Identifier: MIT
 * See neighbors.h.
 */
#include "scene/neighbors.h"

#include "base/block.h"

#include <stdlib.h>
#include <string.h>

typedef struct edge {
    double low[3], high[3]; /* ends, the lesser first */
    uint32_t place;         /* 4 surface + corner */
} edge;

static int compare_points(const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_ends(const edge *a, const edge *b) {
    int order = compare_points(a->low, b->low);
    return order ? order : compare_points(a->high, b->high);
}

static int compare_edges(const void *a, const void *b) {
    const edge *x = a, *y = b;
    int order = compare_ends(x, y);
    return order ? order : (x->place > y->place) - (x->place < y->place);
}

static edge edge_of(const scene *s, uint32_t surface_index, int k) {
    const surface *f = &s->surfaces[surface_index];
    const double *a = scene_vertex(s, f->corner[k]), *b = scene_vertex(s, f->corner[(k + 1) % surface_corner_count(f)]);
    bool swap = compare_points(a, b) > 0;
    edge e = { .place = 4 * surface_index + (uint32_t)k };
    memcpy(e.low, swap ? b : a, sizeof e.low);
    memcpy(e.high, swap ? a : b, sizeof e.high);
    return e;
}

bool scene_find_neighbors(const scene *s, uint32_t *neighbors) {
    edge *edges = block_new(s->memory, (4 * s->surface_count + 1) * sizeof *edges);
    size_t count = 0;
    if (!edges) return false;
    for (uint32_t i = 0; i < s->surface_count; i++) {
        for (int k = 0; k < 4; k++) neighbors[4 * (size_t)i + (size_t)k] = NO_INDEX;
        for (int k = 0; k < surface_corner_count(&s->surfaces[i]); k++) edges[count++] = edge_of(s, i, k);
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && compare_ends(&edges[first], &edges[end]) == 0;) end++;
        for (size_t i = first; end - first > 1 && i < end; i++)
            neighbors[edges[i].place] = edges[i + 1 < end ? i + 1 : first].place / 4;
    }
    block_free(edges);
    return true;
}
