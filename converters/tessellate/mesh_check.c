/* SPDX-License-Identifier: MIT
 * Which triangles of a mesh lie in each other, and at which edges do more than two meet? By positions, whatever the
 * indices are. Of triangles with the same corners that face the same way the first is kept: the others would be hidden
 * in it, and shoot and absorb its light once more. In a double-sided mesh either way round is the same.
 */
#include "internal.h"

#include "geometry/vec3.h"

#include <string.h>

static void swap(uint32_t *a, uint32_t *b) {
    uint32_t t = *a;
    *a = *b;
    *b = t;
}

/* The corners' places from the lowest on, in their order; of a sheet with two sides sorted. */
static void triangle_key(const builder *b, uint32_t t, uint32_t at[3]) {
    for (int k = 0; k < 3; k++) at[k] = b->place[b->mesh->indices[3 * (size_t)t + (size_t)k]];
    while (at[0] > at[1] || at[0] > at[2]) {
        swap(&at[0], &at[1]);
        swap(&at[1], &at[2]);
    }
    if (b->desc->double_sided[b->mesh_index] && at[1] > at[2]) swap(&at[1], &at[2]);
}

hemi_result mesh_check_drop_duplicates(builder *b, double *normals) {
    for (uint32_t t = 0; t < b->mesh->triangle_count; t++) {
        uint32_t at[3];
        if (vec3_is_zero(normals + 3 * (size_t)t)) continue;
        triangle_key(b, t, at);
        uint32_t *first = pair_map_at(&b->edges, at[0], (uint64_t)at[1] << 32 | at[2], t);
        if (!first) return HEMI_ERROR_MEMORY;
        if (*first == t) continue;
        memset(normals + 3 * (size_t)t, 0, 3 * sizeof *normals);
        b->out->check.duplicate_count++;
    }
    pair_map_clear(&b->edges);
    return HEMI_OK;
}

hemi_result mesh_check_count_edges(builder *b, const double *normals) {
    for (uint32_t t = 0; t < b->mesh->triangle_count; t++) {
        if (vec3_is_zero(normals + 3 * (size_t)t)) continue;
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t *index = b->mesh->indices + 3 * (size_t)t;
            uint64_t high, low = pair_order(b->place[index[k]], b->place[index[(k + 1) % 3]], &high);
            uint32_t *uses = pair_map_at(&b->edges, low, high, 0);
            if (!uses) return HEMI_ERROR_MEMORY;
            if (++*uses == 3) b->out->check.nonmanifold_count++;
        }
    }
    bool counted = !(b->desc->is_proxy && b->desc->is_proxy[b->mesh_index]);
    hemi_result result = counted ? t_junctions_count(b, normals) : HEMI_OK;
    pair_map_clear(&b->edges);
    return result;
}
