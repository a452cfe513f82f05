/* SPDX-License-Identifier: MIT */
#include "scene/surface_edges.h"

#include <stdlib.h>

static int compare_edges(const void *a, const void *b) {
    const surface_edge *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->corner > y->corner) - (x->corner < y->corner);
}

surface_edge *surface_edges_sorted(const scene *s, const uint32_t *places, bool fronts_only, size_t *count) {
    surface_edge *edges = block_new(s->memory, (4 * s->surface_count + 1) * sizeof *edges);
    *count = 0;
    for (uint32_t i = 0; edges && i < s->surface_count; i++) {
        const surface *f = &s->surfaces[i];
        int corners = surface_corner_count(f);
        if (fronts_only && surface_sheet(s, i) != i) continue;
        for (int k = 0; k < corners; k++) {
            uint32_t a = places[f->corner[k]], b = places[f->corner[(k + 1) % corners]];
            edges[(*count)++] = (surface_edge){ a < b ? a : b, a < b ? b : a, 4 * i + (uint32_t)k, a > b };
        }
    }
    if (edges) qsort(edges, *count, sizeof *edges, compare_edges);
    return edges;
}

size_t surface_edges_end_of_place(const surface_edge *edges, size_t count, size_t first) {
    size_t end = first + 1;
    while (end < count && edges[first].low == edges[end].low && edges[first].high == edges[end].high) end++;
    return end;
}
