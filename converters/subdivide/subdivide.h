/* SPDX-License-Identifier: MIT
 * Which triangles and normals approximate the subdivision surface of a mesh?
 *
 * The triangles of the mesh are the control cage of a Catmull-Clark [Catmull78] or Loop [Loop87] surface. It is welded
 * (vertices with the same position are one), refined `level` times, and its vertices are moved to the limit surface.
 *
 *   Quads   Catmull-Clark cages are made of quads, but assets hold triangles: two triangles that lie in one plane and
 *           share an edge become the quad that they were cut from if that is convex, the most rectangular pairs
 *           first. A cube of 12 triangles is a cube again. Quads that were not planar stay two triangles.
 *   Border  Boundary edges are sharp, and so are boundary vertices that belong to one face: an open sheet keeps its
 *           outline, and its corners where one face is (Loop rounds a corner that two triangles share); two sheets
 *           that met along an edge still meet.
 *   Inside  No creases: glTF has none to give. Points where the cage touches itself are kept in place.
 *   Cut     Refined quads are cut along the shorter diagonal; of equals, the one through their first corner.
 */
#ifndef HEMIBAKE_SUBDIVIDE_SUBDIVIDE_H
#define HEMIBAKE_SUBDIVIDE_SUBDIVIDE_H

#include <hemibake/hemibake.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { SUBDIVIDE_MESSAGE_SIZE = 256 };

#define SUBDIVIDE_LEVEL_MAX 8

/* When max_triangles is 0; and its largest value, so that counts of corners fit OpenSubdiv's 32-bit indices. */
#define SUBDIVIDE_TRIANGLES_DEFAULT 4000000u
#define SUBDIVIDE_TRIANGLES_MAX     (1u << 28)

typedef struct subdivide_surface {
    float *positions;  /* positions[3*v+k], on the limit surface, in the mesh's own frame */
    float *normals;    /* normals[3*v+k], unit: of the limit surface; where it has none, the mean of the faces */
    uint32_t *indices; /* indices[3*t+k] < vertex_count; counter-clockwise as in the mesh */
    uint32_t vertex_count, triangle_count;
    uint32_t cage_faces, cage_quads; /* of the welded cage: all its faces, and those paired from two triangles */
    uint32_t dropped_triangles;      /* of the mesh: two of their corners have the same position */
} subdivide_surface;

/* Reads positions, indices, subdivision (not NONE) and subdivision_level (1..SUBDIVIDE_LEVEL_MAX); the transform,
 * normals and attributes are not looked at. max_triangles: refuse to make more; 0: the default above. The arrays are
 * owned by out (subdivide_surface_destroy). The same mesh always gives the same bits.
 * HEMI_ERROR_ARGUMENT: null pointers, scheme or level. HEMI_ERROR_DATA: an index out of range, a position that is not
 * finite, no triangles, an edge with more than two faces or with two that run the same way along it.
 * HEMI_ERROR_LIMIT: too many triangles, or too many at one vertex. HEMI_ERROR_MEMORY. HEMI_ERROR_UNSUPPORTED:
 * OpenSubdiv refuses the cage. message gets one line then and out is empty. */
hemi_result subdivide_mesh(const hemi_mesh_desc *mesh, uint32_t max_triangles, subdivide_surface *out,
                           char message[SUBDIVIDE_MESSAGE_SIZE]);

void subdivide_surface_destroy(subdivide_surface *surface); /* NULL and empty are fine */

#ifdef __cplusplus
}
#endif
#endif
