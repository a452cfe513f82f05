/* SPDX-License-Identifier: MIT
 * Which surfaces share an edge? An edge whose two ends lie exactly where those of another surface's edge do joins the
 * two, whatever their vertices are called: hard edges have vertices of their own on each side.
 */
#include "scene/scene.h"

#include <stdlib.h>

typedef struct edge {
    uint32_t low, high; /* places of its ends, the lesser first */
    uint32_t corner;    /* 4 surface + the corner that it leaves */
    bool back;          /* runs from high to low */
} edge;

/* More edges than this in one place are no surface. */
enum { SHEETS_MAX = 8 };

static int compare_edges(const void *a, const void *b) {
    const edge *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->corner > y->corner) - (x->corner < y->corner);
}

/* All edges, those in one place together; NULL when out of memory. */
static edge *sorted_edges(const scene *s, size_t *count) {
    uint32_t place_count, *place = scene_find_places(s, &place_count);
    edge *edges = place ? block_new(s->memory, (4 * s->surface_count + 1) * sizeof *edges) : NULL;
    *count = 0;
    for (uint32_t i = 0; edges && i < s->surface_count; i++) {
        const surface *f = &s->surfaces[i];
        for (int k = 0; k < surface_corner_count(f); k++) {
            uint32_t a = place[f->corner[k]], b = place[f->corner[(k + 1) % surface_corner_count(f)]];
            edges[(*count)++] = (edge){ a < b ? a : b, a < b ? b : a, 4 * i + (uint32_t)k, a > b };
        }
    }
    if (edges) qsort(edges, *count, sizeof *edges, compare_edges);
    block_free(place);
    return edges;
}

static size_t end_of_place(const edge *edges, size_t count, size_t first) {
    size_t end = first + 1;
    while (end < count && edges[first].low == edges[end].low && edges[first].high == edges[end].high) end++;
    return end;
}

bool scene_find_neighbours(const scene *s, uint32_t *neighbours) {
    size_t count;
    edge *edges = sorted_edges(s, &count);
    if (!edges) return false;
    for (size_t i = 0; i < 4 * s->surface_count; i++) neighbours[i] = NO_INDEX;
    for (size_t first = 0, end; first < count; first = end) {
        end = end_of_place(edges, count, first);
        for (size_t i = first; end - first > 1 && i < end; i++)
            neighbours[edges[i].corner] = edges[i + 1 < end ? i + 1 : first].corner / 4;
    }
    block_free(edges);
    return true;
}

bool scene_find_mates(const scene *s, uint32_t *mates) {
    size_t count;
    edge *edges = sorted_edges(s, &count);
    if (!edges) return false;
    for (size_t i = 0; i < 4 * s->surface_count; i++) mates[i] = NO_INDEX;
    for (size_t first = 0, end; first < count; first = end) {
        end = end_of_place(edges, count, first);
        for (size_t i = first; end - first <= SHEETS_MAX && i < end; i++) {
            size_t found = 0;
            const double *normal = s->surfaces[edges[i].corner / 4].normal;
            for (size_t j = first; j < end; j++)
                if (edges[i].back != edges[j].back && vec3_dot(normal, s->surfaces[edges[j].corner / 4].normal) > 0.0)
                    mates[edges[i].corner] = edges[j].corner, found++;
            if (found != 1) mates[edges[i].corner] = NO_INDEX;
        }
    }
    for (uint32_t e = 0; e < 4 * s->surface_count; e++)
        if (mates[e] != NO_INDEX && mates[mates[e]] != e) mates[e] = NO_INDEX;
    block_free(edges);
    return true;
}
