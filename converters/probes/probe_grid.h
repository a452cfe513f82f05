/* SPDX-License-Identifier: MIT
 * Which probes may lie on a triangle?
 *
 * A uniform grid over the probes. Thousands of probes meet millions of triangles, so the grid is laid over the small
 * side: the triangles stream past once and cost no memory.
 */
#ifndef HEMIBAKE_PROBES_PROBE_GRID_H
#define HEMIBAKE_PROBES_PROBE_GRID_H

#include "probes.h"

typedef struct probe_grid {
    double low[3], cell_size; /* world, metres; cells are cubes */
    uint32_t cells[3];        /* along each axis */
    uint32_t *starts;         /* probes of cell c: members[starts[c]] up to members[starts[c+1]] */
    uint32_t *members;        /* probe indices, ascending within a cell */
} probe_grid;

/* Cells starts[z][y][x] that a box meets, bounds included. */
typedef struct probe_cells {
    uint32_t first[3], last[3];
} probe_cells;

hemi_result probe_grid_create(const probe_set *set, probe_grid *out);
void probe_grid_destroy(probe_grid *grid);

/* False: the box meets no cell. */
bool probe_grid_cells(const probe_grid *grid, const double low[3], const double high[3], probe_cells *out);

static inline size_t probe_grid_index(const probe_grid *grid, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * grid->cells[1] + y) * grid->cells[0] + x;
}

#endif
