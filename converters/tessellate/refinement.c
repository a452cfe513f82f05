/* SPDX-License-Identifier: MIT
 * See refinement.h. An edge that any leaf has cut is in the map `cuts`; what is in the map and not cut by a leaf
 * itself, hangs.
 */
#include "refinement.h"

#include "internal.h"

#include "geometry/places.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A vertex this far outside a source triangle, in barycentric coordinates, is on its edge up to rounding. */
static const double ON_EDGE = 1e-6;

struct refinement {
    tessellate_desc as_desc; /* whose memory it is */
    builder grow;            /* of the tessellation's vertices */
    tessellation *t;
    const hemi_mesh_desc *meshes;
    uint32_t *surface_of; /* of each base */
    uint32_t *places;     /* places[v]: vertices in the same place have the same */
    size_t place_capacity;
    uint32_t place_count;
    pair_map cuts;      /* two places: the place between them, for edges that are cut */
    pair_map midpoints; /* two vertices: the vertex between them */
    pair_map nodes;     /* two nodes: the node between them */
    tessellate_leaf *leaves;
    uint32_t count;
};

static int corner_count(const tessellate_leaf *l) {
    return l->corner[3] == TESSELLATE_NONE ? 3 : 4;
}

/* ---- places --------------------------------------------------------------------------------------------------------
 */

static bool find_places(refinement *r) {
    size_t count = r->t->vertex_count;
    uint32_t *slots = hemi_allocate(r->t->memory, places_slot_count(count) * sizeof *slots);
    r->place_capacity = count + 1;
    r->places = hemi_allocate(r->t->memory, r->place_capacity * sizeof *r->places);
    bool ok = slots && r->places;
    if (ok) r->place_count = places_find(r->t->positions, count, slots, r->places);
    hemi_deallocate(r->t->memory, slots);
    return ok;
}

static bool set_place(refinement *r, uint32_t vertex, uint32_t place) {
    if (!builder_grow(&r->grow, (void **)&r->places, &r->place_capacity, vertex, sizeof *r->places)) return false;
    r->places[vertex] = place;
    return true;
}

/* The place in the middle of an edge that is cut, or NONE. */
static uint32_t cut_between(const refinement *r, uint32_t place, uint32_t other) {
    uint64_t high, low = low_high(place, other, &high);
    return pair_map_get(&r->cuts, low, high, TESSELLATE_NONE);
}

static uint32_t cut_of_edge(const refinement *r, const tessellate_leaf *l, int k) {
    return cut_between(r, r->places[l->corner[k]], r->places[l->corner[(k + 1) % corner_count(l)]]);
}

static bool cut_edges(refinement *r, const tessellate_leaf *l) {
    int n = corner_count(l);
    for (int k = 0; k < n; k++) {
        uint64_t high, low = low_high(r->places[l->corner[k]], r->places[l->corner[(k + 1) % n]], &high);
        uint32_t *middle = pair_map_at(&r->cuts, low, high, r->place_count);
        if (!middle) return false;
        if (*middle == r->place_count) r->place_count++;
    }
    return true;
}

/* ---- vertices ------------------------------------------------------------------------------------------------------
 */

/* Where a vertex lies in the frame of its mesh, by its source. */
static void local_position(const refinement *r, const hemi_mesh_desc *mesh, uint32_t vertex, double out[3]) {
    const uint32_t *corner = mesh->indices + 3 * (size_t)r->t->source_triangles[vertex];
    const float *w = r->t->source_weights + 3 * (size_t)vertex;
    for (int k = 0; k < 3; k++) {
        out[k] = 0.0;
        for (int i = 0; i < 3; i++) out[k] += (double)w[i] * mesh->positions[3 * (size_t)corner[i] + (size_t)k];
    }
}

/* Barycentric coordinates of a point of the triangle's plane; false if it lies outside. */
static bool inside_triangle(const hemi_mesh_desc *mesh, uint32_t triangle, const double point[3], double w[3]) {
    const uint32_t *index = mesh->indices + 3 * (size_t)triangle;
    double p[3][3];
    triangle_from_floats(p, mesh->positions, index);
    if (!triangle_weights(w, p[0], p[1], p[2], point)) return false;
    return w[0] >= -ON_EDGE && w[1] >= -ON_EDGE && w[2] >= -ON_EDGE;
}

