/* SPDX-License-Identifier: MIT
 * Which way does each sample look where the normals of a file make facets smooth? A sample receives by the cosine to
 * the normal that is interpolated between the vertices of its element, as renderers shade; light leaves by the facets,
 * which also hide and are hidden. So a facet shows no band, and elements are not refined to resolve facets.
 */
#ifndef HEMIBAKE_CORE_MESH_SHADING_NORMALS_H
#define HEMIBAKE_CORE_MESH_SHADING_NORMALS_H

#include "mesh/mesh.h"
#include "mesh/mesh_vertices.h"

/* The matrix of a source_mesh for a column-major affine transform, of which all zeros mean identity. */
void shading_normals_set_matrix(const double transform[16], double out[9]);

/* Sets the shading normal of a vertex whose source is set; none where the source has none or there are no normals. */
void shading_normals_set(mesh_vertices *v, const source_mesh *source, uint32_t vertex);

/* The same for all vertices of a mesh that was just tessellated, if any of the sources has normals. False when out of
 * memory. */
bool shading_normals_set_all(mesh *m, const scene *s, const source_mesh *sources, mesh_vertices *v);

/* Sets m->shading and which patches are smooth from m->normals. False when out of memory. */
bool shading_normals_sample(mesh *m, const scene *s, jobs *j, arena *memory);

/* The normal that is mixed from those of some vertices on a surface, with weights that add up to 1. False: it is that
 * of the surface. */
bool shading_normals_mix(const mesh *m, const surface *f, const uint32_t *vertices, const double *weights, int count,
                         double out[3]);

/* Where a point of a facet lies on the smooth surface that the normals of its corners tell of: each corner's plane
 * draws it up to itself as far as the corner is near, and none draws it down. A convex surface lies above all of its
 * facets, so none of them hides it from light that it faces, and no shadow ends at an edge of facets. [Hanika21]
 * False: where it is, on a facet that is a face of its own, such as that of a box whose corners share their normals, or
 * of a surface that is hollow there. */
bool shading_normals_lift(const mesh *m, const surface *f, const double point[3], double out[3]);

/* The same of a sample, which is where light is looked for from there. False: it lies on its facet, whose plane is its
 * horizon; else its horizon is that of its own normal. */
bool shading_normals_lift_sample(const mesh *m, const surface *f, bool is_smooth, size_t sample, double out[3]);

#endif
