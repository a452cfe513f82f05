/* SPDX-License-Identifier: MIT
 * What is a mesh with one colour a face? Every triangle has three vertices of its own, which show the mean of what its
 * corners did: what was solved for, without the interpolation.
 */
#ifndef HEMIBAKE_API_FLAT_SHADING_H
#define HEMIBAKE_API_FLAT_SHADING_H

#include "internal.h"

/* HEMI_ERROR_MEMORY, and the mesh is as it was; HEMI_ERROR_LIMIT where vertices are more than 32 bits count. */
hemi_result flat_make(allocator *memory, solved_mesh *mesh);

#endif
