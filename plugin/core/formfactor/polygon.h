/* SPDX-License-Identifier: MIT
 * What fraction of the light that leaves a small area reaches a polygon? The closed form of Lambert (1760), as in
 * [Baum89, eq. 9]:
 *
 *     F = 1/(2 pi) sum over edges of n . Gamma_g,   Gamma_g = angle(R_g, R_g+1) along R_g x R_g+1
 *
 * with R_g the vectors from the point to the corners. It holds for what lies above the horizon of the point, so the
 * polygon is clipped to it first. The angle comes from atan2(|a x b|, a . b), which is exact at both ends.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_POLYGON_H
#define HEMIBAKE_CORE_FORMFACTOR_POLYGON_H

#include <stddef.h>

enum { POLYGON_CORNERS_MAX = 12 };

/* corner[i] runs clockwise or counter-clockwise; counter-clockwise is seen from the front. */
typedef struct polygon {
    double corner[POLYGON_CORNERS_MAX][3];
    int count;
} polygon;

/* Keeps what lies at normal . x >= plane (Sutherland & Hodgman 1974). A convex polygon of up to
 * POLYGON_CORNERS_MAX - 1 corners; the result may be empty. */
void polygon_clip(polygon *out, const polygon *in, const double normal[3], double plane);

/* Form factor from a small area at a point (unit normal) to the polygon, seen from its front: >= 0. A polygon that
 * shows its back gives a negative value. Both are exact to rounding; 0 if it is below the horizon or in one plane with
 * the point. */
double polygon_factor(const polygon *p, const double point[3], const double normal[3]);

/* The same without clipping for many points of one plane: factors[i] += F from (x[i], y[i], z[i]). The polygon must lie
 * above the plane of the points already (polygon_clip). Agrees with polygon_factor to 1e-13 relative to 1. */
void polygon_factor_batch(const polygon *p, const double normal[3], const double *x, const double *y, const double *z,
                          size_t count, double *factors);

/* Cuts a triangle or quad into four of its kind at its edges' midpoints. */
void polygon_quarter(const polygon *p, polygon quarter[4]);

/* Vector area: half the sum of cross products; its length is the area, its direction the front. */
void polygon_vector_area(const polygon *p, double out[3]);

/* Centroid of a convex planar polygon. */
void polygon_centroid(const polygon *p, double out[3]);

#endif
