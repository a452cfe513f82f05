/* SPDX-License-Identifier: MIT
 * Which colours are not shared across contact lines? Elements around a vertex that only contact edges lie between are
 * in different light.
 */
#ifndef HEMIBAKE_CORE_MESH_CONTACT_NODES_H
#define HEMIBAKE_CORE_MESH_CONTACT_NODES_H

#include "base/pair_map.h"
#include "mesh/mesh.h"
#include "mesh/mesh_vertices.h"

/* contacts: pairs of nodes whose edges lie on contact lines. Around each of these nodes, elements that no other edges
 * join get nodes and vertices of their own. False when out of memory. */
bool contact_nodes_part(mesh_vertices *vertices, element *elements, size_t count, const pair_map *contacts);

#endif
