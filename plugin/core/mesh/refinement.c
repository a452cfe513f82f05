/* SPDX-License-Identifier: MIT
 * See refinement.h. An edge that any leaf has split is in the map `splits`; what is in the map and not split by a leaf
 * itself, hangs.
 */
#include "mesh/refinement.h"

#include "geometry/places.h"
#include "mesh/edge_midpoints.h"
#include "mesh/element_parts.h"
#include "mesh/shading_normals.h"

#include <string.h>

struct refinement {
    refinement_setup setup;
    allocator *memory;
    uint32_t *places; /* places[v]: vertices in the same place have the same; NULL: not asked for any more */
    size_t place_capacity;
    uint32_t place_count;
    bool *is_end; /* of places: of an edge that is split, or was. Most are not, which spares the map */
    size_t is_end_capacity;
    pair_map splits; /* two places: the place between them, for edges that are split */
    edge_midpoints midpoints;
    leaf *leaves;
    element *elements; /* of the leaves; at first those of the mesh */
    element *previous; /* of the leaves before the last split, which a mesh of leaves may hold */
    uint32_t count;
};

/* ---- places ---- */

static bool set_place(refinement *r, uint32_t vertex, uint32_t place) {
    if (!block_grow(r->memory, (void **)&r->places, &r->place_capacity, vertex, sizeof *r->places)) return false;
    r->places[vertex] = place;
    return true;
}

/* The ends of an edge that is split. */
static bool mark_ends(refinement *r, uint64_t low, uint64_t high) {
    size_t before = r->is_end_capacity;
    if (high >= before) {
        size_t room = (size_t)high + 1 > 2 * before ? (size_t)high + 1 : 2 * before;
        if (!block_reserve(r->memory, (void **)&r->is_end, &r->is_end_capacity, room, sizeof *r->is_end)) return false;
        memset(r->is_end + before, 0, (room - before) * sizeof *r->is_end);
    }
    r->is_end[low] = r->is_end[high] = true;
    return true;
}

static uint32_t split_at(const refinement *r, uint64_t low, uint64_t high) {
    if (high >= r->is_end_capacity || !r->is_end[low] || !r->is_end[high]) return NO_INDEX;
    return pair_map_get(&r->splits, low, high, NO_INDEX);
}

/* The place in the middle of an edge that is split, or NO_INDEX. */
static uint32_t split_between(const refinement *r, uint32_t place, uint32_t other) {
    uint64_t high, low = pair_order(place, other, &high);
    return split_at(r, low, high);
}

/* The places at the ends of the edge from corner k of an element. */
static uint64_t edge_places(const refinement *r, const element *e, int k, uint64_t *high) {
    return pair_order(r->places[e->corner[k]], r->places[e->corner[(k + 1) % element_corner_count(e)]], high);
}

static uint32_t split_of_edge(const refinement *r, const element *e, int k) {
    uint64_t high, low = edge_places(r, e, k, &high);
    return split_at(r, low, high);
}

static bool split_edges(refinement *r, const element *e) {
    for (int k = 0; k < element_corner_count(e); k++) {
        uint64_t high, low = edge_places(r, e, k, &high);
        uint32_t *middle = pair_map_at(&r->splits, low, high, r->place_count);
        if (!middle || !mark_ends(r, low, high)) return false;
        if (*middle == r->place_count) r->place_count++;
    }
    return true;
}

/* ---- vertices ---- */

static void set_source(refinement *r, const element *e, uint32_t p, uint32_t q, uint32_t vertex) {
    const surface *own = &r->setup.scene->surfaces[r->setup.mesh->patches[e->patch].surface];
    const source_mesh *source = &r->setup.sources[own->mesh];
    mesh_vertices_set_source(r->setup.vertices, source, own, (uint32_t[]){ p, q }, (double[]){ 0.5, 0.5 }, 2, vertex);
    shading_normals_set(r->setup.vertices, source, vertex);
}

/* The vertex in the middle of the edge from corner k, which is split. NO_INDEX when out of memory. */
static uint32_t midpoint(refinement *r, const element *e, int k) {
    uint32_t a = e->corner[k], b = e->corner[(k + 1) % element_corner_count(e)];
    uint64_t high, low = pair_order(a, b, &high);
    bool added;
    uint32_t v = edge_midpoint(&r->midpoints, a, b, &added);
    if (v == NO_INDEX || !added) return v;
    if (r->places && !set_place(r, v, split_of_edge(r, e, k))) return NO_INDEX;
    set_source(r, e, (uint32_t)low, (uint32_t)high, v);
    return v;
}

