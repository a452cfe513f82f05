/* SPDX-License-Identifier: MIT
 * Which surfaces share an edge? An edge whose two ends lie exactly where those of another surface's edge do joins the
 * two, whatever their vertices are called: hard edges have vertices of their own on each side.
 */
#include "scene/surface_edges.h"

/* More edges than this in one place are no surface. */
enum { SHEETS_MAX = 8 };

/* NULL when out of memory. */
static surface_edge *all_edges(const scene *s, size_t *count) {
    uint32_t place_count, *places = scene_find_places(s, &place_count);
    surface_edge *edges = places ? surface_edges_sorted(s, places, false, count) : NULL;
    block_free(places);
    return edges;
}

bool scene_find_neighbours(const scene *s, uint32_t *neighbours) {
    size_t count;
    surface_edge *edges = all_edges(s, &count);
    if (!edges) return false;
    for (size_t i = 0; i < 4 * s->surface_count; i++) neighbours[i] = NO_INDEX;
    for (size_t first = 0, end; first < count; first = end) {
        end = surface_edges_end_of_place(edges, count, first);
        for (size_t i = first; end - first > 1 && i < end; i++)
            neighbours[edges[i].corner] = edges[i + 1 < end ? i + 1 : first].corner / 4;
    }
    block_free(edges);
    return true;
}

bool scene_find_mates(const scene *s, uint32_t *mates) {
    size_t count;
    surface_edge *edges = all_edges(s, &count);
    if (!edges) return false;
    for (size_t i = 0; i < 4 * s->surface_count; i++) mates[i] = NO_INDEX;
    for (size_t first = 0, end; first < count; first = end) {
        end = surface_edges_end_of_place(edges, count, first);
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
