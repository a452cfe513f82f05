/* SPDX-License-Identifier: MIT */
#include "mesh/emission_edges.h"

#include "mesh/contact_nodes.h"
#include "mesh/triangulation.h"

/* Beside an element, one that emits less than this share of what it does is dark: what a picture's glow fades by from
 * one element to the next is less steep, and stays smooth. */
static const double DARK_BESIDE = 0.02;

/* The least and the most that the elements at an edge emit, by the number of the edge. */
typedef struct edge_emission {
    double low, high;
} edge_emission;

typedef struct emission_edges {
    const mesh *mesh;
    pair_map numbers; /* of edges, by their nodes */
    edge_emission *edges;
    size_t count, capacity;
} emission_edges;

/* Does any surface emit more in one place than in another? */
static bool any_uneven(const mesh *m, const scene *s) {
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        if (element_emission(e) > 0.0 &&
            e->material != &s->materials[s->surfaces[m->patches[e->patch].surface].material])
            return true;
    }
    return false;
}

static edge_emission *edge_at(emission_edges *all, uint32_t a, uint32_t b) {
    uint64_t high, low = pair_order(all->mesh->nodes[a], all->mesh->nodes[b], &high);
    uint32_t *number = pair_map_at(&all->numbers, low, high, (uint32_t)all->count);
    if (!number) return NULL;
    if (*number < all->count) return &all->edges[*number];
    if (!block_grow(all->mesh->memory, (void **)&all->edges, &all->capacity, all->count, sizeof *all->edges))
        return NULL;
    all->edges[all->count] = (edge_emission){ INFINITY, 0.0 };
    return &all->edges[all->count++];
}

static bool list_edges(emission_edges *all) {
    for (size_t i = 0; i < all->mesh->element_count; i++) {
        const element *e = &all->mesh->elements[i];
        uint8_t ring[ELEMENT_PLACES];
        int places = element_ring(e, ring);
        double M = element_emission(e);
        for (int k = 0; k < places; k++) {
            edge_emission *edge = edge_at(all, element_vertex(e, ring[k]), element_vertex(e, ring[(k + 1) % places]));
            if (!edge) return false;
            edge->low = fmin(edge->low, M), edge->high = fmax(edge->high, M);
        }
    }
    return true;
}

/* jumps: the pairs of nodes at whose edge emission ends. */
static bool find_jumps(emission_edges *all, pair_map *jumps) {
    for (size_t i = 0; i < all->mesh->element_count; i++) {
        const element *e = &all->mesh->elements[i];
        uint8_t ring[ELEMENT_PLACES];
        int places = element_ring(e, ring);
        for (int k = 0; k < places; k++) {
            uint32_t a = element_vertex(e, ring[k]), b = element_vertex(e, ring[(k + 1) % places]);
            const edge_emission *edge = edge_at(all, a, b);
            uint64_t high, low = pair_order(all->mesh->nodes[a], all->mesh->nodes[b], &high);
            bool jumps_here = edge && edge->high > 0.0 && edge->low < DARK_BESIDE * edge->high;
            if (!edge || (jumps_here && !pair_map_at(jumps, low, high, 1))) return false;
        }
    }
    return true;
}

bool emission_edges_part(scene *s, mesh *m, mesh_vertices *vertices) {
    emission_edges all = { .mesh = m, .numbers.memory = m->memory };
    pair_map jumps = { .memory = m->memory };
    if (!any_uneven(m, s)) return true;
    bool ok = list_edges(&all) && find_jumps(&all, &jumps);
    if (ok && jumps.count > 0) {
        ok = contact_nodes_part(vertices, m->elements, m->element_count, &jumps);
        s->vertices = m->vertices = vertices->positions;
        s->vertex_count = m->vertex_count = vertices->count;
        m->nodes = vertices->nodes;
        m->node_count = vertices->node_count;
        m->normals = vertices->normals;
    }
    pair_map_free(&all.numbers);
    pair_map_free(&jumps);
    block_free(all.edges);
    return ok;
}
