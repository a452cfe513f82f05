/* SPDX-License-Identifier: MIT
 * Which vertex lies in the middle of an edge? One for each pair of vertices, with one colour node for each pair of
 * nodes, so that an edge is split alike from either side and smooth neighbours stay smooth.
 */
#ifndef HEMIBAKE_CORE_MESH_EDGE_MIDPOINTS_H
#define HEMIBAKE_CORE_MESH_EDGE_MIDPOINTS_H

#include "base/pair_map.h"
#include "mesh/mesh_vertices.h"

typedef struct edge_midpoints {
    mesh_vertices *vertices;
    pair_map of_vertices, of_nodes; /* two vertices: the vertex between them; two nodes: the node between them */
} edge_midpoints;

void edge_midpoints_open(edge_midpoints *m, mesh_vertices *vertices);
void edge_midpoints_close(edge_midpoints *m);

/* The vertex between p and q, NO_INDEX when out of memory; added: it is new, and its source is to be set. */
uint32_t edge_midpoint(edge_midpoints *m, uint32_t p, uint32_t q, bool *added);

/* A new vertex halfway between two, whose source is to be set; NO_INDEX when out of memory. */
uint32_t edge_midpoints_add(const edge_midpoints *m, uint32_t p, uint32_t q, uint32_t node);

#endif
