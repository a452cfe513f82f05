/* SPDX-License-Identifier: MIT
 * Where does refinement put the vertices on the limit? C border of the one file that sees OpenSubdiv; no exception
 * passes it. Private to this folder.
 */
#ifndef HEMIBAKE_SUBDIVIDE_OSD_SHIM_H
#define HEMIBAKE_SUBDIVIDE_OSD_SHIM_H

#include "cage.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct osd_points {
    double *positions; /* positions[3*v+k], on the limit surface; malloc'ed, as all three */
    double *normals;   /* normals[3*v+k]: tangent times tangent, of any length, 0 where the surface has no tangents */
    int *corners;      /* corners[face_size*f+k] */
    uint32_t vertex_count, face_count, face_size; /* 4: Catmull-Clark, 3: Loop */
} osd_points;

/* level 1..SUBDIVIDE_LEVEL_MAX; a Loop cage is all triangles. */
hemi_result osd_refine(const cage *c, hemi_subdivision scheme, uint32_t level, osd_points *out,
                       char message[SUBDIVIDE_MESSAGE_SIZE]);
void osd_points_destroy(osd_points *points);

#ifdef __cplusplus
}
#endif
#endif
