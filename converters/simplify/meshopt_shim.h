/* SPDX-License-Identifier: MIT
 * How are the edges of meshes collapsed? C border of the one file here that sees meshoptimizer; no exception passes it.
 * Private to this folder.
 */
#ifndef HEMIBAKE_SIMPLIFY_MESHOPT_SHIM_H
#define HEMIBAKE_SIMPLIFY_MESHOPT_SHIM_H

#include <hemibake/context.h>

HEMI_C_BEGIN

/* Collapses edges until so few indices are left, or until every further one moves the surface by more than the
 * deviation. Vertices stay where they are. Vertices at the same position are the sides of a crease, which collapses
 * along itself only. *left indices are in indices afterwards. False when out of memory. */
bool meshopt_collapse(const float *positions, size_t vertex_count, uint32_t *indices, size_t index_count,
                      size_t target_index_count, double deviation, size_t *left);

HEMI_C_END
#endif
