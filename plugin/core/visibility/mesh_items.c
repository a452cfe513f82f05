/* SPDX-License-Identifier: MIT
 * See mesh_items.h.
 */
#include "visibility/mesh_items.h"

#include <string.h>

static const uint32_t *corners_of(const mesh *m, mesh_pieces pieces, size_t i) {
    return pieces == MESH_PATCHES ? m->patches[i].corner : m->elements[i].corner;
}

static uint32_t patch_of(const mesh *m, mesh_pieces pieces, size_t i) {
    return pieces == MESH_PATCHES ? (uint32_t)i : m->elements[i].patch;
}

/* The two sides of a sheet are cut alike, so a piece has the place among its surface's pieces that its twin has. */
static void find_twins(const scene *s, const mesh *m, mesh_pieces pieces, size_t count, uint32_t *first,
                       mesh_items *out) {
    for (size_t f = 0; f < s->surface_count; f++) first[f] = NO_INDEX;
    for (size_t i = 0; i < count; i++) {
        out->surface[i] = m->patches[patch_of(m, pieces, i)].surface;
        if (first[out->surface[i]] == NO_INDEX) first[out->surface[i]] = (uint32_t)i;
    }
    for (size_t i = 0; i < count; i++) {
        uint32_t other = s->surfaces[out->surface[i]].twin;
        out->twin[i] = other == NO_INDEX ? NO_INDEX : first[other] + (uint32_t)i - first[out->surface[i]];
    }
}

static void add_triangles(const scene *s, const mesh *m, mesh_pieces pieces, size_t count, uint32_t *indices,
                          mesh_items *out) {
    size_t triangles = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *corner = corners_of(m, pieces, i);
        if (surface_sheet(s, out->surface[i]) != out->surface[i]) continue;
        for (int k = 1; k < (corner[3] == NO_INDEX ? 2 : 3); k++) {
            memcpy(indices + 3 * triangles, (uint32_t[]){ corner[0], corner[k], corner[k + 1] }, 3 * sizeof *indices);
            out->triangle_piece[triangles++] = (uint32_t)i;
        }
    }
    out->items.triangle_count = triangles;
}

static bool add_holes(const scene *s, const mesh *m, arena *memory, mesh_items *out) {
    size_t triangles = out->items.triangle_count;
    float *coordinates = arena_alloc(memory, 3 * m->vertex_count, sizeof *coordinates);
    const alpha_mask_map **holes = arena_alloc(memory, triangles, sizeof *holes);
    if (!coordinates || !holes) return false;
    memset(coordinates, 0, 3 * m->vertex_count * sizeof *coordinates);
    for (size_t t = 0; t < triangles; t++) {
        const alpha_mask *c = s->surfaces[out->surface[out->triangle_piece[t]]].holes;
        holes[t] = c ? c->map : NULL;
        for (int k = 0; c && k < 3; k++) {
            double place[3];
            uint32_t v = out->items.indices[3 * t + (size_t)k];
            alpha_mask_place(c, m->vertices + 3 * (size_t)v, place);
            for (int i = 0; i < 3; i++) coordinates[3 * (size_t)v + (size_t)i] = (float)place[i];
        }
    }
    out->items.coordinates = coordinates;
    out->items.holes = holes;
    return true;
}

bool mesh_items_create(const scene *s, const mesh *m, mesh_pieces pieces, float near_plane, arena *memory,
                       mesh_items *out) {
    size_t count = pieces == MESH_PATCHES ? m->patch_count : m->element_count;
    float *positions = arena_alloc(memory, 3 * m->vertex_count, sizeof *positions);
    uint32_t *indices = arena_alloc(memory, 6 * count, sizeof *indices);
    uint32_t *first = arena_alloc(memory, s->surface_count, sizeof *first);
    out->triangle_piece = arena_alloc(memory, 2 * count, sizeof *out->triangle_piece);
    out->surface = arena_alloc(memory, count, sizeof *out->surface);
    out->twin = arena_alloc(memory, count, sizeof *out->twin);
    if (!positions || !indices || !first || !out->triangle_piece || !out->surface || !out->twin) return false;
    for (size_t i = 0; i < 3 * m->vertex_count; i++) positions[i] = (float)(m->vertices[i] - s->center[i % 3]);
    out->items = (item_geometry){
        .positions = positions, .vertex_count = m->vertex_count, .indices = indices, .near_plane = near_plane
    };
    find_twins(s, m, pieces, count, first, out);
    add_triangles(s, m, pieces, count, indices, out);
    return !s->tree || add_holes(s, m, memory, out);
}
