/* SPDX-License-Identifier: MIT
 * Does a ray slip between two triangles that meet? A vertex on another triangle's edge is rounded, in a file and by
 * what draws an item buffer: the edge misses it by a little, and a sample in between sees what is behind, as a white
 * speck in a wall. Such a sample is one that has, on two opposite sides, samples of what is nearer, and that passes one
 * of their triangles by less than a small share of the way to the next sample. A gap that is wider stays one.
 */
#ifndef HEMIBAKE_CORE_PICTURE_CRACKS_H
#define HEMIBAKE_CORE_PICTURE_CRACKS_H

#include "picture/picture.h"

/* An item buffer: ids[y*width+x] is 1 + a triangle, 0 where none is. */
typedef struct crack_view {
    const picture *picture;
    const alpha_mask_map *const *holes; /* holes[t] of triangle t, which end anywhere in it; NULL: none has any */
    const uint32_t *ids;
    int width, height;
    const double *eye, *forward;
    double step; /* from sample to sample, at distance 1 along forward */
} crack_view;

/* What the sample at x, y, whose ray from the eye this is, 1 along forward, sees: its own id, or that of the triangle
 * that it slips past. */
uint32_t crack_closed(const crack_view *v, int x, int y, const double ray[3]);

#endif
