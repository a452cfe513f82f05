/* SPDX-License-Identifier: MIT
 * What do the stages of tessellation hand to each other? For one mesh: faces (pair.c), cut to pieces (split.c), added
 * to the whole (builder.c).
 */
#ifndef HEMIBAKE_TESSELLATE_INTERNAL_H
#define HEMIBAKE_TESSELLATE_INTERNAL_H

#include "pair_map.h"
#include "tessellate.h"

#include <hemibake/allocator.h>

/* A triangle or parallelogram of the input. Corner i of a quad: r p s q of the triangles (r p q) and (p s q). */
typedef struct face {
    uint32_t corner[4];
    uint32_t triangle[2]; /* of the mesh; [1] is TESSELLATE_NONE in a triangle */
    uint8_t rotation[2];  /* corner 0 of the face's first triangle is its corner `rotation`; p of the second likewise */
} face;

typedef struct builder {
    const tessellate_desc *desc;
    tessellation *out;
    size_t vertex_capacity, surface_capacity, patch_capacity, element_capacity;
    const hemi_mesh_desc *mesh;
    uint32_t mesh_index;
    uint32_t *place;     /* place[v]: vertices of the mesh in one place have the same */
    uint32_t *direction; /* direction[v]: those with one normal have the same; NULL in a mesh without normals */
    uint32_t *triangles; /* triangles[3*t+k]: corners as vertices of the tessellation; those dropped are NONE */
    face *faces;
    uint32_t face_count;
    pair_map edges, midpoints, node_midpoints, welds;
} builder;

/* The lesser of two numbers, and the greater: an edge is the same from either end. */
static inline uint64_t low_high(uint32_t a, uint32_t b, uint64_t *high) {
    *high = a > b ? a : b;
    return a > b ? b : a;
}

/* Sets the normals of triangles that lie in an earlier one to 0 and counts them; counts edges of more than two. Both
 * leave b->edges empty. */
hemi_result mesh_check_drop_duplicates(builder *b, double *normals);
hemi_result mesh_check_count_edges(builder *b, const double *normals);

/* Counts edges with a vertex in their middle. b->edges holds how many triangles each edge has, by places. */
hemi_result t_junctions_count(builder *b, const double *normals);

/* Makes b->faces from b->triangles. */
hemi_result pair_triangles(builder *b);

/* Adds the surface of a face, its patches and elements. */
hemi_result split_face(builder *b, const face *f);

/* TESSELLATE_NONE when out of memory. */
uint32_t builder_add_vertex(builder *b, const double position[3], uint32_t node);

/* Room for one more; false when out of memory. */
bool builder_grow(const builder *b, void **array, size_t *capacity, size_t count, size_t size);

#endif