/* The vertex in the middle of a quad, with a node of its own. NO_INDEX when out of memory. */
static uint32_t middle_of_quad(refinement *r, const element *e, uint32_t p, uint32_t q) {
    uint32_t v = edge_midpoints_add(&r->midpoints, p, q, r->setup.vertices->node_count);
    if (v == NO_INDEX || (r->places && !set_place(r, v, r->place_count))) return NO_INDEX;
    set_source(r, e, p, q, v);
    r->setup.vertices->node_count++;
    r->place_count++;
    return v;
}

/* ---- splitting ---- */

/* The leaves that there will be. */
typedef struct generation {
    element *elements;
    leaf *leaves;
    uint32_t count, sample_count;
} generation;

/* The leaf and element that come next; its samples follow those of the one before. */
static leaf *add_leaf(const element *e, const leaf *l, generation *next) {
    leaf *out = &next->leaves[next->count];
    *out = *l;
    out->first_sample = next->sample_count;
    next->sample_count += l->sample_count;
    next->elements[next->count++] = *e;
    return out;
}

static void add_child(const element *parent, const leaf *of, const element_part *part, generation *next) {
    leaf *l = add_leaf(parent, of, next);
    element *e = &next->elements[next->count - 1];
    memcpy(e->corner, part->corner, sizeof e->corner);
    e->hanging = 0;
    l->u = of->u + (float)part->u * of->size;
    l->v = of->v + (float)part->v * of->size;
    l->size = (float)part->size * of->size;
    l->level++;
    l->is_new = true;
}

static bool split_leaf(refinement *r, const element *e, const leaf *l, generation *next) {
    uint32_t own = r->setup.mesh->patches[e->patch].surface, middle[4] = { 0 }, center = NO_INDEX;
    element_part parts[ELEMENT_PARTS];
    for (int k = 0; k < element_corner_count(e); k++)
        if ((middle[k] = midpoint(r, e, k)) == NO_INDEX) return false;
    if (element_corner_count(e) == 4 && (center = middle_of_quad(r, e, middle[0], middle[2])) == NO_INDEX) return false;
    element_parts(e->corner, middle, center, surface_sheet(r->setup.scene, own) != own, parts);
    for (int i = 0; i < ELEMENT_PARTS; i++) add_child(e, l, &parts[i], next);
    return true;
}

/* Has a neighbour of the leaf split half of one of its edges? Then the leaf must be split too. */
static bool is_too_coarse(const refinement *r, const element *e) {
    int n = element_corner_count(e);
    for (int k = 0; k < n; k++) {
        uint32_t a = r->places[e->corner[k]], b = r->places[e->corner[(k + 1) % n]], m = split_between(r, a, b);
        if (m == NO_INDEX) continue;
        if (split_between(r, a, m) != NO_INDEX || split_between(r, m, b) != NO_INDEX) return true;
    }
    return false;
}

/* Marks what must be split with what is marked. Counts the marks. */
static refinement_result balance(refinement *r, bool *marks, uint32_t leaves_max, uint64_t *marked) {
    bool changed = true;
    *marked = 0;
    for (uint32_t i = 0; i < r->count; i++) {
        if (!marks[i]) continue;
        if (!split_edges(r, &r->elements[i])) return REFINEMENT_NO_MEMORY;
        ++*marked;
    }
    while (changed && r->count + 3 * *marked <= leaves_max) {
        changed = false;
        for (uint32_t i = 0; i < r->count; i++) {
            if (marks[i] || !is_too_coarse(r, &r->elements[i])) continue;
            if (!split_edges(r, &r->elements[i])) return REFINEMENT_NO_MEMORY;
            marks[i] = changed = true;
            ++*marked;
        }
    }
    return r->count + 3 * *marked > leaves_max ? REFINEMENT_LIMIT : REFINEMENT_OK;
}

