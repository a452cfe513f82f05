/* SPDX-License-Identifier: MIT
 * What fraction of the light that leaves each polygon reaches every other, obstructions included, and how exact is
 * that?
 *
 * K_ij = A_i F_ij = A_j F_ji is found once for each pair, so reciprocity holds by construction and the sum of a row is
 * a check of everything else. A pair that nothing can stand between is integrated without looking; for the others the
 * visible part of the farther polygon is cut out exactly at every point of the nearer (visible_part.h).
 */
#ifndef HEMIBAKE_CORE_FACTORS_FACTOR_MATRIX_H
#define HEMIBAKE_CORE_FACTORS_FACTOR_MATRIX_H

#include "base/jobs.h"
#include "geometry/polygon.h"

#include <stdint.h>

/* One polygon of the input as one or two convex planar parts; a polygon without parts takes no part. */
typedef struct matrix_polygon {
    polygon part[2];
    double normal[2][3], plane[2], area[2];
    int part_count;
    bool obstruction; /* blocks light but has neither row nor column */
} matrix_polygon;

/* What a polygon of the input turned out to be. */
typedef enum polygon_kind {
    POLYGON_PLANAR,
    POLYGON_NOT_PLANAR, /* a quad bent by more than the tolerance: its two triangles along the shorter diagonal */
    POLYGON_CONCAVE,    /* cut at the reflex corner */
    POLYGON_CROSSING,   /* a bow-tie: left out */
    POLYGON_NO_AREA,    /* left out */
    POLYGON_NOT_FINITE, /* left out */
} polygon_kind;

/* corners: 3 or 4. */
polygon_kind matrix_polygon_set(matrix_polygon *out, const double corner[][3], int corner_count);

typedef struct factor_matrix_setup {
    const matrix_polygon *polygons;
    size_t count;
    double tolerance;          /* absolute, of every F_ij */
    uint64_t evaluation_limit; /* of a pair */
    jobs *jobs;
} factor_matrix_setup;

/* K[i*count+j] m2 and its estimated error, symmetric; diagonals 0. Returns how many pairs did not converge, or SIZE_MAX
 * when out of memory. */
size_t factor_matrix(const factor_matrix_setup *setup, double *K, double *error, uint64_t *evaluations);

#endif
