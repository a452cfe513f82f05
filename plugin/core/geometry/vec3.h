/* SPDX-License-Identifier: MIT
 * What can one do with three doubles? Vectors are plain arrays, so that they lie in structs and tables as they are.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_VEC3_H
#define HEMIBAKE_CORE_GEOMETRY_VEC3_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

static const double PI = 3.14159265358979323846, TWO_PI = 6.28318530717958647692;

static inline void vec3_copy(double out[3], const double a[3]) {
    out[0] = a[0], out[1] = a[1], out[2] = a[2];
}

static inline void vec3_sub(double out[3], const double a[3], const double b[3]) {
    out[0] = a[0] - b[0], out[1] = a[1] - b[1], out[2] = a[2] - b[2];
}

/* From floats, as positions come; the rest is done in doubles. */
static inline void vec3_from_floats(double out[3], const float a[3]) {
    out[0] = a[0], out[1] = a[1], out[2] = a[2];
}

/* -0 is 0. */
static inline bool vec3_equal(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static inline bool vec3_is_zero(const double a[3]) {
    return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0;
}

/* out = a + s b */
static inline void vec3_add_scaled(double out[3], const double a[3], double s, const double b[3]) {
    out[0] = a[0] + s * b[0], out[1] = a[1] + s * b[1], out[2] = a[2] + s * b[2];
}

static inline double vec3_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Of floats, in doubles. */
static inline double vec3_dot_floats(const float a[3], const float b[3]) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

static inline void vec3_cross(double out[3], const double a[3], const double b[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

static inline double vec3_length(const double a[3]) {
    return sqrt(vec3_dot(a, a));
}

static inline double vec3_distance_squared(const double a[3], const double b[3]) {
    double d[3];
    vec3_sub(d, a, b);
    return vec3_dot(d, d);
}

static inline double vec3_distance(const double a[3], const double b[3]) {
    return sqrt(vec3_distance_squared(a, b));
}

/* How far a point is from the line between two others, ends included. */
static inline double vec3_distance_to_segment(const double x[3], const double a[3], const double b[3]) {
    double edge[3], offset[3];
    vec3_sub(edge, b, a);
    vec3_sub(offset, x, a);
    double square = vec3_dot(edge, edge), t = square > 0.0 ? vec3_dot(offset, edge) / square : 0.0;
    vec3_add_scaled(offset, offset, t < 0.0 ? 0.0 : t > 1.0 ? -1.0 : -t, edge);
    return vec3_length(offset);
}

/* Where between a and b is a point, as a share of the way: within the tolerance, also a share, of the line and further
 * than that from either end. Negative: nowhere. */
static inline double vec3_place_between(const double x[3], const double a[3], const double b[3], double tolerance) {
    double edge[3], offset[3];
    vec3_sub(edge, b, a);
    vec3_sub(offset, x, a);
    double square = vec3_dot(edge, edge), t = vec3_dot(edge, offset) / square;
    vec3_add_scaled(offset, offset, -t, edge);
    bool is_on_line = vec3_dot(offset, offset) <= tolerance * tolerance * square;
    return is_on_line && t > tolerance && t < 1.0 - tolerance ? t : -1.0;
}

/* Returns the length that a had; a zero vector stays zero. */
static inline double vec3_normalize(double a[3]) {
    double length = vec3_length(a);
    if (length > 0.0) a[0] /= length, a[1] /= length, a[2] /= length;
    return length;
}

/* Two axes of the plane of a unit normal: u x v = n. Any axis that is not along n will do; the one of its least
 * component is furthest from it. */
static inline void vec3_tangents(const double n[3], double u[3], double v[3]) {
    double axis[3] = { 0, 0, 0 };
    int least = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
    axis[fabs(n[2]) < fabs(n[least]) ? 2 : least] = 1.0;
    vec3_cross(u, axis, n);
    vec3_normalize(u);
    vec3_cross(v, n, u);
}

/* The bounding box of points, x, y, z one after the other; low is above high if there are none. */
static inline void vec3_bounds(const double *xyz, size_t count, double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t i = 0; i < 3 * count; i++) {
        low[i % 3] = fmin(low[i % 3], xyz[i]);
        high[i % 3] = fmax(high[i % 3], xyz[i]);
    }
}

/* Halfway, the same from either end. */
static inline void vec3_mid(double out[3], const double a[3], const double b[3]) {
    out[0] = 0.5 * (a[0] + b[0]), out[1] = 0.5 * (a[1] + b[1]), out[2] = 0.5 * (a[2] + b[2]);
}

#endif
