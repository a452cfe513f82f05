/* SPDX-License-Identifier: MIT */
#include "mesh/neighbour_nodes.h"

#include "base/pair_map.h"
#include "base/tolerance.h"
#include "base/union_find.h"

/* One less the cosine up to which two normals look the same way: 0.36 degrees, more than normals of 8 bits are off by.
 */
static const double ANOTHER = 2e-5;

/* Who has an edge: from and to in the order of the element's corners. */
typedef struct side {
    const surface *surface;
    uint32_t from, to; /* vertices */
} side;

typedef struct shared_edge {
    side side[2];
    uint8_t count; /* of the elements that have it, 3 for more */
} shared_edge;

typedef struct joining {
    const neighbour_nodes_setup *setup;
    uint32_t *place; /* of vertices: the first one in the same place */
    uint32_t *next;  /* next[v]: the first vertex of another place in the same cell, or NO_INDEX */
    pair_map cells;  /* the last such vertex of a cell */
    pair_map numbers;
    shared_edge *edges;
    size_t edge_count, edge_capacity;
    uint32_t *root; /* of nodes */
} joining;

/* ---- places ---- */

/* What meshes bring in floats meets to within some roundings. */
static double same_place(const joining *j) {
    return TOLERANCE_PLANE * j->setup->scene->radius;
}

/* The cell that holds a point when it is moved by step[k] lengths along each axis. */
static void cell_of(const double point[3], const double moved[3], double size, uint64_t key[2]) {
    uint32_t at[3];
    for (int k = 0; k < 3; k++) at[k] = (uint32_t)(int64_t)floor((point[k] + moved[k]) / size);
    key[0] = (uint64_t)at[0] << 32 | at[1];
    key[1] = at[2];
}

/* A vertex that came before, in the same place; NO_INDEX: none. */
static uint32_t find_place(const joining *j, const double point[3]) {
    double near = same_place(j);
    for (int corner = 0; corner < 8; corner++) {
        uint64_t key[2];
        const double moved[3] = { corner & 1 ? near : -near, corner & 2 ? near : -near, corner & 4 ? near : -near };
        cell_of(point, moved, 4.0 * near, key);
        for (uint32_t v = pair_map_get(&j->cells, key[0], key[1], NO_INDEX); v != NO_INDEX; v = j->next[v])
            if (vec3_distance(j->setup->vertices->positions + 3 * (size_t)v, point) <= near) return v;
    }
    return NO_INDEX;
}

static bool find_places(joining *j) {
    const double still[3] = { 0, 0, 0 };
    for (uint32_t v = 0; v < j->setup->vertices->count; v++) {
        const double *point = j->setup->vertices->positions + 3 * (size_t)v;
        j->place[v] = find_place(j, point);
        if (j->place[v] != NO_INDEX) continue;
        uint64_t key[2];
        j->place[v] = v;
        cell_of(point, still, 4.0 * same_place(j), key);
        uint32_t *last = pair_map_at(&j->cells, key[0], key[1], NO_INDEX);
        if (!last) return false;
        j->next[v] = *last;
        *last = v;
    }
    return true;
}

/* ---- edges ---- */

/* Of an element of a surface, the edge from corner k on. The two sides of a sheet have edges of their own. */
static bool note_edge(joining *j, uint32_t surface_index, const element *e, int k) {
    const scene *s = j->setup->scene;
    side one = { &s->surfaces[surface_index], e->corner[k], e->corner[(k + 1) % element_corner_count(e)] };
    bool is_back = surface_sheet(s, surface_index) != surface_index;
    uint64_t high, low = pair_order(j->place[one.from], j->place[one.to], &high);
    uint32_t *number = pair_map_at(&j->numbers, low, high | (uint64_t)is_back << 32, (uint32_t)j->edge_count);
    if (!number) return false;
    if (*number == j->edge_count) {
        if (!block_grow(j->setup->mesh->memory, (void **)&j->edges, &j->edge_capacity, j->edge_count, sizeof *j->edges))
            return false;
        j->edges[j->edge_count++] = (shared_edge){ .count = 0 };
    }
    shared_edge *edge = &j->edges[*number];
    if (edge->count < 2) edge->side[edge->count] = one;
    if (edge->count < 3) edge->count++;
    return true;
}

