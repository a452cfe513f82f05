/* SPDX-License-Identifier: MIT */
#include "mesh/edge_midpoints.h"

#include "scene/scene.h"

void edge_midpoints_open(edge_midpoints *m, mesh_vertices *vertices) {
    *m = (edge_midpoints){ .vertices = vertices,
                           .of_vertices.memory = vertices->memory,
                           .of_nodes.memory = vertices->memory };
}

void edge_midpoints_close(edge_midpoints *m) {
    pair_map_free(&m->of_vertices);
    pair_map_free(&m->of_nodes);
}

static uint32_t node_between(edge_midpoints *m, uint32_t p, uint32_t q) {
    mesh_vertices *v = m->vertices;
    uint64_t high, low = pair_order(v->nodes[p], v->nodes[q], &high);
    uint32_t *node = pair_map_at(&m->of_nodes, low, high, v->node_count);
    if (!node) return NO_INDEX;
    if (*node == v->node_count) v->node_count++;
    return *node;
}

uint32_t edge_midpoints_add(const edge_midpoints *m, uint32_t p, uint32_t q, uint32_t node) {
    double position[3];
    vec3_mid(position, m->vertices->positions + 3 * (size_t)p, m->vertices->positions + 3 * (size_t)q);
    return mesh_vertices_add(m->vertices, position, node);
}

uint32_t edge_midpoint(edge_midpoints *m, uint32_t p, uint32_t q, bool *added) {
    uint64_t high, low = pair_order(p, q, &high);
    uint32_t known = pair_map_get(&m->of_vertices, low, high, NO_INDEX);
    *added = known == NO_INDEX;
    if (!*added) return known;
    uint32_t node = node_between(m, p, q);
    uint32_t v = node == NO_INDEX ? node : edge_midpoints_add(m, (uint32_t)low, (uint32_t)high, node);
    if (v == NO_INDEX || !pair_map_at(&m->of_vertices, low, high, v)) return NO_INDEX;
    return v;
}
