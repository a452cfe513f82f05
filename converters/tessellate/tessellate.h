/* SPDX-License-Identifier: MIT
 * How do the triangles of a scene become surfaces, patches and elements?
 *
 * Two triangles that were cut from a parallelogram, and over which every attribute is affine, become one quad again.
 * Quads are halved across their longer side, triangles from the middle of their longest edge [Rivara84], slivers across
 * both long edges, until no edge is longer than sqrt(2) times the patch size; each piece is a patch, and is split on to
 * the element size. An edge is always split in its middle and only by its own length and place, so neighbours meet
 * without T-junctions.
 *
 * Vertices that smooth neighbours share have one colour node; a crease, another material or another mesh has its own.
 */
#ifndef HEMIBAKE_TESSELLATE_H
#define HEMIBAKE_TESSELLATE_H

#include <hemibake/hemibake.h>

#include "mesh/mesh.h"
#include "mesh/mesh_vertices.h"
#include "wide_ground.h"

/* What is wrong with the triangles. */
typedef struct tessellate_check {
    uint32_t degenerate_count;  /* triangles without area, dropped */
    uint32_t duplicate_count;   /* triangles in the place of an earlier one of their mesh, dropped */
    uint32_t nonmanifold_count; /* edges of more than two triangles */
    uint32_t junction_count;    /* edges with a vertex in their middle */
    uint32_t sliver_count;      /* triangles more than twenty times as long as high */
} tessellate_check;

/* What is filled, in the core's own structs and with blocks of the desc's memory: vertices; the surfaces of the scene,
 * not measured; the patches and elements of the mesh, not measured. All are in the order of the meshes. */
typedef struct tessellation {
    mesh_vertices *vertices;
    scene *scene;
    mesh *mesh;
    tessellate_check check;
} tessellation;

typedef struct tessellate_desc {
    const hemi_mesh_desc *meshes;
    const bool *double_sided; /* of each mesh */
    const bool *is_proxy;     /* meshes whose faults are not the input's and are not counted; NULL: none */
    uint32_t mesh_count;
    double element_size, patch_size; /* m; element_size <= patch_size */
    const wide_ground *ground;       /* away from what stands on it both are larger; NULL: they are not */
    uint32_t max_elements;
    bool is_unchecked; /* what lies in each other, edges of more than two and T-junctions are not looked for */
    bool merges;       /* flat grids that are finer than elements become one surface */
    allocator *memory; /* NULL: the C library */
} tessellate_desc;

/* HEMI_ERROR_LIMIT past max_elements, HEMI_ERROR_MEMORY; arrays are to be freed then too. Indices and positions must
 * have been checked. */
hemi_result tessellate(const tessellate_desc *desc, tessellation *out);

/* How many patches of this size, m, slivers take beyond what their area does: each is drawn and shot. */
size_t tessellate_sliver_patches(const hemi_mesh_desc *meshes, size_t count, double patch_size);

/* How many shooters of this size, m, the triangles of a mesh are at most, where small ones shoot with those beside
 * them. As many as triangles when out of memory. */
size_t tessellate_shooters(allocator *memory, const hemi_mesh_desc *m, double patch_size);

/* How many times as many elements of this size, m, there are as the area alone would give: a triangle is one at least,
 * however small, and a sliver as many as it is long.  2 where all triangles are large and fat, or
 * of flat grids, which merge. */
double tessellate_crowding(allocator *memory, const hemi_mesh_desc *meshes, size_t count, double element_size);

/* The size, m, that triangles of a quarter of all area are no larger than, to a twelfth: that of quads of twice as
 * much. Flat grids, which merge, are none of these. INFINITY: they are less than a quarter. */
double tessellate_common_size(allocator *memory, const hemi_mesh_desc *meshes, size_t count);

/* Do the faces of a mesh lie in few planes, cut into columns and rows? False too when out of memory. */
bool tessellate_is_flat_grid(const hemi_mesh_desc *m, allocator *memory);

/* Frees the arrays that were filled, also those of the leaves of a mesh that was refined. */
void tessellation_free(tessellation *t);

#endif
