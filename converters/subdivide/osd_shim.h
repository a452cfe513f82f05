/* SPDX-License-Identifier: MIT
 * Where is the limit surface of a cage? C border of the one file that sees OpenSubdiv; no exception passes it. Private
 * to this folder.
 */
#ifndef HEMIBAKE_SUBDIVIDE_OSD_SHIM_H
#define HEMIBAKE_SUBDIVIDE_OSD_SHIM_H

#include "cage.h"

HEMI_C_BEGIN

/* Two faces whose normals differ by less than this at a shared point (radians, half a degree) are smooth there: the
 * evaluator's own roundings are far below, creases that anyone sees are far above. */
#define OSD_SMOOTH 0.01

/* Two faces share a face-varying value if theirs differ by less than this, relative to the largest: rounding of a
 * double evaluation is 1e-15, of the float attributes 1e-7. */
#define OSD_SAME_VALUE 1e-6

/* A cross product of tangents below this, relative to the square of what its face spans, is rounding: no direction. */
#define OSD_NO_TANGENT 1e-12

typedef struct osd_points {
    const hemi_allocator *memory;
    double *positions; /* positions[3*v+k], on the limit surface; from memory, as all */
    double *normals;   /* normals[3*v+k]: of any length, 0 where the surface has no tangents */
    double *values;    /* values[value_width*v+k]; NULL if the cage has none */
    int *facets;       /* facets[4*f+k]; [4*f+3] is -1 in a triangle */
    uint32_t vertex_count, facet_count;
} osd_points;

/* The scheme, level and rules are those of the mesh that c was made of, and have been checked. */
hemi_result osd_limit(const cage *c, const hemi_subdivision_desc *how, osd_points *out,
                      char message[SUBDIVIDE_MESSAGE_SIZE]);
void osd_points_destroy(osd_points *points);

HEMI_C_END
#endif
