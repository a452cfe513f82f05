/* SPDX-License-Identifier: MIT
 * What do the stages of tessellation hand to each other? For one mesh: faces (pair.c), split to pieces (split.c), added
 * to the whole (tessellate.c).
 */
#ifndef HEMIBAKE_TESSELLATE_INTERNAL_H
#define HEMIBAKE_TESSELLATE_INTERNAL_H

#include "tessellate.h"

#include "mesh/edge_midpoints.h"

/* A triangle or parallelogram of the input. Corner i of a quad: r p s q of the triangles (r p q) and (p s q). */
typedef struct face {
    uint32_t corner[4];
    uint32_t triangle[2]; /* of the mesh; [1] is NO_INDEX in a triangle */
    uint8_t rotation[2];  /* corner 0 of the face's first triangle is its corner `rotation`; p of the second likewise */
    const surface_grid *grid; /* of many such; NULL: it is one */
} face;

static inline int face_corner_count(const face *f) {
    return f->corner[3] == NO_INDEX ? 3 : 4;
}

typedef struct builder {
    const tessellate_desc *desc;
    tessellation *out;
    size_t surface_capacity, patch_capacity, element_capacity;
    const hemi_mesh_desc *mesh;
    uint32_t mesh_index;
    uint32_t *place;     /* place[v]: vertices of the mesh in one place have the same */
    uint32_t *direction; /* direction[v]: those with one normal have the same; NULL in a mesh without normals */
    uint32_t *same;      /* same[v]: the first vertex that is one with v; NULL: all are different */
    uint32_t *triangles; /* triangles[3*t+k]: corners as vertices; those dropped are NO_INDEX */
    face *faces;
    uint32_t face_count;
    pair_map edges, welds;
    edge_midpoints midpoints;
} builder;

/* Sets the normals of triangles that lie in an earlier one to 0 and counts them; counts edges of more than two. Both
 * leave b->edges empty. */
hemi_result mesh_check_drop_duplicates(builder *b, double *normals);
hemi_result mesh_check_count_edges(builder *b, const double *normals);

/* Sets b->same, by b->place, of which there are so many, and b->direction; leaves b->edges empty. */
hemi_result same_vertices_find(builder *b, uint32_t place_count);

/* Counts edges with a vertex in their middle. b->edges holds how many triangles each edge has, by places. */
hemi_result t_junctions_count(builder *b, const double *normals);

/* Makes b->faces from b->triangles. */
hemi_result pair_triangles(builder *b);

/* Makes one face of many in b->faces that are a grid, of vertices and nodes from these on. */
hemi_result merge_faces(builder *b, uint32_t first_vertex, uint32_t first_node);

/* Adds the surface of a face, its patches and elements. */
hemi_result split_face(builder *b, const face *f);

/* What is new; NULL when out of memory. */
surface *builder_add_surface(builder *b);
patch *builder_add_patch(builder *b);

/* HEMI_ERROR_LIMIT, HEMI_ERROR_MEMORY. */
hemi_result builder_add_element(builder *b, const uint32_t corner[4]);

#endif
