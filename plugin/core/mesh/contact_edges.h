/* SPDX-License-Identifier: MIT
 * Where are edges of elements cut, and what is the vertex there? Edges are known by the places of their ends, so that
 * whoever has an edge there, on the other side of a crease or in another mesh, is cut in the same points.
 */
#ifndef HEMIBAKE_CORE_MESH_CONTACT_EDGES_H
#define HEMIBAKE_CORE_MESH_CONTACT_EDGES_H

#include "base/pair_map.h"
#include "mesh/refinement.h"

/* A point on an edge, from the end whose place has the lesser number. */
typedef struct edge_point {
    double t, at[3];
    uint32_t next; /* on the same edge, or NO_INDEX */
} edge_point;

typedef struct contact_edges {
    const refinement_setup *setup;
    uint32_t *places;
    bool *is_end;   /* of places: of an edge that has a point. Most are not, which spares the maps */
    pair_map first; /* two places: the first point between them */
    edge_point *points;
    size_t count, capacity;
    pair_map vertices, nodes; /* an edge and a point on it: what they are called */
} contact_edges;

/* False when out of memory. */
bool contact_edges_open(const refinement_setup *setup, contact_edges *out);
void contact_edges_close(contact_edges *c);

/* The first point on the edge from corner k of an element, or NO_INDEX. */
uint32_t contact_edges_first(const contact_edges *c, const element *e, int k);

/* The point on it that is nearest to `at`, and no further than `reach`, or a new one; `at` becomes where it is.
 * NO_INDEX when out of memory. */
uint32_t contact_edges_point(contact_edges *c, const element *e, int k, double at[3], double reach);

/* The vertex in a point of the edge between two vertices, on a surface; NO_INDEX when out of memory. */
uint32_t contact_edges_vertex(contact_edges *c, const surface *on, uint32_t a, uint32_t b, uint32_t point);

#endif
