/* SPDX-License-Identifier: MIT
 * Which way does a triangle face, has it an area at all, and where in it does a point lie?
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_TRIANGLE_H
#define HEMIBAKE_CORE_GEOMETRY_TRIANGLE_H

#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <stddef.h>
#include <stdint.h>

/* The corners index[0..2] of a mesh: positions[3*v+k]. */
static inline void triangle_from_floats(double corner[3][3], const float *positions, const uint32_t index[3]) {
    for (int i = 0; i < 3; i++) vec3_from_floats(corner[i], positions + 3 * (size_t)index[i]);
}

/* The cross product of two edges: out of the front, as long as twice the area. */
static inline void triangle_cross(double out[3], const double a[3], const double b[3], const double c[3]) {
    double u[3], v[3];
    vec3_sub(u, b, a);
    vec3_sub(v, c, a);
    vec3_cross(out, u, v);
}

static inline double triangle_area(const double a[3], const double b[3], const double c[3]) {
    double cross[3];
    triangle_cross(cross, a, b, c);
    return 0.5 * vec3_length(cross);
}

/* The square of the longest edge. */
static inline double triangle_longest_squared(const double a[3], const double b[3], const double c[3]) {
    double ab = vec3_distance_squared(a, b), bc = vec3_distance_squared(b, c), ca = vec3_distance_squared(c, a);
    double longest = ab > bc ? ab : bc;
    return longest > ca ? longest : ca;
}

/* Is the plane of a triangle with this cross product made of the roundings of its corners? */
static inline bool triangle_is_degenerate(double twice_area, double longest_squared) {
    return !(0.5 * twice_area > TOLERANCE_DEGENERATE * longest_squared);
}

/* Barycentric coordinates of the point of the plane that is nearest to x; false for a triangle without area. */
static inline bool triangle_weights(double w[3], const double a[3], const double b[3], const double c[3],
                                    const double x[3]) {
    double u[3], v[3], p[3];
    vec3_sub(u, b, a);
    vec3_sub(v, c, a);
    vec3_sub(p, x, a);
    double uu = vec3_dot(u, u), uv = vec3_dot(u, v), vv = vec3_dot(v, v), up = vec3_dot(u, p), vp = vec3_dot(v, p);
    double determinant = uu * vv - uv * uv;
    if (!(determinant > 0.0)) return false;
    w[1] = (vv * up - uv * vp) / determinant;
    w[2] = (uu * vp - uv * up) / determinant;
    w[0] = 1.0 - w[1] - w[2];
    return true;
}

/* The square of the distance to x, and the weights of the corners at the nearest point of the triangle. */
double triangle_nearest(double w[3], const double a[3], const double b[3], const double c[3], const double x[3]);

#endif
