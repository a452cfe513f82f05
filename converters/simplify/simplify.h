/* SPDX-License-Identifier: MIT
 * Which coarser mesh can be the proxy of a dense one? Its vertices are some of the dense mesh's; its surface keeps
 * within a deviation of it, with the same hard edges and limits of materials, and has as few triangles as that allows,
 * but no fewer than an edge length asks for. What depends on shape alone (who sees whom, how much light arrives) is
 * worked out on the proxy and handed back to the dense mesh by closest_point.h.
 */
#ifndef HEMIBAKE_SIMPLIFY_SIMPLIFY_H
#define HEMIBAKE_SIMPLIFY_SIMPLIFY_H

#include <hemibake/hemibake.h>

#include "base/block.h"

/* Of what goes in. */
typedef struct simplify_check {
    uint32_t degenerate_count;  /* triangles without three places, or without area */
    uint32_t duplicate_count;   /* triangles in the place of an earlier one of their mesh */
    uint32_t nonmanifold_count; /* edges of more than two triangles */
} simplify_check;

/* Meshes that share positions are simplified together, so that no gap opens between them. */
typedef struct simplify_desc {
    const hemi_mesh_desc *const *meshes;
    const bool *double_sided; /* of each mesh */
    uint32_t mesh_count;
    double edge;       /* m, world: of the triangles to end with */
    double deviation;  /* m, world: the most that a collapse may move the surface ... */
    double roughest;   /* ... or up to this where many more triangles than asked for would stay: of what is so rough,
                          light does not know the detail */
    bool keeps_area;   /* as what emits is to: it gives light by its area */
    bool is_quick;     /* what does not keep enough of its area at first stays as it is */
    allocator *memory; /* of the results and of what is needed on the way; NULL: the C library */
} simplify_desc;

/* The proxy of one mesh, in the mesh's own frame, and how the dense mesh was read. */
typedef struct simplify_mesh {
    float *positions, *normals;
    float *attributes; /* attributes[attribute_count*v+k], if the mesh has them */
    uint32_t *indices;
    uint32_t vertex_count, triangle_count;
    /* The dense mesh with as many vertices as it needs: one for each of its vertices that a triangle uses, and one more
     * for each further smooth surface that uses it. Only a mesh without normals has such. */
    uint32_t *dense_indices; /* dense_indices[3*t+k], every triangle of the mesh */
    uint32_t *dense_source;  /* dense_source[v]: corner 3*t+k of a triangle that has it */
    float *dense_normals;    /* dense_normals[3*v+k], unit: the mean over the surface around; 0 if it has no area */
    uint32_t dense_vertex_count;
} simplify_mesh;

/* out[i] of desc->meshes[i]. HEMI_ERROR_MEMORY. */
hemi_result simplify_meshes(const simplify_desc *desc, simplify_mesh *out, simplify_check *check);
void simplify_mesh_free(simplify_mesh *m);

/* group[i]: the lowest index of a mesh that mesh i is joined to by shared positions. HEMI_ERROR_MEMORY. */
hemi_result simplify_find_groups(allocator *memory, const hemi_mesh_desc *const *meshes, uint32_t mesh_count,
                                 uint32_t *group);

/* Triangles with edges of this length that cover an area. */
double simplify_triangle_count(double area, double edge);

#endif
