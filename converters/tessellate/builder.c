/* SPDX-License-Identifier: MIT
 * How do the arrays of a tessellation grow? By doubling, the four arrays of its vertices together.
 */
#include "internal.h"

#include <string.h>

bool builder_grow(const builder *b, void **array, size_t *capacity, size_t count, size_t size) {
    if (count < *capacity) return true;
    size_t more = *capacity ? 2 * *capacity : 64;
    void *grown = hemi_reallocate(b->desc->memory, *array, more * size);
    if (!grown) return false;
    *array = grown;
    *capacity = more;
    return true;
}

/* The four vertex arrays grow together. */
static bool grow_vertices(builder *b) {
    tessellation *out = b->out;
    size_t capacity[4] = { b->vertex_capacity, b->vertex_capacity, b->vertex_capacity, b->vertex_capacity };
    bool ok = builder_grow(b, (void **)&out->positions, &capacity[0], out->vertex_count, 3 * sizeof *out->positions) &&
              builder_grow(b, (void **)&out->nodes, &capacity[1], out->vertex_count, sizeof *out->nodes) &&
              builder_grow(b, (void **)&out->source_triangles, &capacity[2], out->vertex_count,
                           sizeof *out->source_triangles) &&
              builder_grow(b, (void **)&out->source_weights, &capacity[3], out->vertex_count,
                           3 * sizeof *out->source_weights);
    if (ok) b->vertex_capacity = capacity[0];
    return ok;
}

uint32_t builder_add_vertex(builder *b, const double position[3], uint32_t node) {
    tessellation *out = b->out;
    if (out->vertex_count == TESSELLATE_NONE || !grow_vertices(b)) return TESSELLATE_NONE;
    uint32_t v = out->vertex_count++;
    memcpy(out->positions + 3 * (size_t)v, position, 3 * sizeof *position);
    out->nodes[v] = node;
    out->source_triangles[v] = 0;
    memset(out->source_weights + 3 * (size_t)v, 0, 3 * sizeof(float));
    return v;
}