/* Halfway between two vertices of one surface. If they have the same source triangle, so has their middle; but a vertex
 * has its source from any of the surfaces around it, so else the surface's own triangles are asked. */
static void set_source(refinement *r, uint32_t surface, uint32_t p, uint32_t q, uint32_t vertex) {
    const tessellate_surface *own = &r->t->surfaces[surface];
    const hemi_mesh_desc *mesh = &r->meshes[own->mesh];
    tessellation *t = r->t;
    float *w = t->source_weights + 3 * (size_t)vertex;
    const float *wp = t->source_weights + 3 * (size_t)p, *wq = t->source_weights + 3 * (size_t)q;
    double a[3], b[3], middle[3], found[3];
    if (t->source_triangles[p] == t->source_triangles[q]) {
        t->source_triangles[vertex] = t->source_triangles[p];
        for (int k = 0; k < 3; k++) w[k] = 0.5f * (wp[k] + wq[k]);
        return;
    }
    local_position(r, mesh, p, a);
    local_position(r, mesh, q, b);
    vec3_mid(middle, a, b);
    bool second = !inside_triangle(mesh, own->triangle[0], middle, found) && own->triangle[1] != TESSELLATE_NONE;
    if (second) inside_triangle(mesh, own->triangle[1], middle, found);
    t->source_triangles[vertex] = own->triangle[second];
    for (int k = 0; k < 3; k++) w[k] = (float)fmin(fmax(found[k], 0.0), 1.0);
}

static uint32_t add_between(refinement *r, uint32_t surface, uint32_t p, uint32_t q, uint32_t node, uint32_t place) {
    double position[3];
    vec3_mid(position, r->t->positions + 3 * (size_t)p, r->t->positions + 3 * (size_t)q);
    uint32_t v = builder_add_vertex(&r->grow, position, node);
    if (v == TESSELLATE_NONE || (r->places && !set_place(r, v, place))) return TESSELLATE_NONE;
    set_source(r, surface, p, q, v);
    return v;
}

static uint32_t node_between(refinement *r, uint32_t p, uint32_t q) {
    uint64_t high, low = low_high(r->t->nodes[p], r->t->nodes[q], &high);
    uint32_t *node = pair_map_at(&r->nodes, low, high, r->t->node_count);
    if (!node) return TESSELLATE_NONE;
    if (*node == r->t->node_count) r->t->node_count++;
    return *node;
}

/* The vertex in the middle of the edge from corner k, which is cut. NONE when out of memory. */
static uint32_t midpoint(refinement *r, const tessellate_leaf *l, int k) {
    uint32_t p = l->corner[k], q = l->corner[(k + 1) % corner_count(l)];
    uint64_t high, low = low_high(p, q, &high);
    uint32_t known = pair_map_get(&r->midpoints, low, high, TESSELLATE_NONE);
    if (known != TESSELLATE_NONE) return known;
    uint32_t node = node_between(r, p, q), place = r->places ? cut_of_edge(r, l, k) : TESSELLATE_NONE;
    if (node == TESSELLATE_NONE) return node;
    uint32_t v = add_between(r, r->surface_of[l->base], (uint32_t)low, (uint32_t)high, node, place);
    if (v == TESSELLATE_NONE || !pair_map_at(&r->midpoints, low, high, v)) return TESSELLATE_NONE;
    return v;
}

/* ---- cutting -------------------------------------------------------------------------------------------------------
 */

static void set_child(const tessellate_leaf *parent, const uint32_t corner[4], double u, double v, double size,
                      tessellate_leaf *out) {
    *out = *parent;
    memcpy(out->corner, corner, sizeof out->corner);
    out->u = parent->u + (float)u * parent->size;
    out->v = parent->v + (float)v * parent->size;
    out->size = (float)size * parent->size;
    out->level++;
    out->cut = 0;
    out->fresh = true;
}

static bool cut_triangle(refinement *r, const tessellate_leaf *l, tessellate_leaf out[4]) {
    const uint32_t *c = l->corner, none = TESSELLATE_NONE;
    uint32_t m[3];
    for (int k = 0; k < 3; k++)
        if ((m[k] = midpoint(r, l, k)) == none) return false;
    set_child(l, (uint32_t[]){ c[0], m[0], m[2], none }, 0.0, 0.0, 0.5, &out[0]);
    set_child(l, (uint32_t[]){ m[0], c[1], m[1], none }, 0.5, 0.0, 0.5, &out[1]);
    set_child(l, (uint32_t[]){ m[2], m[1], c[2], none }, 0.0, 0.5, 0.5, &out[2]);
    set_child(l, (uint32_t[]){ m[1], m[2], m[0], none }, 0.5, 0.5, -0.5, &out[3]);
    return true;
}

