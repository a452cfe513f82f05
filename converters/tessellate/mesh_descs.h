/* SPDX-License-Identifier: MIT
 * How large are meshes, and where are their triangles in the world?
 */
#ifndef HEMIBAKE_TESSELLATE_MESH_DESCS_H
#define HEMIBAKE_TESSELLATE_MESH_DESCS_H

#include <hemibake/hemibake.h>

#include "geometry/triangle_bvh.h"

/* The diagonal of the box around the vertices of meshes, m, world. */
double mesh_descs_extent(const hemi_mesh_desc *const *meshes, size_t count);

/* Area of the triangles, m2, world. */
double mesh_desc_area(const hemi_mesh_desc *m);

/* How many triangles they have, and of those that are of materials that emit; and do any let light through? */
double mesh_descs_count(const hemi_mesh_desc *meshes, size_t count);
size_t mesh_descs_emitting(const hemi_mesh_desc *meshes, size_t count, const hemi_material_desc *materials);
bool mesh_descs_transmit(const hemi_mesh_desc *meshes, size_t count, const hemi_material_desc *materials);

/* Where a normal at a point of it, both its own, is turned to in the world: an arrow from that point, of any length. */
void mesh_desc_world_normal(const hemi_mesh_desc *m, const float position[3], const float normal[3], float out[3]);

/* By how much its transform makes it larger, at most: along the longest axis. */
double mesh_desc_scale(const hemi_mesh_desc *m);
double mesh_descs_area(const hemi_mesh_desc *meshes, size_t count);

/* In memory of the jobs, in the order of the meshes, fronts as they are where a transform mirrors; mesh_of[i] is the
 * mesh of triangle i. Both are the caller's to free, also where this is false: out of memory. */
bool mesh_descs_triangles(jobs *j, const hemi_mesh_desc *meshes, size_t count, triangle_bvh *out, uint32_t **mesh_of);

/* How many balls' worth of directions a mesh looks in: the solid angle that its normals sweep, in whole ones. A ball has
 * 1, whatever its size, a rough stone many; a mesh without normals is taken for a ball. */
double mesh_desc_balls(const hemi_mesh_desc *m);

#endif
