/* SPDX-License-Identifier: MIT
 * Which colours do meshes share that go on in each other? A floor of tiles is one floor: where two meshes of one
 * material meet edge to edge and look the same way there, the two vertices at either end have one colour node.
 */
#ifndef HEMIBAKE_CORE_MESH_NEIGHBOUR_NODES_H
#define HEMIBAKE_CORE_MESH_NEIGHBOUR_NODES_H

#include "mesh/mesh.h"
#include "mesh/mesh_vertices.h"

typedef struct neighbour_nodes_setup {
    const scene *scene; /* measured */
    const mesh *mesh;   /* not measured */
    mesh_vertices *vertices;
    const source_mesh *sources; /* of each mesh of the scene */
    const uint32_t *pictures;   /* pictures[mesh]: equal where surfaces have the same; NO_INDEX: shares with none */
} neighbour_nodes_setup;

/* An edge counts where two elements of different meshes and no others have it, and run along it in opposite ways: so of
 * sheets that lie on each other, and of the two sides of one, none is joined. False when out of memory. */
bool neighbour_nodes_join(const neighbour_nodes_setup *setup);

#endif
