/* SPDX-License-Identifier: MIT
 * See surface_items.h.
 */
#include "visibility/surface_items.h"

#include "base/tolerance.h"

#include <string.h>

/* The vertices that surfaces use, numbered densely and relative to the centre: elements have many more. */
static bool set_positions(const scene *s, uint32_t *dense, arena *memory, item_geometry *out) {
    uint32_t count = 0;
    for (size_t v = 0; v < s->vertex_count; v++) dense[v] = NO_INDEX;
    for (size_t i = 0; i < s->surface_count; i++)
        for (int k = 0; k < surface_corner_count(&s->surfaces[i]); k++) {
            uint32_t *at = &dense[s->surfaces[i].corner[k]];
            if (*at == NO_INDEX) *at = count++;
        }
    float *positions = arena_alloc(memory, 3 * (size_t)count, sizeof *positions);
    if (!positions) return false;
    for (size_t v = 0; v < s->vertex_count; v++)
        for (int k = 0; dense[v] != NO_INDEX && k < 3; k++)
            positions[3 * (size_t)dense[v] + k] = (float)(s->vertices[3 * v + k] - s->center[k]);
    out->positions = positions;
    out->vertex_count = count;
    return true;
}

static bool set_holes(const scene *s, const uint32_t *surface_of, arena *memory, item_geometry *out) {
    if (!s->tree) return true;
    float *coordinates = arena_alloc(memory, 3 * out->vertex_count, sizeof *coordinates);
    const alpha_mask_map **holes = arena_alloc(memory, out->triangle_count, sizeof *holes);
    if (!coordinates || !holes) return false;
    memset(coordinates, 0, 3 * out->vertex_count * sizeof *coordinates);
    for (size_t t = 0; t < out->triangle_count; t++) {
        const surface *f = &s->surfaces[surface_of[t]];
        int second = t > 0 && surface_of[t] == surface_of[t - 1]; /* of a quad's two */
        const int corner[3] = { 0, 1 + second, 2 + second };
        holes[t] = f->holes ? f->holes->map : NULL;
        for (int k = 0; f->holes && k < 3; k++) {
            double place[3];
            float *at = coordinates + 3 * (size_t)out->indices[3 * t + (size_t)k];
            alpha_mask_place(f->holes, scene_vertex(s, f->corner[corner[k]]), place);
            for (int i = 0; i < 3; i++) at[i] = (float)place[i];
        }
    }
    out->coordinates = coordinates;
    out->holes = holes;
    return true;
}

static void set_triangles(const scene *s, const uint32_t *dense, uint32_t *indices, uint32_t *surface_of,
                          item_geometry *out) {
    size_t count = 0;
    for (size_t i = 0; i < s->surface_count; i++) {
        const surface *f = &s->surfaces[i];
        if (f->twin < i) continue;
        for (int k = 1; k + 1 < surface_corner_count(f); k++) {
            surface_of[count] = (uint32_t)i;
            indices[3 * count] = dense[f->corner[0]];
            indices[3 * count + 1] = dense[f->corner[k]];
            indices[3 * count + 2] = dense[f->corner[k + 1]];
            count++;
        }
    }
    out->indices = indices;
    out->triangle_count = count;
}

bool surface_items_create(const scene *s, arena *memory, item_geometry *out, uint32_t **surface_of) {
    uint32_t *dense = block_new(s->memory, (s->vertex_count + 1) * sizeof *dense);
    uint32_t *indices = arena_alloc(memory, 6 * s->surface_count, sizeof *indices);
    *surface_of = arena_alloc(memory, 2 * s->surface_count, sizeof **surface_of);
    bool ok = dense && indices && *surface_of && set_positions(s, dense, memory, out);
    if (ok) set_triangles(s, dense, indices, *surface_of, out);
    block_free(dense);
    out->near_plane = (float)(TOLERANCE_NEAR_PLANE * s->radius);
    return ok && set_holes(s, *surface_of, memory, out);
}
