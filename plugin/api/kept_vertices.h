/* SPDX-License-Identifier: MIT
 * Which colours have the vertices that a mesh came with, where it is to keep them? What moves by the weights of its
 * vertices cannot be cut into elements. It is solved as any mesh; then its own vertices get the colours that come
 * closest (converters/simplify/own_vertices.h).
 */
#ifndef HEMIBAKE_API_KEPT_VERTICES_H
#define HEMIBAKE_API_KEPT_VERTICES_H

#include "internal.h"

/* What was solved on a mesh, cut as it was, becomes the mesh as it came. HEMI_ERROR_MEMORY. */
hemi_result kept_vertices_fit(const hemi_scene *in, size_t mesh_index, solved_mesh *solved);

/* Makes out the mesh as it came, without colours: its vertices and triangles, those of backs behind if there are two
 * sides. False when out of memory; out is to be freed then too. */
bool kept_vertices_lay_out(allocator *memory, const hemi_mesh_desc *m, uint32_t sides, bool demodulates,
                           solved_mesh *out);

#endif
