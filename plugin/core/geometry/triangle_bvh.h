/* SPDX-License-Identifier: MIT
 * Which of many triangles does a segment meet first? Exactly as doubles are, with backs or without. Of a few thousand
 * rays through a scene that is not cut up yet; rays.h is for millions.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_TRIANGLE_BVH_H
#define HEMIBAKE_CORE_GEOMETRY_TRIANGLE_BVH_H

#include "base/block.h"
#include "geometry/bvh.h"

typedef struct triangle_bvh {
    double (*corners)[3][3]; /* counter-clockwise as seen from the front */
    double *area;            /* m2, of the triangles up to and with this one */
    size_t count;
    double center[3], radius; /* of the box around all */
    bvh tree;
} triangle_bvh;

typedef struct triangle_meeting {
    size_t triangle;
    double share;      /* of the segment, from its beginning */
    double weights[3]; /* of the corners */
    bool is_front;
} triangle_meeting;

/* Room for count triangles, whose corners the caller sets before it calls triangle_bvh_build. False when out of memory;
 * what there is is to be freed then too. */
bool triangle_bvh_allocate(allocator *memory, size_t count, triangle_bvh *out);
bool triangle_bvh_build(allocator *memory, jobs *j, triangle_bvh *t);
void triangle_bvh_free(triangle_bvh *t);

/* All triangles together. */
static inline double triangle_bvh_area(const triangle_bvh *t) {
    return t->count ? t->area[t->count - 1] : 0.0;
}

/* passes[i]: triangle i is not met; NULL: all are. False if nothing is. */
bool triangle_bvh_meet(const triangle_bvh *t, const double from[3], const double to[3], bool fronts_alone,
                       const bool *passes, triangle_meeting *out);

/* Is any met? */
bool triangle_bvh_blocks(const triangle_bvh *t, const double from[3], const double to[3], const bool *passes);

#endif
