/* SPDX-License-Identifier: MIT
 * Which directions does a polygon fill as seen from a point, and which of them is a point of the unit square, evenly by
 * solid angle? A fan of spherical triangles, each mapped from the square as in [Arvo95]: a part of the triangle of so
 * much area, then a place along the arc that ends it. Nets of the square (base/sobol.h) stay nets within each triangle.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_SPHERICAL_POLYGON_H
#define HEMIBAKE_CORE_GEOMETRY_SPHERICAL_POLYGON_H

#include "geometry/polygon.h"

/* A convex polygon of this many corners: a quadrilateral that was clipped. */
enum { SPHERICAL_CORNERS_MAX = 6 };

typedef struct spherical_polygon {
    double corner[SPHERICAL_CORNERS_MAX][3]; /* unit vectors */
    double area[SPHERICAL_CORNERS_MAX];      /* of the triangle of corners 0, i + 1 and i + 2, sr */
    double angle[SPHERICAL_CORNERS_MAX];     /* ... at corner 0 */
    double solid_angle;                      /* of all, sr; 0 of one that is seen edge-on or that is no polygon */
    int triangles;
} spherical_polygon;

/* The polygon is convex and planar, of at most SPHERICAL_CORNERS_MAX corners; either side of it may be seen. */
void spherical_polygon_set(spherical_polygon *out, const polygon *p, const double from[3]);

/* A unit vector. Needs a solid angle above 0. */
void spherical_polygon_direction(const spherical_polygon *s, const double square[2], double out[3]);

#endif
