/* SPDX-License-Identifier: MIT
 * Which edges of surfaces lie in one place? Those whose two ends do, whatever their vertices are called.
 */
#ifndef HEMIBAKE_CORE_SCENE_SURFACE_EDGES_H
#define HEMIBAKE_CORE_SCENE_SURFACE_EDGES_H

#include "scene/scene.h"

typedef struct surface_edge {
    uint32_t low, high; /* places of its ends, the lesser first */
    uint32_t corner;    /* 4 surface + the corner that it leaves */
    bool back;          /* runs from high to low */
} surface_edge;

/* The edges of all surfaces, or of the fronts of sheets alone, those in one place together; NULL when out of memory.
 * places: as from scene_find_places. A block. */
surface_edge *surface_edges_sorted(const scene *s, const uint32_t *places, bool fronts_only, size_t *count);

/* The first edge after those that lie where this one does. */
size_t surface_edges_end_of_place(const surface_edge *edges, size_t count, size_t first);

#endif
