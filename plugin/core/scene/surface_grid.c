/* SPDX-License-Identifier: MIT */
#include "scene/surface_grid.h"

#include "geometry/vec3.h"

surface_grid *surface_grid_create(allocator *memory, uint32_t columns, uint32_t rows) {
    surface_grid *g = block_zeroed(memory, 1, sizeof *g);
    if (!g) return NULL;
    g->column_count = columns, g->row_count = rows;
    g->columns = block_new(memory, ((size_t)columns + 1) * sizeof *g->columns);
    g->rows = block_new(memory, ((size_t)rows + 1) * sizeof *g->rows);
    g->triangles = block_new(memory, 2 * (size_t)columns * rows * sizeof *g->triangles);
    if (g->columns && g->rows && g->triangles) return g;
    surface_grids_free(g);
    return NULL;
}

void surface_grids_free(surface_grid *first) {
    for (surface_grid *next; first; first = next) {
        next = first->next;
        block_free_all(first->columns, first->rows, first->triangles, first);
    }
}

/* The last that begins before a share. */
static uint32_t find(const double *begins, uint32_t count, double share) {
    uint32_t low = 0, high = count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        *(begins[middle] <= share ? &low : &high) = middle;
    }
    return low;
}

const uint32_t *surface_grid_triangles(const surface_grid *g, const double place[3]) {
    double from[3];
    vec3_sub(from, place, g->origin);
    double aa = vec3_dot(g->across, g->across), ab = vec3_dot(g->across, g->along), bb = vec3_dot(g->along, g->along),
           a = vec3_dot(from, g->across), b = vec3_dot(from, g->along), d = aa * bb - ab * ab;
    size_t column = find(g->columns, g->column_count, (a * bb - b * ab) / d),
           row = find(g->rows, g->row_count, (b * aa - a * ab) / d);
    return g->triangles + 2 * (row * g->column_count + column);
}
