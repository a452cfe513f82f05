/* SPDX-License-Identifier: MIT
 * Which small patches shoot as one? On tessellated curves and scans patches follow the triangles and not the light: a
 * sphere of a thousand facets would shoot a thousand times what fifty shooters give as well. Patches side by side, of
 * one material and one mesh, that face nearly the same way are merged, two by two, until they are as large as is asked
 * for; of all pairs those first whose union is the most compact. Such a cluster shoots by its outline: the closed form
 * asks for no more, planar or not.
 *
 * Emitters shoot alone unless there are very many, and so does what has holes. The face clustering is that of
 * [Garland01] with another cost.
 */
#ifndef HEMIBAKE_CORE_MESH_CLUSTER_H
#define HEMIBAKE_CORE_MESH_CLUSTER_H

#include "mesh/mesh.h"

typedef struct cluster_desc {
    double size;   /* m: no cluster's bounding box has a longer diagonal */
    double angle;  /* radians: no member's normal is further from that of its cluster */
    bool emitters; /* what emits goes together too */
} cluster_desc;

/* Fills out from memory and sets m->clustering to it; leaves it NULL if nothing can be merged. s->neighbours must have
 * been found. False when out of memory. */
bool clusters_find(const scene *s, const cluster_desc *desc, arena *memory, mesh *m, clustering *out);

#endif
