/* SPDX-License-Identifier: MIT
 * Which polygons does a .vs3 file hold? Plain lists of vertices and surfaces, as NIST's View3D reads them:
 *
 *     T title                            (anything; ignored)
 *     C eps=1e-4 encl=1 ...              options of View3D; ignored
 *     F 3                                geometry in three dimensions
 *     ! a comment
 *     V n x y z                          vertex number n, 1 and up
 *     S n v1 v2 v3 v4 base cmb emit name surface; v4 = 0: a triangle. Corners counter-clockwise seen from the front
 *     O n v1 v2 v3 v4 ...                obstruction: blocks, has no row
 *     End of data
 */
#ifndef HEMIBAKE_VS3_SCENE_H
#define HEMIBAKE_VS3_SCENE_H

#include <hemibake/hemibake.h>

enum { VS3_MESSAGE_SIZE = 256, VS3_NAME_SIZE = 32 };

typedef struct vs3_scene {
    double *positions;  /* positions[3*v+k] */
    int32_t *corners;   /* corners[4*i+c]; [4*i+3] is -1 in a triangle */
    bool *obstructions; /* of polygon i */
    char (*names)[VS3_NAME_SIZE];
    uint32_t vertex_count, polygon_count;
    uint32_t combined; /* surfaces that ask to be combined with another (cmb): rows stay apart */
} vs3_scene;

/* HEMI_ERROR_FILE, _DATA (message: "line 12: what is wrong"), _UNSUPPORTED (subsurfaces: base not 0), _LIMIT, _MEMORY.
 */
hemi_result vs3_parse(const void *bytes, size_t size, vs3_scene *out, char message[VS3_MESSAGE_SIZE]);

void vs3_scene_free(vs3_scene *s);

#endif
