/* SPDX-License-Identifier: MIT
 * Does light get out of where it is, if whatever it meets throws it back? One path of it, from wall to wall by the
 * cosine, which of many finds every way out that is more than a few thousandths of the walls.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_LIGHT_WALK_H
#define HEMIBAKE_CORE_GEOMETRY_LIGHT_WALK_H

#include "geometry/triangle_bvh.h"

#include <stdint.h>

typedef struct light_walk {
    const triangle_bvh *tree; /* of what light does not pass */
    double narrow;            /* m; a box of what was met that is wider than this each way is out. INFINITY: none is */
    double low[3], high[3];   /* of all that was met by walks so far; light_walk_begin's */
    size_t last;              /* the triangle that was met last */
} light_walk;

void light_walk_begin(light_walk *w, const triangle_bvh *tree, double narrow);

/* From a place along a unit direction, the same for the same seed. True: it meets nothing in the end, or is out. */
bool light_walk_gets_out(light_walk *w, const double from[3], const double direction[3], uint64_t seed);

/* The least and the largest edge of the box of what was met; 0 before anything was. */
void light_walk_edges(const light_walk *w, double *least, double *diagonal);

/* A place on the front of a triangle, by an even point, and a direction from there. False: it has no area. */
bool light_walk_start(const double corner[3][3], size_t i, double from[3], double direction[3]);

#endif
