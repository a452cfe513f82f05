/* SPDX-License-Identifier: MIT
 * What is the outline of patches side by side? The edges that belong to one of them only, in order; corners that add
 * the least area are left out until few remain [Visvalingam93].
 */
#ifndef HEMIBAKE_CORE_MESH_CLUSTER_OUTLINE_H
#define HEMIBAKE_CORE_MESH_CLUSTER_OUTLINE_H

#include "mesh/mesh.h"

/* Edges of patches that are whole surfaces: 4*i+k from corner k of surface i. */
typedef struct cluster_edges {
    const scene *scene;
    const uint32_t *mate;  /* scene_find_mates */
    const uint32_t *group; /* group[i]: surfaces of one number belong together */
} cluster_edges;

/* Sets corner and corner_count of out from its surfaces. edge_count: of the edges of the outline. False if there is
 * more than one outline, as around a hole, or when out of memory. */
bool cluster_outline(const cluster_edges *e, const uint32_t *surfaces, size_t count, size_t edge_count, cluster *out);

#endif
