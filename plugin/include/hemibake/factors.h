/* SPDX-License-Identifier: MIT
 * What are the form factors of polygons? Part of hemibake.h.
 */
#ifndef HEMIBAKE_FACTORS_H
#define HEMIBAKE_FACTORS_H

#include <hemibake/context.h>

HEMI_C_BEGIN

/* Planar polygons of three or four corners, counter-clockwise seen from their fronts; each is one row and column. A
 * quad that is not planar, or concave, is taken as two triangles; a crossing one (a bow-tie), one without area and one
 * whose corners are not finite is left out: its row is 0 and it blocks nothing. All are counted in the result. */
typedef struct hemi_factors_desc {
    uint32_t struct_size;    /* sizeof(hemi_factors_desc) */
    const double *positions; /* positions[3*v+k] */
    uint32_t vertex_count;
    const int32_t *corners;    /* 0 <= corners[4*i+c] < vertex_count; corners[4*i+3] is below 0 in a triangle */
    const bool *obstructions;  /* obstructions[i]: blocks light, but has neither row nor column values; NULL: none */
    uint32_t polygon_count;    /* at most HEMI_FACTORS_MAX */
    double tolerance;          /* absolute, of every factor; 0: 1e-5 */
    uint64_t evaluation_limit; /* of a pair; 0: 200,000 */
} hemi_factors_desc;

#define HEMI_FACTORS_MAX 8192u

/* F[i*n+j]: the fraction leaving i that reaches j, n = polygon_count; A_i F_ij = A_j F_ji holds exactly. */
typedef struct hemi_factors {
    uint32_t struct_size; /* sizeof(hemi_factors), set before the call */
    uint32_t polygon_count;
    double *areas;   /* areas[i], m2; both triangles of a quad that was taken as two */
    double *factors; /* factors[i*n+j] */
    double *errors;  /* errors[i*n+j]: estimated absolute error of factors[i*n+j] */
    uint32_t not_planar, concave, crossing, no_area, not_finite; /* polygons */
    uint64_t unconverged_pairs; /* whose error stayed above the tolerance within the evaluation limit */
    uint64_t evaluations;       /* closed forms with their visible parts */
} hemi_factors;

/* Unoccluded and partly occluded factors of all pairs, by adaptive integration of the closed form over the visible part
 * of each polygon. n^2 doubles twice are allocated; hemi_factors_free releases them. */
HEMI_API hemi_result hemi_factors_compute(hemi_context *context, const hemi_factors_desc *desc, hemi_factors *out);
/* Leaves nothing but struct_size. NULL is fine. */
HEMI_API void hemi_factors_free(hemi_factors *factors);

HEMI_C_END
#endif
