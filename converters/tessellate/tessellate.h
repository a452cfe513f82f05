/* SPDX-License-Identifier: MIT
 * How do the triangles of a scene become surfaces, patches and elements?
 *
 * Two triangles that were cut from a parallelogram, and over which every attribute is affine, become one quad again.
 * Quads are halved across their longer side, triangles from the middle of their longest edge [Rivara84], until no edge
 * is longer than sqrt(2) times the patch size; each piece is a patch, and is cut on to the element size. An edge is
 * always cut in its middle and only by its own length, so neighbours meet without T-junctions.
 *
 * Vertices that smooth neighbours share have one colour node; a crease, another material or another mesh has its own.
 */
#ifndef HEMIBAKE_TESSELLATE_H
#define HEMIBAKE_TESSELLATE_H

#include <hemibake/hemibake.h>

#define TESSELLATE_NONE UINT32_MAX

/* corner[3] is TESSELLATE_NONE in a triangle; corners are vertices of the tessellation, counter-clockwise. */
typedef struct tessellate_surface {
    uint32_t corner[4];
    uint32_t mesh;
    uint32_t triangle[2]; /* of the mesh: what the surface was; [1] is TESSELLATE_NONE unless two were one quad */
    uint32_t twin;        /* the other side of a double-sided surface, or TESSELLATE_NONE */
} tessellate_surface;

typedef struct tessellate_patch {
    uint32_t corner[4];
    uint32_t surface, first_element, element_count;
} tessellate_patch;

typedef struct tessellate_element {
    uint32_t corner[4];
} tessellate_element;

/* What one mesh owns; ranges are contiguous and in mesh order. */
typedef struct tessellate_range {
    uint32_t first_vertex, vertex_count, first_element, element_count;
} tessellate_range;

typedef struct tessellation {
    const hemi_allocator *memory;
    double *positions;          /* positions[3*v+k], world */
    uint32_t *nodes;            /* the colour node of vertex v */
    uint32_t *source_triangles; /* a triangle of the mesh that holds vertex v ... */
    float *source_weights;      /* ... and its barycentric coordinates there: source_weights[3*v+k] */
    tessellate_surface *surfaces;
    tessellate_patch *patches;
    tessellate_element *elements;
    tessellate_range *ranges; /* of each mesh */
    uint32_t vertex_count, node_count, surface_count, patch_count, element_count, mesh_count;
    uint32_t degenerate_count;  /* triangles without area, dropped */
    uint32_t duplicate_count;   /* triangles in the place of an earlier one of their mesh, dropped */
    uint32_t nonmanifold_count; /* edges of more than two triangles */
    uint32_t junction_count;    /* edges with a vertex in their middle */
    uint32_t sliver_count;      /* triangles more than twenty times as long as high */
} tessellation;

typedef struct tessellate_desc {
    const hemi_mesh_desc *meshes;
    const bool *double_sided; /* of each mesh */
    const bool *is_proxy;     /* meshes whose faults are not the input's and are not counted; NULL: none */
    uint32_t mesh_count;
    double element_size, patch_size; /* m; element_size <= patch_size */
    uint32_t max_elements;
    const hemi_allocator *memory; /* NULL: the C library; used until tessellation_free */
} tessellate_desc;

/* HEMI_ERROR_LIMIT past max_elements, HEMI_ERROR_MEMORY. Indices and positions must have been checked. */
hemi_result tessellate(const tessellate_desc *desc, tessellation *out);
void tessellation_free(tessellation *t);

#endif
