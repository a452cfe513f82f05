/* SPDX-License-Identifier: MIT */
#include "mesh/contact_edges.h"

#include "geometry/places.h"

bool contact_edges_open(const refinement_setup *setup, contact_edges *out) {
    uint32_t place_count = 0;
    allocator *memory = setup->mesh->memory;
    *out =
        (contact_edges){ .setup = setup,
                         .places = places_new(memory, setup->vertices->positions, setup->vertices->count, &place_count),
                         .first.memory = memory,
                         .vertices.memory = memory,
                         .nodes.memory = memory };
    out->is_end = block_zeroed(memory, place_count + (size_t)1, sizeof *out->is_end);
    return out->places && out->is_end;
}

void contact_edges_close(contact_edges *c) {
    pair_map_free(&c->first);
    pair_map_free(&c->vertices);
    pair_map_free(&c->nodes);
    block_free_all(c->places, c->is_end, c->points);
}

/* The places at the ends of the edge from corner k. */
static uint64_t edge_places(const contact_edges *c, const element *e, int k, uint64_t *high) {
    return pair_order(c->places[e->corner[k]], c->places[e->corner[(k + 1) % element_corner_count(e)]], high);
}

uint32_t contact_edges_first(const contact_edges *c, const element *e, int k) {
    uint64_t high, low = edge_places(c, e, k, &high);
    if (!c->is_end[low] || !c->is_end[high]) return NO_INDEX;
    return pair_map_get(&c->first, low, high, NO_INDEX);
}

static uint32_t add_point(contact_edges *c, const element *e, int k, double at[3]) {
    uint64_t high, low = edge_places(c, e, k, &high);
    uint32_t *first = pair_map_at(&c->first, low, high, NO_INDEX);
    uint32_t a = e->corner[k], b = e->corner[(k + 1) % element_corner_count(e)];
    if (!first || !block_grow(c->setup->mesh->memory, (void **)&c->points, &c->capacity, c->count, sizeof *c->points))
        return NO_INDEX;
    const double *positions = c->setup->vertices->positions;
    const double *from = positions + 3 * (size_t)(c->places[a] == low ? a : b),
                 *to = positions + 3 * (size_t)(c->places[a] == low ? b : a);
    double edge[3], offset[3];
    vec3_sub(edge, to, from);
    vec3_sub(offset, at, from);
    edge_point *p = &c->points[c->count];
    *p = (edge_point){ .t = vec3_dot(edge, offset) / vec3_dot(edge, edge), .next = *first };
    vec3_add_scaled(p->at, from, p->t, edge);
    vec3_copy(at, p->at);
    c->is_end[low] = c->is_end[high] = true;
    return *first = (uint32_t)c->count++;
}

uint32_t contact_edges_point(contact_edges *c, const element *e, int k, double at[3], double reach) {
    uint32_t best = NO_INDEX;
    for (uint32_t i = contact_edges_first(c, e, k); i != NO_INDEX; i = c->points[i].next) {
        double distance = vec3_distance(c->points[i].at, at);
        if (distance <= reach) reach = distance, best = i;
    }
    if (best == NO_INDEX) return add_point(c, e, k, at);
    vec3_copy(at, c->points[best].at);
    return best;
}

uint32_t contact_edges_vertex(contact_edges *c, const surface *on, uint32_t a, uint32_t b, uint32_t point) {
    mesh_vertices *v = c->setup->vertices;
    uint64_t high, low = pair_order(a, b, &high);
    uint32_t *known = pair_map_at(&c->vertices, low << 32 | high, point, NO_INDEX);
    if (!known || *known != NO_INDEX) return known ? *known : NO_INDEX;
    low = pair_order(v->nodes[a], v->nodes[b], &high);
    uint32_t *node = pair_map_at(&c->nodes, low << 32 | high, point, v->node_count);
    if (!node) return NO_INDEX;
    if (*node == v->node_count) v->node_count++;
    *known = mesh_vertices_add(v, c->points[point].at, *node);
    if (*known == NO_INDEX) return NO_INDEX;
    double t = c->points[point].t, of_b = c->places[a] <= c->places[b] ? t : 1.0 - t;
    mesh_vertices_set_source(v, &c->setup->sources[on->mesh], on, (uint32_t[]){ a, b }, (double[]){ 1.0 - of_b, of_b },
                             2, *known);
    return *known;
}