static bool cut_quad(refinement *r, const tessellate_leaf *l, tessellate_leaf out[4]) {
    const uint32_t *c = l->corner;
    uint32_t m[4];
    for (int k = 0; k < 4; k++)
        if ((m[k] = midpoint(r, l, k)) == TESSELLATE_NONE) return false;
    uint32_t x = add_between(r, r->surface_of[l->base], m[0], m[2], r->t->node_count, r->place_count);
    if (x == TESSELLATE_NONE) return false;
    r->t->node_count++;
    r->place_count++;
    set_child(l, (uint32_t[]){ c[0], m[0], x, m[3] }, 0.0, 0.0, 0.5, &out[0]);
    set_child(l, (uint32_t[]){ m[0], c[1], m[1], x }, 0.5, 0.0, 0.5, &out[1]);
    set_child(l, (uint32_t[]){ x, m[1], c[2], m[2] }, 0.5, 0.5, 0.5, &out[2]);
    set_child(l, (uint32_t[]){ m[3], x, m[2], c[3] }, 0.0, 0.5, 0.5, &out[3]);
    return true;
}

/* Has a neighbour of the leaf cut half of one of its edges? Then the leaf must be cut too. */
static bool is_too_coarse(const refinement *r, const tessellate_leaf *l) {
    int n = corner_count(l);
    for (int k = 0; k < n; k++) {
        uint32_t a = r->places[l->corner[k]], b = r->places[l->corner[(k + 1) % n]], m = cut_between(r, a, b);
        if (m == TESSELLATE_NONE) continue;
        if (cut_between(r, a, m) != TESSELLATE_NONE || cut_between(r, m, b) != TESSELLATE_NONE) return true;
    }
    return false;
}

/* Marks what must be cut with what is marked. Counts the marks. */
static hemi_result balance(refinement *r, bool *marks, uint32_t leaves_max, uint64_t *marked) {
    bool changed = true;
    *marked = 0;
    for (uint32_t i = 0; i < r->count; i++) {
        if (!marks[i]) continue;
        if (!cut_edges(r, &r->leaves[i])) return HEMI_ERROR_MEMORY;
        ++*marked;
    }
    while (changed && r->count + 3 * *marked <= leaves_max) {
        changed = false;
        for (uint32_t i = 0; i < r->count; i++) {
            if (marks[i] || !is_too_coarse(r, &r->leaves[i])) continue;
            if (!cut_edges(r, &r->leaves[i])) return HEMI_ERROR_MEMORY;
            marks[i] = changed = true;
            ++*marked;
        }
    }
    return r->count + 3 * *marked > leaves_max ? HEMI_ERROR_LIMIT : HEMI_OK;
}

static bool hang_vertices(refinement *r) {
    for (uint32_t i = 0; i < r->count; i++) {
        tessellate_leaf *l = &r->leaves[i];
        l->cut = 0;
        for (int k = 0; k < corner_count(l); k++) {
            if (cut_of_edge(r, l, k) == TESSELLATE_NONE) continue;
            l->mid[k] = midpoint(r, l, k);
            if (l->mid[k] == TESSELLATE_NONE) return false;
            l->cut |= (uint8_t)(1 << k);
        }
    }
    return true;
}

/* The cuts of the leaves as they are, without those of marks that were not followed. */
static hemi_result forget_cuts(refinement *r, hemi_result result) {
    if (result != HEMI_ERROR_LIMIT) return result;
    pair_map kept = { .memory = r->t->memory };
    for (uint32_t i = 0; i < r->count; i++) {
        const tessellate_leaf *l = &r->leaves[i];
        for (int k = 0; k < corner_count(l); k++) {
            if (!(l->cut & 1 << k)) continue;
            uint64_t high,
                low = low_high(r->places[l->corner[k]], r->places[l->corner[(k + 1) % corner_count(l)]], &high);
            if (!pair_map_at(&kept, low, high, r->places[l->mid[k]])) return HEMI_ERROR_MEMORY;
        }
    }
    pair_map_free(&r->cuts);
    r->cuts = kept;
    return result;
}

