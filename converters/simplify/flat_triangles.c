/* SPDX-License-Identifier: MIT */
#include "flat_triangles.h"

#include <string.h>

bool flat_triangles_spread(allocator *memory, const uint32_t *indices, size_t triangle_count, void **values,
                           size_t bytes) {
    size_t corners = 3 * triangle_count;
    if (!*values) return true;
    char *out = block_new(memory, corners * bytes + 1);
    if (!out) return false;
    for (size_t c = 0; c < corners; c++) memcpy(out + c * bytes, (const char *)*values + indices[c] * bytes, bytes);
    block_free(*values);
    *values = out;
    return true;
}

void flat_triangles_average(float *colors, size_t triangle_count) {
    for (size_t t = 0; colors && t < triangle_count; t++) {
        float *at = colors + 9 * t;
        for (int k = 0; k < 3; k++) {
            float mean = (float)(((double)at[k] + at[3 + k] + at[6 + k]) / 3.0);
            at[k] = at[3 + k] = at[6 + k] = mean;
        }
    }
}
