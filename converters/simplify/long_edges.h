/* SPDX-License-Identifier: MIT
 * Which edges of a dense mesh are too long for the colours at their ends, and how are its triangles cut there? What has
 * many small triangles in its corners may have large faces between them: furniture with round edges. An edge of a
 * triangle that is not a sliver is halved while it is longer than a limit, from either side alike.
 */
#ifndef HEMIBAKE_SIMPLIFY_LONG_EDGES_H
#define HEMIBAKE_SIMPLIFY_LONG_EDGES_H

#include <hemibake/hemibake.h>

#include "base/block.h"

/* A vertex of the cut mesh: where it lies on a triangle of the dense one. */
typedef struct cut_vertex {
    uint32_t triangle;
    float weights[3];
} cut_vertex;

typedef struct cut_mesh {
    allocator *memory;
    cut_vertex *vertices; /* those of the dense mesh come first */
    uint32_t *indices;    /* indices[3*t+k] */
    uint32_t vertex_count, triangle_count;
    size_t vertex_room, index_room;
} cut_mesh;

/* indices[3*t+k] and source[v], a corner 3*t+k that has vertex v: of the dense mesh with as many vertices as it needs
 * (simplify_mesh). limit: m, world. False when out of memory; to be freed all the same. */
bool long_edges_cut(allocator *memory, const hemi_mesh_desc *dense, const uint32_t *indices, const uint32_t *source,
                    uint32_t vertex_count, double limit, cut_mesh *out);
void cut_mesh_free(cut_mesh *c);

/* What a vertex is to have: facing is the way that the surface around it looks. attributes: as many as the dense mesh
 * has, or NULL. */
typedef struct cut_place {
    float *position, *normal, *attributes, *facing;
} cut_place;

/* indices as above, normals of the vertices that they name; back: of the side that looks the other way. */
void cut_vertex_place(const cut_vertex *v, const hemi_mesh_desc *dense, const uint32_t *indices, const float *normals,
                      bool back, const cut_place *out);

/* Its triangles, and those of its backs behind them where it has two sides: wound the other way, with vertices that
 * follow those of the fronts. */
void cut_mesh_triangles(const cut_mesh *m, uint32_t sides, uint32_t *indices);

#endif
