/* SPDX-License-Identifier: MIT
 * Where does a picture begin to glow? Elements that emit share no colours with those beside them that do not: an edge
 * of an element in which a lamp of a thousand times the room's light fades to none is shown as a glow around the lamp.
 */
#ifndef HEMIBAKE_CORE_MESH_EMISSION_EDGES_H
#define HEMIBAKE_CORE_MESH_EMISSION_EDGES_H

#include "mesh/mesh.h"
#include "mesh/mesh_vertices.h"

/* Elements of the mesh, whose materials are as textures make them, get vertices and colour nodes of their own along
 * such edges. False when out of memory. */
bool emission_edges_part(scene *s, mesh *m, mesh_vertices *vertices);

#endif
