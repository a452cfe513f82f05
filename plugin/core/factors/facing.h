/* SPDX-License-Identifier: MIT
 * Which parts of two polygons can see each other, if nothing stands between? Of each the part in front of the other:
 * light leaves and arrives at fronts only, and the formulas hold only there.
 */
#ifndef HEMIBAKE_CORE_FACTORS_FACING_H
#define HEMIBAKE_CORE_FACTORS_FACING_H

#include "base/block.h"
#include "geometry/polygon.h"

/* One of the two, cut to what is in front of the other. */
typedef struct facing_side {
    polygon_loop loop;
    double normal[3], center[3];         /* center: mean of the corners that are left */
    double radius, perimeter, area_left; /* of what is left, about center */
    bool convex;                         /* what is left, to roundings */
    double area;                         /* of the whole */
} facing_side;

typedef struct facing {
    facing_side element, source;
    double (*corners)[3];
    bool any;    /* both have something left */
    bool far;    /* their centres are further apart than FACING_FAR times the sum of their radii */
    bool planar; /* both are, to FACING_FLATNESS of their size */
} facing;

/* A loop further from its plane than this, relative to its size, is not planar: a hundred times what positions in float
 * leave of a plane near the origin. */
#define FACING_FLATNESS 1e-5

/* Logarithms of distances between points of the two then differ by 1/4, and what is left of them in a form factor is of
 * the order of the square; rules over an area have errors of the order of (1/4)^12 in their first step. */
#define FACING_FAR 2.5

/* Loops with fewer than three corners, without area or with coordinates that are not finite have nothing left. False
 * when out of memory. */
bool facing_create(facing *f, polygon_loop element, polygon_loop source, allocator *memory);
void facing_destroy(facing *f);

#endif
