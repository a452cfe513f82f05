/* SPDX-License-Identifier: MIT
 * Is this in one plane with that? A plane is where normal . x = offset, with a unit normal. How near is near enough
 * differs with where the numbers come from (base/tolerance.h), so every function is told.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_PLANE_H
#define HEMIBAKE_CORE_GEOMETRY_PLANE_H

#include "geometry/vec3.h"

/* Signed distance; positive in front. */
static inline double plane_height(const double normal[3], double offset, const double x[3]) {
    return vec3_dot(normal, x) - offset;
}

/* Do all points lie in the plane? margin: a length. */
static inline bool plane_holds(const double normal[3], double offset, const double (*points)[3], int count,
                               double margin) {
    for (int i = 0; i < count; i++)
        if (!(fabs(plane_height(normal, offset, points[i])) <= margin)) return false;
    return true;
}

/* Do two facets that meet in an edge lie in one plane, facing the same way? Their normals differ by no more than a
 * small angle (radians), whose sine is the length of their cross product. */
static inline bool plane_continues(const double normal[3], const double other[3], double angle) {
    double sine[3];
    vec3_cross(sine, normal, other);
    return vec3_dot(normal, other) > 0.0 && vec3_dot(sine, sine) <= angle * angle;
}

#endif
