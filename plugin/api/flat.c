/* SPDX-License-Identifier: MIT
 * See flat.h.
 */
#include "flat.h"

#include "base/block.h"

#include <string.h>

/* values[width*v+k] of the vertices, one after the other, for the corners of the triangles; NULL stays NULL. */
static bool spread(allocator *memory, const solved_mesh *m, const void *values, size_t bytes, void **out) {
    size_t corners = 3 * (size_t)m->triangle_count;
    *out = NULL;
    if (!values) return true;
    *out = block_new(memory, corners * bytes + 1);
    for (size_t c = 0; *out && c < corners; c++)
        memcpy((char *)*out + c * bytes, (const char *)values + m->indices[c] * bytes, bytes);
    return *out;
}

static void average(float *colors, size_t triangles) {
    for (size_t t = 0; colors && t < triangles; t++) {
        float *at = colors + 9 * t;
        for (int k = 0; k < 3; k++) {
            float mean = (float)(((double)at[k] + at[3 + k] + at[6 + k]) / 3.0);
            at[k] = at[3 + k] = at[6 + k] = mean;
        }
    }
}

hemi_result flat_make(allocator *memory, solved_mesh *m) {
    size_t three = 3 * sizeof(float), attributes = m->attribute_count * sizeof(float);
    solved_mesh out = { .triangle_count = m->triangle_count, .attribute_count = m->attribute_count };
    if (m->triangle_count > UINT32_MAX / 3) return HEMI_ERROR_LIMIT;
    out.vertex_count = 3 * m->triangle_count;
    out.indices = block_new(memory, (size_t)out.vertex_count * sizeof *out.indices + 1);
    bool ok = out.indices && spread(memory, m, m->positions, three, (void **)&out.positions) &&
              spread(memory, m, m->normals, three, (void **)&out.normals) &&
              spread(memory, m, m->radiance, three, (void **)&out.radiance) &&
              spread(memory, m, m->demodulated, three, (void **)&out.demodulated) &&
              spread(memory, m, m->source_triangles, sizeof(uint32_t), (void **)&out.source_triangles) &&
              spread(memory, m, m->source_weights, three, (void **)&out.source_weights) &&
              spread(memory, m, m->attributes, attributes, (void **)&out.attributes);
    if (ok) {
        for (uint32_t i = 0; i < out.vertex_count; i++) out.indices[i] = i;
        average(out.radiance, out.triangle_count);
        average(out.demodulated, out.triangle_count);
    }
    solved_mesh_free(ok ? m : &out);
    if (ok) *m = out;
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
