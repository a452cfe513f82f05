/* SPDX-License-Identifier: MIT
 * Which colours on the vertices that a mesh came with come closest to those that are known on it as it was cut? Those
 * of least squares over its surface [Kavan11], the same on vertices in one place that have one normal, and within what
 * is around them.
 */
#ifndef HEMIBAKE_SIMPLIFY_OWN_VERTICES_H
#define HEMIBAKE_SIMPLIFY_OWN_VERTICES_H

#include "base/block.h"

#include <hemibake/hemibake.h>

/* The mesh as it was cut, the backs behind the fronts; as in hemi_mesh_view. */
typedef struct own_vertices_input {
    const float *positions;
    const uint32_t *indices;
    const uint32_t *source_triangles; /* of the mesh as it came */
    const float *source_weights;
    uint32_t vertex_count, triangle_count;
    const float *values[2]; /* values[i][3*v+c], two kinds of them; NULL: there is none */
} own_vertices_input;

/* The mesh as it came, the backs behind the fronts; as in hemi_mesh_view, of zeros before. */
typedef struct own_vertices_mesh {
    float *positions, *normals, *source_weights;
    uint32_t *indices, *source_triangles;
} own_vertices_mesh;

/* Fills the vertices and triangles of one side, or of both, but for colours. */
void own_vertices_lay_out(const hemi_mesh_desc *m, uint32_t sides, const own_vertices_mesh *out);

/* out[i][3*v+c] at the vertices of the mesh as it came, and again for its backs if it has two sides. normals: of its
 * vertices. False when out of memory. */
bool own_vertices_fit(allocator *memory, const hemi_mesh_desc *source, const own_vertices_input *solved,
                      const float *normals, uint32_t sides, float *const out[2]);

/* out[v]: the mean of from[v] over the vertices of the mesh as it was cut that lie around a vertex of the mesh as it
 * came; 0 where none does. Both sides get that of both. False when out of memory. */
bool own_vertices_mean(allocator *memory, const hemi_mesh_desc *source, const own_vertices_input *solved,
                       const float *from, uint32_t sides, float *out);

#endif
