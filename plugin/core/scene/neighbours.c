/* SPDX-License-Identifier: MIT
 * See neighbours.h.
 */
#include "scene/neighbours.h"

#include "base/block.h"

#include <stdlib.h>
#include <string.h>

typedef struct edge {
    double low[3], high[3]; /* ends, the lesser first */
    uint32_t place;         /* 4 surface + corner */
    bool back;              /* runs from high to low */
} edge;

/* More edges than this in one place are no surface. */
enum { SHEETS_MAX = 8 };

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
    edge e = { .place = 4 * surface_index + (uint32_t)k, .back = swap };
    memcpy(e.low, swap ? b : a, sizeof e.low);
    memcpy(e.high, swap ? a : b, sizeof e.high);
    return e;
}

/* All edges, those in one place together; NULL when out of memory. */
static edge *sorted_edges(const scene *s, size_t *count) {
    edge *edges = block_new(s->memory, (4 * s->surface_count + 1) * sizeof *edges);
    *count = 0;
    if (!edges) return NULL;
    for (uint32_t i = 0; i < s->surface_count; i++)
        for (int k = 0; k < surface_corner_count(&s->surfaces[i]); k++) edges[(*count)++] = edge_of(s, i, k);
    qsort(edges, *count, sizeof *edges, compare_edges);
    return edges;
}

static size_t end_of_place(const edge *edges, size_t count, size_t first) {
    size_t end = first + 1;
    while (end < count && compare_ends(&edges[first], &edges[end]) == 0) end++;
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
            neighbours[edges[i].place] = edges[i + 1 < end ? i + 1 : first].place / 4;
    }
    block_free(edges);
    return true;
}

static bool goes_on(const scene *s, const edge *a, const edge *b) {
    return a->back != b->back && vec3_dot(s->surfaces[a->place / 4].normal, s->surfaces[b->place / 4].normal) > 0.0;
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
            for (size_t j = first; j < end; j++)
                if (goes_on(s, &edges[i], &edges[j])) mates[edges[i].place] = edges[j].place, found++;
            if (found != 1) mates[edges[i].place] = NO_INDEX;
        }
    }
    for (uint32_t e = 0; e < 4 * s->surface_count; e++)
        if (mates[e] != NO_INDEX && mates[mates[e]] != e) mates[e] = NO_INDEX;
    block_free(edges);
    return true;
}
