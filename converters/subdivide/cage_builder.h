/* SPDX-License-Identifier: MIT
 * What do the stages of making a cage hand to each other? Welded faces and their edges (cage.c), pairs of triangles
 * (cage_quads.c), creases, holes and face-varying values (cage_features.c). Private to this folder.
 */
#ifndef HEMIBAKE_SUBDIVIDE_CAGE_BUILDER_H
#define HEMIBAKE_SUBDIVIDE_CAGE_BUILDER_H

#include "cage.h"

typedef struct cage_edge {
    uint32_t low, high; /* cage vertices */
    uint32_t face;
    uint32_t corner; /* that the edge leaves */
    uint32_t next;   /* the corner that it reaches */
} cage_edge;

/* Faces as they come from the mesh, before triangles are paired. */
typedef struct cage_builder {
    const hemi_mesh_desc *mesh;
    const hemi_subdivision_desc *how; /* the mesh's */
    uint32_t *welded;                 /* welded[v]: cage vertex of mesh vertex v; UINT32_MAX if no triangle uses it */
    uint32_t *sources;                /* sources[c]: mesh vertex of corner c */
    uint32_t *corners;                /* corners[c]: its cage vertex */
    uint32_t *first;                  /* corners of face f: first[f] .. first[f+1]-1 */
    uint32_t *origins;                /* origins[f]: which face of the mesh it was */
    uint32_t *pieces;                 /* pieces[f]: which face of the cage it is part of */
    cage_edge *edges;                 /* sorted by their ends; one a corner */
    size_t *partners;                 /* of triangle f: the first of the two edges it is paired at, or SIZE_MAX */
    bool *holes;                      /* of the faces of the mesh */
    uint32_t *stamps;                 /* the last face that came to a cage vertex, plus 1 */
    uint32_t face_count, corner_count, mesh_face_count;
    cage *out;
    char *message;
} cage_builder;

hemi_result cage_out_of_memory(const cage_builder *b);

bool cage_same_edge(const cage_edge *a, const cage_edge *b);

/* Whether two corners at one vertex have the same attributes. */
bool cage_same_values(const cage_builder *b, uint32_t corner, uint32_t other);

/* Finds b->partners. */
hemi_result cage_pair_triangles(cage_builder *b);

/* Corners of the quad of two triangles on the edge edges[first], edges[first + 1]. */
void cage_quad_corners(const cage_builder *b, size_t first, uint32_t corners[4]);

/* Marks b->holes, before pairing; the rest once faces are final. final_sources[c]: mesh vertex of cage corner c. */
hemi_result cage_mark_holes(cage_builder *b);
hemi_result cage_add_features(cage_builder *b, const uint32_t *final_sources);

#endif
