/* SPDX-License-Identifier: MIT */
#include "mesh/contact_nodes.h"

#include "mesh/triangulation.h"

#include <stdlib.h>

/* A corner of an element at a node, or a vertex that hangs there, and the nodes at the other ends of its two edges. */
typedef struct corner {
    uint32_t node, vertex, element, before, after;
    uint32_t group; /* the first corner of the node that is joined to it */
    uint8_t place;  /* of the element */
} corner;

typedef struct parting {
    mesh_vertices *vertices;
    element *elements;
    const pair_map *contacts;
    corner *corners;
    size_t count, capacity;
} parting;

static bool is_contact(const parting *p, uint32_t a, uint32_t b) {
    uint64_t high, low = pair_order(a, b, &high);
    return pair_map_get(p->contacts, low, high, 0) != 0;
}

/* The corners of all elements at nodes of contact edges. */
static bool list_corners(parting *p, size_t count, const bool *touched) {
    const uint32_t *nodes = p->vertices->nodes;
    for (size_t e = 0; e < count; e++) {
        const element *one = &p->elements[e];
        uint8_t ring[ELEMENT_PLACES];
        int n = element_ring(one, ring);
        for (int k = 0; k < n; k++) {
            uint32_t vertex = element_vertex(one, ring[k]), node = nodes[vertex];
            if (!touched[node]) continue;
            if (!block_grow(p->vertices->memory, (void **)&p->corners, &p->capacity, p->count, sizeof *p->corners))
                return false;
            p->corners[p->count++] = (corner){ .node = node,
                                               .vertex = vertex,
                                               .element = (uint32_t)e,
                                               .before = nodes[element_vertex(one, ring[(k + n - 1) % n])],
                                               .after = nodes[element_vertex(one, ring[(k + 1) % n])],
                                               .place = ring[k] };
        }
    }
    return true;
}

static int compare_corners(const void *a, const void *b) {
    const corner *x = a, *y = b;
    if (x->node != y->node) return x->node < y->node ? -1 : 1;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    return (x->place > y->place) - (x->place < y->place);
}

/* Do two corners at a node have an edge in common that is no contact? */
static bool are_joined(const parting *p, const corner *a, const corner *b) {
    const uint32_t ends[2] = { a->before, a->after };
    for (int i = 0; i < 2; i++)
        if ((ends[i] == b->before || ends[i] == b->after) && !is_contact(p, a->node, ends[i])) return true;
    return false;
}

static uint32_t root_of(corner *around, uint32_t i) {
    while (around[i].group != i) i = around[i].group = around[around[i].group].group;
    return i;
}

static uint32_t *vertex_at(const parting *p, const corner *c) {
    element *e = &p->elements[c->element];
    return c->place < 4 ? &e->corner[c->place] : &e->middle[c->place - 4];
}

/* Gives a group of corners, of which the first is given, a node of its own. */
static bool renew_group(parting *p, const corner *around, size_t count, size_t first) {
    uint32_t node = p->vertices->node_count++;
    for (size_t i = first; i < count; i++) {
        uint32_t copy = NO_INDEX;
        if (around[i].group != around[first].group) continue;
        for (size_t j = first; j < i && copy == NO_INDEX; j++)
            if (around[j].group == around[i].group && around[j].vertex == around[i].vertex)
                copy = *vertex_at(p, &around[j]);
        if (copy == NO_INDEX) copy = mesh_vertices_copy(p->vertices, around[i].vertex, node);
        if (copy == NO_INDEX) return false;
        *vertex_at(p, &around[i]) = copy;
    }
    return true;
}

static bool part_node(parting *p, corner *around, size_t count) {
    for (uint32_t i = 0; i < count; i++) around[i].group = i;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < i; j++) {
            uint32_t a = root_of(around, i), b = root_of(around, j);
            if (a != b && are_joined(p, &around[i], &around[j])) around[a > b ? a : b].group = a > b ? b : a;
        }
    for (uint32_t i = 0; i < count; i++) around[i].group = root_of(around, i);
    for (uint32_t i = 1; i < count; i++)
        if (around[i].group == i && !renew_group(p, around, count, i)) return false;
    return true;
}

static void mark_touched(const parting *p, size_t count, bool *touched) {
    for (size_t e = 0; e < count; e++) {
        const element *one = &p->elements[e];
        uint8_t ring[ELEMENT_PLACES];
        int n = element_ring(one, ring);
        for (int k = 0; k < n; k++) {
            uint32_t a = p->vertices->nodes[element_vertex(one, ring[k])],
                     b = p->vertices->nodes[element_vertex(one, ring[(k + 1) % n])];
            if (is_contact(p, a, b)) touched[a] = touched[b] = true;
        }
    }
}

bool contact_nodes_part(mesh_vertices *vertices, element *elements, size_t count, const pair_map *contacts) {
    parting p = { .vertices = vertices, .elements = elements, .contacts = contacts };
    bool *touched = block_zeroed(vertices->memory, vertices->node_count + (size_t)1, sizeof *touched);
    bool ok = touched;
    if (ok) mark_touched(&p, count, touched);
    ok = ok && list_corners(&p, count, touched);
    if (ok && p.count > 1) qsort(p.corners, p.count, sizeof *p.corners, compare_corners);
    for (size_t first = 0, end; ok && first < p.count; first = end) {
        for (end = first; end < p.count && p.corners[end].node == p.corners[first].node;) end++;
        ok = part_node(&p, p.corners + first, end - first);
    }
    block_free_all(touched, p.corners);
    return ok;
}
