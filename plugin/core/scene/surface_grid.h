/* SPDX-License-Identifier: MIT
 * Which triangles of the input lie where on a surface that was a grid of many? The grid is a parallelogram of columns
 * and rows, each cell of it two triangles, and all that the input says of its vertices is affine over it.
 */
#ifndef HEMIBAKE_CORE_SCENE_SURFACE_GRID_H
#define HEMIBAKE_CORE_SCENE_SURFACE_GRID_H

#include "base/block.h"

#include <stdint.h>

typedef struct surface_grid {
    struct surface_grid *next;             /* of the scene */
    double origin[3], across[3], along[3]; /* a corner, and its edges, in the mesh's own frame */
    uint32_t column_count, row_count;
    double *columns, *rows; /* where each begins, as a share of the edge, and 1 */
    uint32_t *triangles;    /* triangles[2*(row*column_count+column)+i], of the mesh */
} surface_grid;

/* With room for so many cells, of which nothing is set; NULL when out of memory. */
surface_grid *surface_grid_create(allocator *memory, uint32_t columns, uint32_t rows);

/* Those of a list. */
void surface_grids_free(surface_grid *first);

/* The two triangles of the cell that is nearest to a place in the mesh's own frame. */
const uint32_t *surface_grid_triangles(const surface_grid *g, const double place[3]);

#endif
