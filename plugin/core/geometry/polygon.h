/* SPDX-License-Identifier: MIT
 * What fraction of the light that leaves a small area reaches a polygon? The closed form of Lambert (1760), as in
 * [Baum89, eq. 9]:
 *
 *     F = 1/(2 pi) sum over edges of n . Gamma_g,   Gamma_g = angle(R_g, R_g+1) along R_g x R_g+1
 *
 * with R_g the vectors from the point to the corners. It holds for what lies above the horizon of the point, so the
 * boundary is cut there and closed along the horizon. Only the boundary counts: it may be non-convex, and it need not
 * lie in a plane (the outline of a curved patch; where such a one crosses the horizon it is closed the short way
 * round).
 *
 * How it is made exact. The terms of the sum are of the order of the edges' angles, the sum is of the order of the
 * solid angle: far away, for slivers, near the horizon and near its plane a polygon's terms cancel. Every evaluation
 * carries a bound of its rounding errors; where the bound exceeds 5e-11 of the value, the sum is done again in pairs of
 * doubles (polygon_exact.c). Errors relative to the exact value, worst of the cases of
 * tests/core/formfactor_polygon_oracle_test.c, polygon of size 1:
 *
 *                                                 far 1e4  far 1e9  sliver 1e-6  offset 1e6  horizon 1e-8
 *     sum of angle * n . unit(R_g x R_g+1)          7e-7     1e3        2e7          7e-9        2e1
 *     the same, products R_g x (R_g+1 - R_g)        1e-10    5e-6       2e-1         6e-12       2e1
 *     what is here                                  6e-13    2e-16      5e-13        6e-13       2e-13
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_POLYGON_H
#define HEMIBAKE_CORE_GEOMETRY_POLYGON_H

#include <stddef.h>

enum { POLYGON_CORNERS_MAX = 20 };

/* corner[i] runs clockwise or counter-clockwise; counter-clockwise is seen from the front. */
typedef struct polygon {
    double corner[POLYGON_CORNERS_MAX][3];
    int count;
} polygon;

/* A closed boundary of any number of corners, in the caller's memory. Where it crosses itself, parts count as often as
 * it runs round them. */
typedef struct polygon_loop {
    const double (*corner)[3];
    size_t count;
} polygon_loop;

static inline polygon_loop polygon_boundary(const polygon *p) {
    return (polygon_loop){ p->corner, p->count > 0 ? (size_t)p->count : 0 };
}

/* Keeps what lies at normal . x >= plane (Sutherland & Hodgman 1974). A convex polygon of up to
 * POLYGON_CORNERS_MAX - 1 corners, or any loop of two thirds of that: its parts are then joined by edges there and back
 * that cancel. The result may be empty. */
void polygon_clip(polygon *out, const polygon *in, const double normal[3], double plane);

/* Form factor from a small area at a point (unit normal) to what the loop bounds, seen from its front: >= 0; its back
 * gives a negative value. The error is at most 1e-10 of the value of these very corners, point and normal, as long as
 * fewer than 20 digits cancel.
 *
 * Rules for what has no value: 0 for fewer than three corners, a coordinate that is not finite, a polygon without area,
 * nothing above the horizon, and a point in the plane of the polygon (inside it, too, where the two sides of the plane
 * have different limits; the sum of both is 0). A point on the boundary of a loop that is not planar gets the mean of
 * the limits on both sides. */
double polygon_loop_factor(polygon_loop loop, const double point[3], const double normal[3]);
double polygon_factor(const polygon *p, const double point[3], const double normal[3]);

/* The same without the cut at the horizon and without bounds, for many points: factors[i] += F from (x[i], y[i], z[i]).
 * The loop must lie above the horizon of every point (polygon_clip). Off by a few roundings of the angles of the
 * edges: at most 1e-13, except within a thousandth of its size from an edge, where the rounding of a coordinate already
 * turns what is seen of it by more. The same bits on every machine. */
void polygon_loop_factor_batch(polygon_loop loop, const double normal[3], const double *x, const double *y,
                               const double *z, size_t count, double *factors);
void polygon_factor_batch(const polygon *p, const double normal[3], const double *x, const double *y, const double *z,
                          size_t count, double *factors);

/* Cuts a triangle or quad into four of its kind at its edges' midpoints. */
void polygon_quarter(const polygon *p, polygon quarter[4]);

/* Vector area: half the sum of cross products; its length is the area, its direction the front. */
void polygon_loop_vector_area(polygon_loop loop, double out[3]);
void polygon_vector_area(const polygon *p, double out[3]);

/* Centroid of a convex planar polygon; returns its area. */
double polygon_centroid(const polygon *p, double out[3]);

/* polygon_loop_factor in pairs of doubles: 30 digits less what cancels. About 40 times slower. */
double polygon_loop_factor_exact(polygon_loop loop, const double point[3], const double normal[3]);

#endif