static bool constrain_hanging_nodes(refinement *r) {
    for (uint32_t i = 0; i < r->count; i++) {
        element *e = &r->elements[i];
        e->hanging = 0;
        for (int k = 0; k < element_corner_count(e); k++) {
            if (split_of_edge(r, e, k) == NO_INDEX) continue;
            e->middle[k] = midpoint(r, e, k);
            if (e->middle[k] == NO_INDEX) return false;
            e->hanging |= (uint8_t)(1 << k);
        }
    }
    return true;
}

/* The splits of the leaves as they are, without those of marks that were not followed. */
static bool forget_splits(refinement *r) {
    pair_map kept = { .memory = r->memory };
    bool ok = true;
    for (uint32_t i = 0; ok && i < r->count; i++) {
        const element *e = &r->elements[i];
        for (int k = 0; ok && k < element_corner_count(e); k++) {
            if (!(e->hanging & 1 << k)) continue;
            uint64_t high, low = edge_places(r, e, k, &high);
            ok = pair_map_at(&kept, low, high, r->places[e->middle[k]]);
        }
    }
    pair_map_free(&r->splits);
    r->splits = kept;
    return ok;
}

/* marks: which, NULL for all; marked: how many. */
static bool split_leaves(refinement *r, const bool *marks, uint64_t marked) {
    size_t room = (size_t)r->count + 3 * (size_t)marked + 1;
    generation next = { .elements = block_new(r->memory, room * sizeof *next.elements),
                        .leaves = block_new(r->memory, room * sizeof *next.leaves) };
    bool ok = next.elements && next.leaves;
    for (uint32_t i = 0; ok && i < r->count; i++) {
        const element *e = &r->elements[i];
        leaf *l = &r->leaves[i];
        l->origin = l->first_sample;
        l->is_new = false;
        if (marks && !marks[i])
            add_leaf(e, l, &next);
        else
            ok = split_leaf(r, e, l, &next);
    }
    if (ok) {
        block_free(r->leaves);
        if (r->previous != r->setup.mesh->elements) block_free(r->previous);
        r->previous = r->elements;
        r->elements = next.elements;
        r->leaves = next.leaves;
        r->count = next.count;
        return true;
    }
    block_free_all(next.elements, next.leaves);
    return false;
}

/* Vertices may have moved when some were added. */
static void follow(const refinement *r) {
    mesh *m = r->setup.mesh;
    r->setup.scene->vertices = m->vertices = r->setup.vertices->positions;
    m->nodes = r->setup.vertices->nodes;
    m->node_count = r->setup.vertices->node_count;
    m->normals = r->setup.vertices->normals;
}

refinement_result refinement_split(refinement *r, bool *marks, uint32_t leaves_max) {
    uint64_t marked;
    refinement_result result = balance(r, marks, leaves_max, &marked);
    if (result == REFINEMENT_LIMIT && !forget_splits(r)) return REFINEMENT_NO_MEMORY;
    if (result != REFINEMENT_OK) return result;
    bool ok = split_leaves(r, marks, marked) && constrain_hanging_nodes(r);
    follow(r);
    return ok ? REFINEMENT_OK : REFINEMENT_NO_MEMORY;
}

refinement_result refinement_split_all(refinement *r, uint32_t leaves_max) {
    if (4 * (uint64_t)r->count > leaves_max) return REFINEMENT_LIMIT;
    block_free(r->places);
    r->places = NULL;
    bool ok = split_leaves(r, NULL, r->count);
    follow(r);
    pair_map_free(&r->splits);
    edge_midpoints_close(&r->midpoints);
    return ok ? REFINEMENT_OK : REFINEMENT_NO_MEMORY;
}

/* The edges that are split as the elements come: where vertices hang. */
static bool find_splits(refinement *r) {
    for (uint32_t i = 0; i < r->count; i++) {
        const element *e = &r->elements[i];
        for (int k = 0; e->hanging && k < element_corner_count(e); k++) {
            if (!(e->hanging & 1 << k)) continue;
            uint64_t high, low = edge_places(r, e, k, &high);
            if (!pair_map_at(&r->splits, low, high, r->places[e->middle[k]]) || !mark_ends(r, low, high)) return false;
        }
    }
    return true;
}

