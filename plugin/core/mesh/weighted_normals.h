/* SPDX-License-Identifier: MIT
 * Do the normals of a file tell of the surface that it has? Modelling programs give a bevelled edge a plain mean of
 * normals: those of a window sill, 25 cm wide, lean as those of its bevels do, which are 2 mm wide, and the sill, which
 * is flat, would be lit as a cushion. Where faces around a vertex are as uneven as that, its normal is the
 * mean of theirs by area; where facets make a smooth shape the two are about the same, and the file's stays.
 */
#ifndef HEMIBAKE_CORE_MESH_WEIGHTED_NORMALS_H
#define HEMIBAKE_CORE_MESH_WEIGHTED_NORMALS_H

#include "base/arena.h"
#include "mesh/mesh_vertices.h"

/* Has a mesh take other normals, in memory of the arena, where any of its own should be. False when out of memory. */
bool weighted_normals(source_mesh *m, size_t vertex_count, size_t triangle_count, arena *memory);

#endif