static bool note_edges(joining *j) {
    const mesh *m = j->setup->mesh;
    for (size_t p = 0; p < m->patch_count; p++) {
        const patch *of = &m->patches[p];
        if (j->setup->pictures[j->setup->scene->surfaces[of->surface].mesh] == NO_INDEX) continue;
        for (uint32_t i = 0; i < of->element_count; i++) {
            const element *e = &m->elements[of->first_element + i];
            for (int k = 0; k < element_corner_count(e); k++)
                if (!note_edge(j, of->surface, e, k)) return false;
        }
    }
    return true;
}

/* The shading normal at a vertex on the side of a surface, or the surface's own. */
static void normal_at(const joining *j, const surface *f, uint32_t vertex, double out[3]) {
    const source_mesh *source = &j->setup->sources[f->mesh];
    double n[3] = { 0, 0, 0 };
    if (source->normals) mesh_vertices_interpolate(j->setup->vertices, vertex, source->indices, source->normals, 3, n);
    for (int r = 0; r < 3; r++) out[r] = vec3_dot(source->normal_matrix + 3 * r, n);
    if (!(vec3_normalize(out) > 0.0)) vec3_copy(out, f->normal);
    if (vec3_dot(out, f->normal) < 0.0)
        for (int k = 0; k < 3; k++) out[k] = -out[k];
}

static void join_vertices(joining *j, const surface *f, uint32_t a, const surface *g, uint32_t b) {
    double n[3], m[3];
    normal_at(j, f, a, n);
    normal_at(j, g, b, m);
    if (vec3_dot(n, m) < 1.0 - ANOTHER) return;
    union_find_join(j->root, j->setup->vertices->nodes[a], j->setup->vertices->nodes[b]);
}

/* Do surfaces reflect, emit and let through alike? */
static bool are_alike(const joining *j, const surface *f, const surface *g) {
    const material *a = &j->setup->scene->materials[f->material], *b = &j->setup->scene->materials[g->material];
    bool alike = j->setup->pictures[f->mesh] == j->setup->pictures[g->mesh];
    for (int c = 0; c < 3; c++)
        alike = alike && a->rho[c] == b->rho[c] && a->M[c] == b->M[c] && a->transmittance[c] == b->transmittance[c] &&
                a->diffuse_transmittance[c] == b->diffuse_transmittance[c];
    return alike;
}

static void join_edge(joining *j, const side *a, const side *b) {
    if (a->surface->mesh == b->surface->mesh || !are_alike(j, a->surface, b->surface) ||
        j->place[a->from] != j->place[b->to] || j->place[a->to] != j->place[b->from])
        return;
    join_vertices(j, a->surface, a->from, b->surface, b->to);
    join_vertices(j, a->surface, a->to, b->surface, b->from);
}

bool neighbour_nodes_join(const neighbour_nodes_setup *setup) {
    allocator *memory = setup->mesh->memory;
    mesh_vertices *v = setup->vertices;
    joining j = { .setup = setup, .cells.memory = memory, .numbers.memory = memory };
    j.place = block_new(memory, (v->count + (size_t)1) * sizeof *j.place);
    j.next = block_new(memory, (v->count + (size_t)1) * sizeof *j.next);
    j.root = block_new(memory, (v->node_count + (size_t)1) * sizeof *j.root);
    bool ok = j.place && j.next && j.root && find_places(&j);
    for (uint32_t n = 0; ok && n < v->node_count; n++) j.root[n] = n;
    ok = ok && note_edges(&j);
    for (size_t i = 0; ok && i < j.edge_count; i++)
        if (j.edges[i].count == 2) join_edge(&j, &j.edges[i].side[0], &j.edges[i].side[1]);
    for (uint32_t i = 0; ok && i < v->count; i++) v->nodes[i] = union_find_root(j.root, v->nodes[i]);
    pair_map_free(&j.cells);
    pair_map_free(&j.numbers);
    block_free_all(j.place, j.next, j.root, j.edges);
    return ok;
}
