/* SPDX-License-Identifier: MIT */
#include "visibility/mesh_items.h"

#include "base/tolerance.h"
#include "scene/contact_lines.h"

/* The pieces of one kind. */
typedef struct listing {
    const scene *scene;
    const mesh *mesh;
    mesh_pieces pieces;
    size_t count;
    mesh_items *out;
} listing;

static size_t count_of(const scene *s, const mesh *m, mesh_pieces pieces) {
    if (pieces == MESH_SURFACES) return s->surface_count;
    return pieces == MESH_PATCHES ? m->patch_count : m->element_count;
}

static const uint32_t *corners_of(const listing *l, size_t i) {
    if (l->pieces == MESH_SURFACES) return l->scene->surfaces[i].corner;
    return l->pieces == MESH_PATCHES ? l->mesh->patches[i].corner : l->mesh->elements[i].corner;
}

static uint32_t surface_of(const listing *l, size_t i) {
    if (l->pieces == MESH_SURFACES) return (uint32_t)i;
    return l->mesh->patches[l->pieces == MESH_PATCHES ? i : l->mesh->elements[i].patch].surface;
}

/* The two sides of a sheet are divided alike, so a piece has the place among its surface's pieces that its twin has. */
static void find_twins(const listing *l, uint32_t *first) {
    mesh_items *out = l->out;
    for (size_t f = 0; f < l->scene->surface_count; f++) first[f] = NO_INDEX;
    for (size_t i = 0; i < l->count; i++) {
        out->surface[i] = surface_of(l, i);
        if (first[out->surface[i]] == NO_INDEX) first[out->surface[i]] = (uint32_t)i;
    }
    for (size_t i = 0; i < l->count; i++) {
        uint32_t other = l->scene->surfaces[out->surface[i]].twin;
        out->twin[i] = other == NO_INDEX ? NO_INDEX : first[other] + (uint32_t)i - first[out->surface[i]];
    }
}

/* Does all of a piece lie in another surface that is seen in its place? Of two triangles in one plane a ray may meet
 * either. Back to back with another front it is still there. */
static bool is_covered(const listing *l, size_t i) {
    if (l->pieces == MESH_SURFACES || l->scene->surfaces[l->out->surface[i]].twin != NO_INDEX) return false;
    return l->mesh->patches[l->pieces == MESH_PATCHES ? i : l->mesh->elements[i].patch].contact == CONTACT_COPY;
}

/* Triangles of the pieces that shine, or of the others, with the vertices that they use numbered densely: vertex[i] is
 * where item vertex i is in the mesh. */
static void add_some(const listing *l, bool shine, uint32_t *dense, uint32_t *vertex, uint32_t *indices) {
    mesh_items *out = l->out;
    for (size_t i = 0; i < l->count; i++) {
        const uint32_t *corner = corners_of(l, i);
        const surface *f = &l->scene->surfaces[out->surface[i]];
        if (surface_sheet(l->scene, out->surface[i]) != out->surface[i] || f->pane ||
            scene_emits(l->scene, f) != shine || is_covered(l, i))
            continue;
        for (int k = 1; k < (corner[3] == NO_INDEX ? 2 : 3); k++) {
            const uint32_t used[3] = { corner[0], corner[k], corner[k + 1] };
            for (int j = 0; j < 3; j++) {
                uint32_t *at = &dense[used[j]];
                if (*at == NO_INDEX) vertex[ *at = (uint32_t)out->items.vertex_count++] = used[j];
                indices[3 * out->items.triangle_count + (size_t)j] = *at;
            }
            out->triangle_piece[out->items.triangle_count++] = (uint32_t)i;
        }
    }
}

/* Of triangles in one plane the first is seen (scene_shows_before). */
static void add_triangles(const listing *l, uint32_t *dense, uint32_t *vertex, uint32_t *indices) {
    for (size_t v = 0; v < l->mesh->vertex_count; v++) dense[v] = NO_INDEX;
    add_some(l, true, dense, vertex, indices);
    add_some(l, false, dense, vertex, indices);
    l->out->items.indices = indices;
}

static bool set_positions(const listing *l, const uint32_t *vertex, arena *memory) {
    item_geometry *items = &l->out->items;
    float *positions = arena_alloc(memory, 3 * items->vertex_count, sizeof *positions);
    for (size_t i = 0; positions && i < 3 * items->vertex_count; i++)
        positions[i] = (float)(l->mesh->vertices[3 * (size_t)vertex[i / 3] + i % 3] - l->scene->center[i % 3]);
    items->positions = positions;
    return positions;
}

static bool set_holes(const listing *l, const uint32_t *vertex, arena *memory) {
    item_geometry *items = &l->out->items;
    float *coordinates = arena_alloc(memory, 3 * items->vertex_count, sizeof *coordinates);
    const alpha_mask_map **holes = arena_alloc(memory, items->triangle_count, sizeof *holes);
    if (!coordinates || !holes) return false;
    for (size_t t = 0; t < items->triangle_count; t++) {
        const alpha_mask *c = l->scene->surfaces[l->out->surface[l->out->triangle_piece[t]]].holes;
        holes[t] = c ? c->map : NULL;
        for (int k = 0; c && k < 3; k++) {
            double place[3];
            uint32_t i = items->indices[3 * t + (size_t)k];
            alpha_mask_place(c, l->mesh->vertices + 3 * (size_t)vertex[i], place);
            for (int j = 0; j < 3; j++) coordinates[3 * (size_t)i + (size_t)j] = (float)place[j];
        }
    }
    items->coordinates = coordinates;
    items->holes = holes;
    return true;
}

bool mesh_items_create(const scene *s, const mesh *m, mesh_pieces pieces, arena *memory, mesh_items *out) {
    const listing l = { s, m, pieces, count_of(s, m, pieces), out };
    uint32_t *first = block_new(m->memory, (s->surface_count + 1) * sizeof *first);
    uint32_t *dense = block_new(m->memory, (2 * m->vertex_count + 1) * sizeof *dense);
    uint32_t *indices = arena_alloc(memory, 6 * l.count, sizeof *indices);
    *out = (mesh_items){ .items.near_plane = (float)(TOLERANCE_NEAR_PLANE * s->radius),
                         .triangle_piece = arena_alloc(memory, 2 * l.count, sizeof *out->triangle_piece),
                         .surface = arena_alloc(memory, l.count, sizeof *out->surface),
                         .twin = arena_alloc(memory, l.count, sizeof *out->twin) };
    bool ok = first && dense && indices && out->triangle_piece && out->surface && out->twin;
    if (ok) {
        uint32_t *vertex = dense + m->vertex_count;
        find_twins(&l, first);
        add_triangles(&l, dense, vertex, indices);
        ok = set_positions(&l, vertex, memory) && (!s->tree || set_holes(&l, vertex, memory));
    }
    block_free_all(first, dense);
    return ok;
}
