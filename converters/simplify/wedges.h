/* SPDX-License-Identifier: MIT
 * Which corners of triangles are one vertex of a smooth surface? Corners at one position, across edges over which the
 * surface is smooth, whatever their indices are: a vertex that was split for its texture coordinates alone is whole
 * again, and one on a hard edge has a wedge for each side. Private to this folder.
 */
#ifndef HEMIBAKE_SIMPLIFY_WEDGES_H
#define HEMIBAKE_SIMPLIFY_WEDGES_H

#include "simplify.h"

#define WEDGE_NONE UINT32_MAX

/* Several meshes as one. Vertices and triangles run through them in their order. */
typedef struct wedges {
    const simplify_desc *desc;
    uint32_t *first_vertex, *first_triangle; /* of each mesh, and one past the last */
    size_t vertex_count, triangle_count;
    float *positions; /* positions[3*v+k], world, relative to the middle of the first mesh's first vertex */
    float *normals;   /* normals[3*t+k] of triangle t, in its mesh's own frame, as long as twice its area */
    uint32_t *place;  /* of vertex v */
    size_t place_count;
    uint32_t *wedge; /* wedge[3*t+k] of a corner; WEDGE_NONE in triangles that are left out */
    uint32_t wedge_count;
    uint32_t *wedge_vertex; /* a vertex of each wedge */
    bool is_rough;          /* some of what would be hard edges is noise */
    simplify_check check;
} wedges;

/* HEMI_ERROR_MEMORY */
hemi_result wedges_find(const simplify_desc *desc, wedges *out);
void wedges_free(wedges *w);

#endif
