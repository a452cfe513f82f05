/* SPDX-License-Identifier: MIT
 * Which vertices of a mesh are one? Many exporters give every triangle three vertices of its own, and what lies side by
 * side would not know of each other: then those are one that have the same position, normal and attributes, bit for
 * bit. A mesh of which any vertex is shared says itself which are.
 */
#include "internal.h"

#include "base/splitmix.h"

#include <string.h>

static uint64_t hash_of(const float *attributes, uint32_t count) {
    uint64_t hash = count;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t bits;
        memcpy(&bits, &attributes[k], sizeof bits);
        hash = splitmix(hash ^ bits);
    }
    return hash;
}

hemi_result same_vertices_find(builder *b, uint32_t place_count) {
    const hemi_mesh_desc *m = b->mesh;
    const uint32_t stride = m->attributes ? m->attribute_count : 0;
    if (place_count == m->vertex_count || m->vertex_count / 3 < m->triangle_count) return HEMI_OK;
    b->same = block_new(b->desc->memory, ((size_t)m->vertex_count + 1) * sizeof *b->same);
    if (!b->same) return HEMI_ERROR_MEMORY;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        const float *own = m->attributes + (size_t)stride * v;
        uint64_t at = (uint64_t)b->place[v] << 32 | (b->direction ? b->direction[v] : 0);
        uint32_t *first = pair_map_at(&b->edges, at, stride ? hash_of(own, stride) : 0, v);
        if (!first) return HEMI_ERROR_MEMORY;
        /* Of two with one hash and not one value, which hardly are, the second is alone. */
        bool is_same = stride == 0 || memcmp(own, m->attributes + (size_t)stride * *first, stride * sizeof *own) == 0;
        b->same[v] = is_same ? *first : v;
    }
    pair_map_clear(&b->edges);
    return HEMI_OK;
}
