/* SPDX-License-Identifier: MIT
 * How do colours at vertices become the meshes that a host reads?
 */
#ifndef HEMIBAKE_API_OUTPUT_MESH_H
#define HEMIBAKE_API_OUTPUT_MESH_H

#include "build_scene.h"

#include "bake/bake.h"

/* Fills the meshes of a solution, and the statistics that are theirs. HEMI_ERROR_MEMORY. */
hemi_result output_meshes(const hemi_scene *in, const bake_options *options, const bake_scene *f,
                          const vertex_colors *colors, hemi_solution *out);

/* Makes a mesh as it came, without colours: its vertices and triangles, those of backs behind if there are two sides.
 * False when out of memory; out is to be freed then too. */
bool output_mesh_as_it_came(allocator *memory, const hemi_mesh_desc *m, uint32_t sides, bool demodulates,
                            bool has_errors, solved_mesh *out);

/* The same by each group of lights, once the meshes are there. */
hemi_result output_light_groups(const hemi_scene *in, const bake_options *options, const bake_scene *f,
                                const bake_result *found, hemi_solution *out);

#endif
