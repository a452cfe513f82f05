/* SPDX-License-Identifier: MIT
 * Which patches must be split because a picture glows on them? A patch shoots the mean of its elements from all of its
 * area; where a texture makes them emit unevenly, each element becomes a patch of its own.
 */
#ifndef HEMIBAKE_CORE_MESH_UNEVEN_EMITTERS_H
#define HEMIBAKE_CORE_MESH_UNEVEN_EMITTERS_H

#include "mesh/mesh.h"

/* Replaces the patches of a mesh, which are a block, and measures it again if any is split. False when out of memory.
 */
bool uneven_emitters_split(mesh *m, const scene *s, arena *memory, bool *any);

#endif
