/* SPDX-License-Identifier: MIT
 * What does a point on a surface see? A hemi-cube [Cohen85]: five item buffers on half a cube around the normal. What
 * its pixels say of other points is hemicube_visibility.h, what they weigh hemicube_weights.h.
 *
 * Pixels, resolution N (even), rows from 0:      tangent x bitangent = normal; turned about the normal by an angle
 *
 *     0 .. N       top      x along tangent, y along bitangent       the four sides, each N x N/2, y along the normal:
 *     N .. 3N/2    side 0   forward +tangent,   x along bitangent    +---------+
 *     3N/2 .. 2N   side 1   forward -tangent,   x along bitangent    |   top   |   N x N
 *     2N .. 5N/2   side 2   forward +bitangent, x along tangent      +---------+
 *     5N/2 .. 3N   side 3   forward -bitangent, x along tangent      | sides.. |   4 of N x N/2
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_H
#define HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_H

#include "scene/scene.h"
#include "visibility/item_buffer.h"

typedef struct hemicube {
    int resolution;
    double eye[3], tangent[3], bitangent[3], normal[3];
    uint32_t *ids; /* ids[y*resolution+x]: triangle + 1 of the item geometry, 0 for the sky; perhaps with ITEM_MARK */
} hemicube;

/* Places the hemi-cube on a surface; angle (radians) turns it about the normal. */
void hemicube_place(hemicube *h, const double eye[3], const double normal[3], double angle);

/* The pixels as runs of equal ids, along rows: runs[2*i] the id, runs[2*i+1] how many. Returns how many runs there are;
 * with runs NULL it only counts. */
size_t hemicube_pack(const hemicube *h, uint32_t *runs);
void hemicube_unpack(hemicube *h, const uint32_t *runs, size_t count);

/* A surface and its twin are one sheet: one of the two always shows its front. */
static inline bool hemicube_shows_front(const scene *s, uint32_t surface_index, const double eye[3]) {
    const surface *f = &s->surfaces[surface_index];
    return f->twin != NO_INDEX || surface_height(f, eye) > 0.0;
}

/* The end of the run of equal ids that begins at q. Looks at eight at a time, which compilers turn into vector code. */
static inline size_t hemicube_run_end(const uint32_t *ids, size_t q, size_t count) {
    const uint32_t id = ids[q++];
    for (; q + 8 <= count; q += 8) {
        uint32_t other = 0;
        for (size_t i = 0; i < 8; i++) other |= ids[q + i] ^ id;
        if (other) break;
    }
    while (q < count && ids[q] == id) q++;
    return q;
}

/* Draws it. center: what item positions are relative to. */
bool hemicube_draw(hemicube *h, item_buffer *items, const double center[3]);

/* Pixels of one row from q on: the direction of the centre of pixel q + k is start + (s + k step) along, its component
 * along the largest axis of the cube 1. Here, because the estimate asks for it at every pixel. */
typedef struct hemicube_row {
    double start[3], along[3], s, step;
} hemicube_row;

static inline hemicube_row hemicube_row_at(const hemicube *h, size_t q) {
    int n = h->resolution, half = n / 2, row = (int)((uint32_t)q / (uint32_t)n), column = (int)q - row * n;
    hemicube_row out = { .s = (2 * column + 1.0) / n - 1, .step = 2.0 / n };
    int side = row < n ? 0 : (row - n) / half;
    double t = row < n ? (2 * row + 1.0) / n - 1 : (2 * ((row - n) % half) + 1.0) / n, sign = side & 1 ? -1.0 : 1.0;
    const double *forward = side < 2 ? h->tangent : h->bitangent, *across = side < 2 ? h->bitangent : h->tangent;
    for (int k = 0; k < 3; k++) {
        out.start[k] = row < n ? h->normal[k] + t * h->bitangent[k] : sign * forward[k] + t * h->normal[k];
        out.along[k] = row < n ? h->tangent[k] : across[k];
    }
    return out;
}

#endif
