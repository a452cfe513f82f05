/* SPDX-License-Identifier: MIT
 * See drawn_triangles.h.
 */
#include "visibility/drawn_triangles.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

/* What OpenGL works out in floats may be off by some roundings of the largest term; so far outside a plane a vertex is
 * outside for sure. */
static const float ROUNDINGS = 1e-5f;

static bool allocate(const item_geometry *g, allocator *memory, drawn_triangles *d) {
    size_t vertices = g->vertex_count + g->triangle_count, corners = 3 * g->triangle_count;
    d->positions = block_new(memory, (3 * vertices + 1) * sizeof *d->positions);
    d->ids = block_zeroed(memory, vertices + 1, sizeof *d->ids);
    d->indices = block_new(memory, (corners + 1) * sizeof *d->indices);
    d->kept = block_new(memory, (corners + 1) * sizeof *d->kept);
    d->outside = block_new(memory, vertices + 1);
    if (g->coordinates) d->coordinates = block_new(memory, (3 * vertices + 1) * sizeof *d->coordinates);
    return d->positions && d->ids && d->indices && d->kept && d->outside && (d->coordinates || !g->coordinates);
}

/* A vertex like another, for a triangle to be the last of. */
static uint32_t repeat_vertex(drawn_triangles *d, uint32_t v) {
    size_t to = 3 * d->vertex_count, from = 3 * (size_t)v;
    memcpy(d->positions + to, d->positions + from, 3 * sizeof *d->positions);
    if (d->coordinates) memcpy(d->coordinates + to, d->coordinates + from, 3 * sizeof *d->coordinates);
    return (uint32_t)d->vertex_count++;
}

bool drawn_triangles_create(const item_geometry *g, uint32_t first_id, allocator *memory, drawn_triangles *out) {
    drawn_triangles *d = out;
    if (!allocate(g, memory, d)) return false;
    d->vertex_count = g->vertex_count, d->triangle_count = g->triangle_count;
    memcpy(d->positions, g->positions, 3 * g->vertex_count * sizeof *d->positions);
    if (d->coordinates) memcpy(d->coordinates, g->coordinates, 3 * g->vertex_count * sizeof *d->coordinates);
    memcpy(d->indices, g->indices, 3 * g->triangle_count * sizeof *d->indices);
    for (size_t i = 0; i < 3 * g->vertex_count; i++) d->reach = fmaxf(d->reach, fabsf(d->positions[i]));
    for (size_t t = 0; t < g->triangle_count; t++) {
        uint32_t *last = &d->indices[3 * t + 2];
        if (d->ids[*last]) *last = repeat_vertex(d, *last);
        d->ids[*last] = first_id + (uint32_t)t;
    }
    return true;
}

void drawn_triangles_free(drawn_triangles *d) {
    block_free(d->positions);
    block_free(d->coordinates);
    block_free(d->ids);
    block_free(d->indices);
    block_free(d->kept);
    block_free(d->outside);
    memset(d, 0, sizeof *d);
}

static float margin_of(const float m[16], float reach) {
    float most = 0.0f;
    for (int row = 0; row < 4; row++)
        if (row != 2) /* depth is clamped */
            most = fmaxf(most, reach * (fabsf(m[row]) + fabsf(m[4 + row]) + fabsf(m[8 + row])) + fabsf(m[12 + row]));
    return ROUNDINGS * most;
}

/* The view is -w <= x, y <= w in clip coordinates, whatever the sign of w. */
void drawn_triangles_look(drawn_triangles *d, const float m[16]) {
    const float margin = margin_of(m, d->reach), *restrict p = d->positions;
    const float xx = m[0], xy = m[4], xz = m[8], x0 = m[12], yx = m[1], yy = m[5], yz = m[9], y0 = m[13];
    const float wx = m[3], wy = m[7], wz = m[11], w0 = m[15] + margin;
    uint8_t *restrict outside = d->outside;
    for (size_t v = 0; v < d->vertex_count; v++) {
        float x = xx * p[3 * v] + xy * p[3 * v + 1] + xz * p[3 * v + 2] + x0;
        float y = yx * p[3 * v] + yy * p[3 * v + 1] + yz * p[3 * v + 2] + y0;
        float w = wx * p[3 * v] + wy * p[3 * v + 1] + wz * p[3 * v + 2] + w0;
        outside[v] = (uint8_t)((x > w) | (-x > w) << 1 | (y > w) << 2 | (-y > w) << 3 | (w < 0.0f) << 4);
    }
}

size_t drawn_triangles_keep(drawn_triangles *d, size_t first, size_t count, size_t used) {
    uint32_t *to = d->kept + 3 * used;
    const uint8_t *outside = d->outside;
    for (const uint32_t *t = d->indices + 3 * first, *end = t + 3 * count; t < end; t += 3) {
        to[0] = t[0], to[1] = t[1], to[2] = t[2];
        to += outside[t[0]] & outside[t[1]] & outside[t[2]] ? 0 : 3;
    }
    return (size_t)(to - d->kept) / 3 - used;
}
