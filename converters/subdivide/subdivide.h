/* SPDX-License-Identifier: MIT
 * Which triangles, normals and attributes approximate the subdivision surface of a mesh?
 *
 * The faces of the mesh are the control cage of a Catmull-Clark [Catmull78], Loop [Loop87] or bilinear surface. It is
 * welded (vertices with the same position are one), and OpenSubdiv's evaluator says where its limit is.
 *
 *   Quads   Catmull-Clark cages are made of quads and n-gons. Where the mesh does not say its faces (face_sizes), two
 *           triangles that lie in one plane and share an edge become the quad that they were cut from if that is
 *           convex, the most rectangular pairs first. A cube of 12 triangles is a cube again. Quads that were not
 *           planar stay two triangles.
 *   Border  Boundary edges are sharp, and so are boundary vertices that belong to one face, unless the mesh asks for
 *           another rule: an open sheet keeps its outline, and its corners where one face is (Loop rounds a corner that
 *           two triangles share); two sheets that met along an edge still meet.
 *   Inside  Creases, corners and holes are those of the mesh. Points where the cage touches itself are kept in place.
 *   Split   A vertex of the surface is split where its sides differ: normals at a hard edge, attributes at a seam. All
 *           attributes are one face-varying channel: a seam of one of them is a seam of all.
 *   Levels  Uniform refinement cuts every edge into 2^level. Adaptive refinement cuts each face until no facet turns by
 *           more than SUBDIVIDE_TURN and its border strays as little from its chords, and an edge as its finer face.
 *   Cut     Refined quads are cut along the shorter diagonal; of equals, the one through their first corner.
 */
#ifndef HEMIBAKE_SUBDIVIDE_SUBDIVIDE_H
#define HEMIBAKE_SUBDIVIDE_SUBDIVIDE_H

#include <hemibake/hemibake.h>

HEMI_C_BEGIN

enum { SUBDIVIDE_MESSAGE_SIZE = 256 };

#define SUBDIVIDE_LEVEL_MAX 8

/* Sharpness from here on is a hard edge: OpenSubdiv's own bound. */
#define SUBDIVIDE_SHARPNESS_MAX 10.0f

/* Adaptive refinement stops when the corners of a facet differ in direction by less than this (radians, 10 degrees): a
 * chord of a circle is then 0.4 % of the radius inside it at most. */
#define SUBDIVIDE_TURN 0.1745

/* When max_triangles is 0; and its largest value, so that counts of corners fit OpenSubdiv's 32-bit indices. */
#define SUBDIVIDE_TRIANGLES_DEFAULT 4000000u
#define SUBDIVIDE_TRIANGLES_MAX     (1u << 28)

typedef struct subdivide_surface {
    const hemi_allocator *memory; /* that the arrays are from; NULL: the C library */
    float *positions;             /* positions[3*v+k], on the limit surface, in the mesh's own frame */
    float *normals;    /* normals[3*v+k], unit: of the limit surface; where it has none, the mean of the faces */
    float *attributes; /* attributes[attribute_count*v+k]; NULL if the mesh has none */
    uint32_t *indices; /* indices[3*t+k] < vertex_count; counter-clockwise as in the mesh */
    uint32_t attribute_count;
    uint32_t vertex_count, triangle_count;
    uint32_t cage_faces, cage_quads; /* of the welded cage: all its faces, and those paired from two triangles */
    uint32_t dropped_triangles;      /* of the mesh: two corners of a face have the same position */
} subdivide_surface;

/* memory: NULL for the C library; used until the surface is destroyed. Reads positions, attributes, indices,
 * subdivision (not NULL; its scheme not NONE, its level 1..SUBDIVIDE_LEVEL_MAX); the transform and normals are not
 * looked at. max_triangles: refuse to make more by uniform refinement; 0: the default above. The arrays are
 * owned by out (subdivide_surface_destroy). The same mesh always gives the same bits. HEMI_ERROR_ARGUMENT: null
 * pointers, scheme, rule or level. HEMI_ERROR_DATA: an index out of range, a position that is not finite, no triangles,
 * faces that are no fans, an edge with more than two faces or with two that run the same way along it, a crease that is
 * no edge, nothing left between holes. HEMI_ERROR_LIMIT: too many triangles, or too many at one vertex.
 * HEMI_ERROR_MEMORY. HEMI_ERROR_UNSUPPORTED: OpenSubdiv refuses the cage, or n-gons under Loop. message gets one line
 * then and out is empty. */
hemi_result subdivide_mesh(const hemi_allocator *memory, const hemi_mesh_desc *mesh, uint32_t max_triangles,
                           subdivide_surface *out, char message[SUBDIVIDE_MESSAGE_SIZE]);

void subdivide_surface_destroy(subdivide_surface *surface); /* NULL and empty are fine */

HEMI_C_END
#endif