/* marks: which, NULL for all; marked: how many. */
static hemi_result cut_leaves(refinement *r, const bool *marks, uint64_t marked) {
    tessellate_leaf *next = hemi_allocate(r->t->memory, ((size_t)r->count + 3 * (size_t)marked + 1) * sizeof *next);
    uint32_t count = 0;
    bool ok = next;
    for (uint32_t i = 0; ok && i < r->count; i++) {
        tessellate_leaf *l = &r->leaves[i];
        l->origin = i;
        l->fresh = false;
        if (marks && !marks[i])
            next[count++] = *l;
        else if ((ok = corner_count(l) == 3 ? cut_triangle(r, l, next + count) : cut_quad(r, l, next + count)))
            count += 4;
    }
    if (!ok) {
        hemi_deallocate(r->t->memory, next);
        return HEMI_ERROR_MEMORY;
    }
    hemi_deallocate(r->t->memory, r->leaves);
    r->leaves = next;
    r->count = count;
    return HEMI_OK;
}

hemi_result refinement_split(refinement *r, bool *marks, uint32_t leaves_max) {
    uint64_t marked;
    hemi_result result = balance(r, marks, leaves_max, &marked);
    if (result != HEMI_OK) return forget_cuts(r, result);
    result = cut_leaves(r, marks, marked);
    if (result != HEMI_OK) return result;
    return hang_vertices(r) ? HEMI_OK : HEMI_ERROR_MEMORY;
}

hemi_result refinement_split_all(refinement *r, uint32_t leaves_max) {
    if (4 * (uint64_t)r->count > leaves_max) return HEMI_ERROR_LIMIT;
    hemi_deallocate(r->t->memory, r->places);
    r->places = NULL;
    hemi_result result = cut_leaves(r, NULL, r->count);
    pair_map *maps[] = { &r->cuts, &r->midpoints, &r->nodes };
    for (int i = 0; i < 3; i++) pair_map_free(maps[i]);
    return result;
}

/* ---- all of it -----------------------------------------------------------------------------------------------------
 */

static bool take_elements(refinement *r) {
    const tessellation *t = r->t;
    r->leaves = hemi_allocate(r->t->memory, ((size_t)t->element_count + 1) * sizeof *r->leaves);
    r->surface_of = hemi_allocate(r->t->memory, ((size_t)t->element_count + 1) * sizeof *r->surface_of);
    if (!r->leaves || !r->surface_of) return false;
    for (uint32_t p = 0; p < t->patch_count; p++)
        for (uint32_t i = 0; i < t->patches[p].element_count; i++)
            r->surface_of[t->patches[p].first_element + i] = t->patches[p].surface;
    for (uint32_t e = 0; e < t->element_count; e++) {
        r->leaves[e] = (tessellate_leaf){ .base = e, .origin = e, .size = 1.0f };
        memcpy(r->leaves[e].corner, t->elements[e].corner, sizeof r->leaves[e].corner);
    }
    r->count = t->element_count;
    return true;
}

hemi_result refinement_create(tessellation *t, const hemi_mesh_desc *meshes, refinement **out) {
    refinement *r = hemi_allocate(t->memory, sizeof *r);
    *out = NULL;
    if (!r) return HEMI_ERROR_MEMORY;
    memset(r, 0, sizeof *r);
    r->t = t;
    r->meshes = meshes;
    r->as_desc = (tessellate_desc){ .memory = t->memory };
    r->grow = (builder){ .desc = &r->as_desc, .out = t, .vertex_capacity = t->vertex_count };
    r->cuts.memory = r->midpoints.memory = r->nodes.memory = t->memory;
    if (take_elements(r) && find_places(r)) {
        *out = r;
        return HEMI_OK;
    }
    refinement_free(r);
    return HEMI_ERROR_MEMORY;
}

const tessellate_leaf *refinement_leaves(const refinement *r, uint32_t *count) {
    *count = r->count;
    return r->leaves;
}

void refinement_free(refinement *r) {
    if (!r) return;
    const hemi_allocator *memory = r->t->memory;
    pair_map *maps[] = { &r->cuts, &r->midpoints, &r->nodes };
    for (int i = 0; i < 3; i++) pair_map_free(maps[i]);
    hemi_deallocate(r->t->memory, r->leaves);
    hemi_deallocate(r->t->memory, r->surface_of);
    hemi_deallocate(r->t->memory, r->places);
    hemi_deallocate(memory, r);
}
