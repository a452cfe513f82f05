/* SPDX-License-Identifier: MIT */
#include "visibility/drawn_triangles.h"

#include <math.h>
#include <string.h>

/* What OpenGL works out in floats may be off by some roundings of the largest term; so far outside a plane a vertex is
 * outside for sure. */
static const float ROUNDINGS = 1e-5f;

enum { UNUSED = 0 };

static bool allocate(const item_geometry *g, allocator *memory, drawn_triangles *d) {
    size_t corners = 3 * g->triangle_count, used = g->vertex_count < corners ? g->vertex_count : corners;
    size_t vertices = used + g->triangle_count;
    d->memory = memory;
    d->positions = block_new(memory, (3 * vertices + 1) * sizeof *d->positions);
    d->ids = block_zeroed(memory, vertices + 1, sizeof *d->ids);
    d->indices = block_new(memory, (corners + 1) * sizeof *d->indices);
    if (g->coordinates) d->coordinates = block_new(memory, (3 * vertices + 1) * sizeof *d->coordinates);
    return d->positions && d->ids && d->indices && (d->coordinates || !g->coordinates);
}

static uint32_t add_vertex(drawn_triangles *d, const item_geometry *g, uint32_t v) {
    size_t to = 3 * d->vertex_count, from = 3 * (size_t)v;
    memcpy(d->positions + to, g->positions + from, 3 * sizeof *d->positions);
    if (d->coordinates) memcpy(d->coordinates + to, g->coordinates + from, 3 * sizeof *d->coordinates);
    for (size_t k = 0; k < 3; k++) d->reach = fmaxf(d->reach, fabsf(d->positions[to + k]));
    return (uint32_t)d->vertex_count++;
}

/* added[v]: 1 + the number of vertex v of the geometry among those that are drawn, or UNUSED. */
static void add_triangles(drawn_triangles *d, const item_geometry *g, const uint32_t *order, uint32_t *added) {
    for (size_t i = 0; i < g->triangle_count; i++) {
        size_t t = order[i];
        uint32_t *corner = &d->indices[3 * i];
        for (size_t k = 0; k < 3; k++) {
            uint32_t v = g->indices[3 * t + k];
            if (added[v] == UNUSED) added[v] = 1 + add_vertex(d, g, v);
            corner[k] = added[v] - 1;
        }
        if (d->ids[corner[2]]) corner[2] = add_vertex(d, g, g->indices[3 * t + 2]);
        d->ids[corner[2]] = (uint32_t)t + 1;
    }
    d->triangle_count = g->triangle_count;
}

bool drawn_triangles_create(const item_geometry *g, const uint32_t *order, allocator *memory, drawn_triangles *out) {
    uint32_t *added = block_zeroed(memory, g->vertex_count + 1, sizeof *added);
    bool ok = added && allocate(g, memory, out);
    if (ok) add_triangles(out, g, order, added);
    block_free(added);
    for (int k = 0; ok && k < 3; k++) {
        out->place[k] = block_new(memory, (out->vertex_count + 1) * sizeof(float));
        ok = out->place[k];
    }
    for (size_t i = 0; ok && i < 3 * out->vertex_count; i++) out->place[i % 3][i / 3] = out->positions[i];
    if (ok) out->outside = block_new(memory, out->vertex_count + 1);
    return out->outside;
}

void drawn_triangles_forget(drawn_triangles *d) {
    block_free_all(d->positions, d->coordinates, d->ids);
    d->positions = d->coordinates = NULL;
    d->ids = NULL;
}

void drawn_triangles_free(drawn_triangles *d) {
    drawn_triangles_forget(d);
    for (int k = 0; k < 3; k++) block_free(d->place[k]);
    block_free_all(d->indices, d->kept, d->outside);
    memset(d, 0, sizeof *d);
}

static float margin_of(const float m[16], float reach) {
    float most = 0.0f;
    for (int row = 0; row < 4; row++)
        if (row != 2) /* depth is clamped */
            most = fmaxf(most, reach * (fabsf(m[row]) + fabsf(m[4 + row]) + fabsf(m[8 + row])) + fabsf(m[12 + row]));
    return ROUNDINGS * most;
}

/* The view is -w <= x, y <= w in clip coordinates, whatever the sign of w. Free of branches, for vector code. */
void drawn_triangles_look(drawn_triangles *d, const float m[16]) {
    const float *restrict px = d->place[0], *restrict py = d->place[1], *restrict pz = d->place[2];
    const float xx = m[0], xy = m[4], xz = m[8], x0 = m[12], yx = m[1], yy = m[5], yz = m[9], y0 = m[13];
    const float wx = m[3], wy = m[7], wz = m[11], w0 = m[15] + margin_of(m, d->reach);
    uint8_t *restrict outside = d->outside;
    for (size_t v = 0; v < d->vertex_count; v++) {
        float x = xx * px[v] + xy * py[v] + xz * pz[v] + x0, y = yx * px[v] + yy * py[v] + yz * pz[v] + y0;
        float w = wx * px[v] + wy * py[v] + wz * pz[v] + w0;
        int side = (x > w ? 1 : 0) | (-x > w ? 2 : 0) | (y > w ? 4 : 0) | (-y > w ? 8 : 0) | (w < 0.0f ? 16 : 0);
        outside[v] = (uint8_t)side;
    }
}

bool drawn_triangles_keep(drawn_triangles *d, size_t first, size_t count) {
    size_t wanted = d->kept_count + count;
    if (wanted > d->kept_capacity) wanted += wanted / 2;
    if (!block_reserve(d->memory, (void **)&d->kept, &d->kept_capacity, wanted, 3 * sizeof *d->kept)) return false;
    uint32_t *to = d->kept + 3 * d->kept_count;
    const uint8_t *outside = d->outside;
    for (const uint32_t *t = d->indices + 3 * first, *end = t + 3 * count; t < end; t += 3) {
        to[0] = t[0], to[1] = t[1], to[2] = t[2];
        to += outside[t[0]] & outside[t[1]] & outside[t[2]] ? 0 : 3;
    }
    d->kept_count = (size_t)(to - d->kept) / 3;
    return true;
}