refinement *refinement_create(const refinement_setup *setup) {
    allocator *memory = setup->mesh->memory;
    refinement *r = block_zeroed(memory, 1, sizeof *r);
    if (!r) return NULL;
    r->setup = *setup;
    r->memory = r->splits.memory = memory;
    edge_midpoints_open(&r->midpoints, setup->vertices);
    r->count = (uint32_t)setup->mesh->element_count;
    r->elements = r->previous = setup->mesh->elements;
    r->leaves = block_new(memory, ((size_t)r->count + 1) * sizeof *r->leaves);
    for (uint32_t e = 0; r->leaves && e < r->count; e++)
        r->leaves[e] = (leaf){ .root = e,
                               .first_sample = r->elements[e].first_sample,
                               .size = 1.0f,
                               .sample_count = (uint8_t)element_corner_count(&r->elements[e]) };
    r->place_capacity = (size_t)setup->vertices->count + 1;
    r->places = places_new(memory, setup->vertices->positions, setup->vertices->count, &r->place_count);
    if (r->leaves && r->places && find_splits(r)) return r;
    refinement_free(r);
    return NULL;
}

const leaf *refinement_leaves(const refinement *r, uint32_t *count) {
    *count = r->count;
    return r->leaves;
}

void refinement_free(refinement *r) {
    if (!r) return;
    element *roots = r->setup.mesh->elements;
    pair_map_free(&r->splits);
    edge_midpoints_close(&r->midpoints);
    if (r->previous != roots) block_free(r->previous);
    if (r->elements != roots) block_free(r->elements);
    block_free_all(r->leaves, r->places, r->is_end, r);
}

/* ---- meshes of leaves ---- */

/* Patches with the ranges of their leaves, of those from begin to end; out may be where the mesh's patches are. */
static void set_patches(const refinement *r, uint32_t begin, uint32_t end, bool only_new, patch *out) {
    uint32_t next = 0, i = begin;
    for (size_t p = 0; p < r->setup.mesh->patch_count; p++) {
        const patch from = r->setup.mesh->patches[p];
        out[p] = from;
        out[p].first_element = next;
        for (; i < end && r->leaves[i].root < from.first_element + from.element_count; i++)
            next += !only_new || r->leaves[i].is_new;
        out[p].element_count = next - out[p].first_element;
    }
}

static mesh mesh_of(const refinement *r, patch *patches, element *elements, size_t count) {
    return (mesh){ .memory = r->memory,
                   .vertices = r->setup.vertices->positions,
                   .vertex_count = r->setup.vertices->count,
                   .nodes = r->setup.vertices->nodes,
                   .node_count = r->setup.vertices->node_count,
                   .normals = r->setup.vertices->normals,
                   .patches = patches,
                   .patch_count = r->setup.mesh->patch_count,
                   .elements = elements,
                   .element_count = count,
                   .clustering = r->setup.mesh->clustering };
}

bool refinement_mesh(const refinement *r, arena *memory, mesh *out) {
    patch *patches = arena_alloc(memory, r->setup.mesh->patch_count, sizeof *patches);
    if (!patches) return false;
    set_patches(r, 0, r->count, false, patches);
    *out = mesh_of(r, patches, r->elements, r->count);
    return mesh_measure_in_scene(out, r->setup.scene, r->setup.jobs, memory);
}

bool refinement_mesh_of_new(const refinement *r, uint32_t begin, uint32_t end, arena *memory, mesh *out) {
    size_t count = 0;
    for (uint32_t i = begin; i < end; i++) count += r->leaves[i].is_new;
    patch *patches = arena_alloc(memory, r->setup.mesh->patch_count, sizeof *patches);
    element *elements = arena_alloc(memory, count, sizeof *elements), *next = elements;
    if (!patches || !elements) return false;
    for (uint32_t i = begin; i < end; i++)
        if (r->leaves[i].is_new) *next++ = r->elements[i];
    set_patches(r, begin, end, true, patches);
    *out = mesh_of(r, patches, elements, count);
    return mesh_measure_in_scene(out, r->setup.scene, r->setup.jobs, memory);
}

bool refinement_finish(refinement *r, arena *memory) {
    mesh *m = r->setup.mesh;
    set_patches(r, 0, r->count, false, m->patches);
    if (r->previous != m->elements) block_free(r->previous);
    if (r->elements != m->elements) block_free(m->elements);
    r->previous = r->elements;
    *m = mesh_of(r, m->patches, r->elements, r->count);
    return mesh_measure_in_scene(m, r->setup.scene, r->setup.jobs, memory);
}
