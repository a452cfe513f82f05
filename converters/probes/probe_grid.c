/* SPDX-License-Identifier: MIT
 * Which probes may lie on a triangle? Cells sorted by counting, in index order, so that the same probes always give
 * the same grid. */
#include "probe_grid.h"

#include <math.h>
#include <stdlib.h>

/* Probes lie on surfaces, so most cells of a grid are empty; with four cells a probe the occupied ones hold about one
 * (6,000 probes on the walls of a cube: 29^3 cells, about 5,000 of them on the walls). */
#define CELLS_PER_PROBE 4.0

static void bounds(const probe_set *set, double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) low[k] = high[k] = set->probes[0].position[k];
    for (size_t i = 1; i < set->count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], set->probes[i].position[k]);
            high[k] = fmax(high[k], set->probes[i].position[k]);
        }
}

/* The edge of a cubic cell such that the box holds about `wanted` of them. An axis thinner than a cell has one. */
static double cell_edge(const double extent[3], double wanted) {
    double longest = fmax(extent[0], fmax(extent[1], extent[2]));
    double smallest = longest / wanted, largest = longest;
    for (int step = 0; step < 60 && largest > 0.0; step++) {
        double middle = 0.5 * (smallest + largest), cells = 1.0;
        for (int k = 0; k < 3; k++) cells *= floor(extent[k] / middle) + 1.0;
        if (cells > wanted)
            smallest = middle;
        else
            largest = middle;
    }
    return largest > 0.0 ? largest : 1.0;
}

static uint32_t coordinate(const probe_grid *grid, double x, int axis) {
    double cell = floor((x - grid->low[axis]) / grid->cell_size);
    return (uint32_t)fmin(fmax(cell, 0.0), grid->cells[axis] - 1.0);
}

static size_t cell_of(const probe_grid *grid, const probe *p) {
    return probe_grid_index(grid, coordinate(grid, p->position[0], 0), coordinate(grid, p->position[1], 1),
                            coordinate(grid, p->position[2], 2));
}

/* Counting sort; on return starts[c] is where cell c begins. */
static void sort_members(probe_grid *grid, const probe_set *set, size_t cell_count) {
    for (size_t i = 0; i < set->count; i++) grid->starts[cell_of(grid, &set->probes[i]) + 1]++;
    for (size_t c = 0; c < cell_count; c++) grid->starts[c + 1] += grid->starts[c];
    for (size_t i = set->count; i-- > 0;) {
        size_t next = cell_of(grid, &set->probes[i]) + 1;
        grid->members[--grid->starts[next]] = (uint32_t)i;
    }
    for (size_t c = 0; c < cell_count; c++) grid->starts[c] = grid->starts[c + 1];
    grid->starts[cell_count] = (uint32_t)set->count;
}

hemi_result probe_grid_create(const probe_set *set, probe_grid *out) {
    double high[3], extent[3];
    size_t cell_count = 1;
    *out = (probe_grid){ 0 };
    bounds(set, out->low, high);
    for (int k = 0; k < 3; k++) extent[k] = high[k] - out->low[k];
    out->cell_size = cell_edge(extent, CELLS_PER_PROBE * (double)set->count);
    for (int k = 0; k < 3; k++) {
        out->cells[k] = (uint32_t)floor(extent[k] / out->cell_size) + 1;
        cell_count *= out->cells[k];
    }
    out->starts = calloc(cell_count + 1, sizeof *out->starts);
    out->members = malloc(set->count * sizeof *out->members);
    if (!out->starts || !out->members) {
        probe_grid_destroy(out);
        return HEMI_ERROR_MEMORY;
    }
    sort_members(out, set, cell_count);
    return HEMI_OK;
}

void probe_grid_destroy(probe_grid *grid) {
    free(grid->starts);
    free(grid->members);
    *grid = (probe_grid){ 0 };
}

bool probe_grid_cells(const probe_grid *grid, const double low[3], const double high[3], probe_cells *out) {
    for (int k = 0; k < 3; k++) {
        double end = grid->low[k] + grid->cell_size * grid->cells[k];
        if (high[k] < grid->low[k] || low[k] > end) return false;
        out->first[k] = coordinate(grid, low[k], k);
        out->last[k] = coordinate(grid, high[k], k);
    }
    return true;
}
