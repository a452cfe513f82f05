/* SPDX-License-Identifier: MIT
 * See tessellate.h. One mesh at a time: corners to vertices, triangles to faces, faces to patches and elements, and the
 * backs of double-sided meshes as mirror images behind.
 */
#include "tessellate.h"

#include "internal.h"

#include "base/union_find.h"
#include "geometry/places.h"
#include "geometry/plane.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <string.h>

/* ---- arrays that grow by doubling; what is new is all zero ------------------------------------------------------- */

surface *builder_add_surface(builder *b) {
    scene *s = b->out->scene;
    if (!block_grow(s->memory, (void **)&s->surfaces, &b->surface_capacity, s->surface_count, sizeof *s->surfaces))
        return NULL;
    return memset(&s->surfaces[s->surface_count++], 0, sizeof *s->surfaces);
}

patch *builder_add_patch(builder *b) {
    mesh *m = b->out->mesh;
    if (!block_grow(m->memory, (void **)&m->patches, &b->patch_capacity, m->patch_count, sizeof *m->patches))
        return NULL;
    return memset(&m->patches[m->patch_count++], 0, sizeof *m->patches);
}

hemi_result builder_add_element(builder *b, const uint32_t corner[4]) {
    mesh *m = b->out->mesh;
    if (m->element_count >= b->desc->max_elements) return HEMI_ERROR_LIMIT;
    if (!block_grow(m->memory, (void **)&m->elements, &b->element_capacity, m->element_count, sizeof *m->elements))
        return HEMI_ERROR_MEMORY;
    element *e = memset(&m->elements[m->element_count++], 0, sizeof *e);
    memcpy(e->corner, corner, sizeof e->corner);
    return HEMI_OK;
}

/* ---- corners of a mesh ------------------------------------------------------------------------------------------- */

/* Height over longest edge of a triangle that is called a sliver. */
static const double SLIVER_RATIO = 0.05;

/* Unit normal of a triangle in the world, and whether it has an area there: a transform may flatten a mesh. */
static bool plane_normal(const hemi_mesh_desc *m, const uint32_t index[3], double n[3], bool *sliver) {
    double p[3][3];
    for (int i = 0; i < 3; i++) hemi_transform_point(m->transform, m->positions + 3 * (size_t)index[i], p[i]);
    triangle_cross(n, p[0], p[1], p[2]);
    double twice_area = vec3_normalize(n), longest_squared = triangle_longest_squared(p[0], p[1], p[2]);
    *sliver = twice_area < SLIVER_RATIO * longest_squared;
    return !triangle_is_degenerate(twice_area, longest_squared);
}

/* Which vertices of the mesh are in one place, and which have one normal. */
static hemi_result find_places(builder *b) {
    allocator *memory = b->desc->memory;
    size_t count = b->mesh->vertex_count;
    uint32_t *slots = block_new(memory, places_slot_count(count) * sizeof *slots);
    b->place = block_new(memory, count * sizeof *b->place);
    b->direction = b->mesh->normals ? block_new(memory, count * sizeof *b->direction) : NULL;
    bool ok = slots && b->place && (b->direction || !b->mesh->normals);
    uint32_t places = ok ? places_find_floats(b->mesh->positions, count, slots, b->place) : 0;
    if (ok && b->direction) places_find_floats(b->mesh->normals, count, slots, b->direction);
    block_free(slots);
    return ok ? same_vertices_find(b, places) : HEMI_ERROR_MEMORY;
}

/* The vertex of a corner: corners with the same index, or the same in all that it has, are one vertex (of one plane, if
 * the mesh brings no normals);
 * vertices with the same position and normal share a colour node. */
static uint32_t corner_vertex(builder *b, uint32_t index, uint64_t plane) {
    const hemi_mesh_desc *m = b->mesh;
    uint64_t own = m->normals ? 0 : plane;
    if (b->same) index = b->same[index];
    uint32_t *known = pair_map_at(&b->edges, (uint64_t)index | UINT64_C(1) << 62, own, NO_INDEX);
    if (!known) return NO_INDEX;
    if (*known != NO_INDEX) return *known;
    uint64_t normal = m->normals ? b->direction[index] : plane;
    uint32_t *node = pair_map_at(&b->welds, b->place[index], normal, NO_INDEX);
    if (!node) return NO_INDEX;
    if (*node == NO_INDEX) *node = b->out->vertices->node_count++;
    double position[3];
    hemi_transform_point(m->transform, m->positions + 3 * (size_t)index, position);
    return *known = mesh_vertices_add(b->out->vertices, position, *node);
}

/* ---- planes of a mesh without normals ---------------------------------------------------------------------------- */

enum { EDGE_PLANES = 8 };

/* Joins triangle t to the one on an edge (two positions) that lies in its plane, if there is one. Up to EDGE_PLANES
 * planes can meet in an edge and be told apart. */
static hemi_result join_on_edge(builder *b, const double *normals, uint32_t *planes, uint32_t t, uint64_t low,
                                uint64_t high) {
    for (uint64_t i = 0; i < EDGE_PLANES; i++) {
        uint32_t *other = pair_map_at(&b->edges, low, i << 32 | high, t);
        if (!other) return HEMI_ERROR_MEMORY;
        if (*other == t) return HEMI_OK;
        if (!plane_continues(normals + 3 * (size_t)t, normals + 3 * (size_t)*other, TOLERANCE_SAME_PLANE)) continue;
        planes[union_find_root(planes, *other)] = union_find_root(planes, t);
        return HEMI_OK;
    }
    return HEMI_OK;
}

/* On its three edges. normals[3*t+k] is all 0 for a dropped triangle. */
static hemi_result join_planes(builder *b, const double *normals, uint32_t *planes, uint32_t t) {
    hemi_result result = HEMI_OK;
    const uint32_t *index = b->mesh->indices + 3 * (size_t)t;
    for (int k = 0; result == HEMI_OK && k < 3; k++) {
        uint64_t high, low = pair_order(b->place[index[k]], b->place[index[(k + 1) % 3]], &high);
        result = join_on_edge(b, normals, planes, t, low, high);
    }
    return result;
}

/* Finds the planes of all triangles; sets each triangle's normal. */
static hemi_result find_planes(builder *b, double *normals, uint32_t *planes) {
    hemi_result result = HEMI_OK;
    for (uint32_t t = 0; t < b->mesh->triangle_count; t++) {
        bool sliver;
        planes[t] = t;
        if (plane_normal(b->mesh, b->mesh->indices + 3 * (size_t)t, normals + 3 * (size_t)t, &sliver)) {
            b->out->check.sliver_count += sliver;
            continue;
        }
        memset(normals + 3 * (size_t)t, 0, 3 * sizeof *normals);
        b->out->check.degenerate_count++;
    }
    if (!b->desc->is_unchecked) result = mesh_check_drop_duplicates(b, normals);
    if (!b->desc->is_unchecked && result == HEMI_OK) result = mesh_check_count_edges(b, normals);
    for (uint32_t t = 0; result == HEMI_OK && !b->mesh->normals && t < b->mesh->triangle_count; t++) {
        if (!vec3_is_zero(normals + 3 * (size_t)t)) result = join_planes(b, normals, planes, t);
    }
    pair_map_clear(&b->edges);
    return result;
}

/* ---- corners ----------------------------------------------------------------------------------------------------- */

static hemi_result add_corners(builder *b, const double *normals, uint32_t *planes) {
    for (uint32_t t = 0; t < b->mesh->triangle_count; t++) {
        const uint32_t *index = b->mesh->indices + 3 * (size_t)t;
        uint32_t *corner = b->triangles + 3 * (size_t)t;
        corner[0] = corner[1] = corner[2] = NO_INDEX;
        if (vec3_is_zero(normals + 3 * (size_t)t)) continue;
        uint64_t plane = union_find_root(planes, t);
        for (int k = 0; k < 3; k++) {
            corner[k] = corner_vertex(b, index[k], plane);
            if (corner[k] == NO_INDEX) return HEMI_ERROR_MEMORY;
        }
    }
    return HEMI_OK;
}

static void reverse(uint32_t corner[4], uint32_t offset) {
    int n = corner[3] == NO_INDEX ? 3 : 4;
    uint32_t front[4];
    memcpy(front, corner, sizeof front);
    for (int i = 0; i < n; i++) corner[i] = front[n - 1 - i] + offset;
}

/* How much there was before a mesh. */
typedef struct extent {
    uint32_t vertices, nodes;
    size_t surfaces, patches, elements;
} extent;

static extent extent_of(const tessellation *t) {
    return (extent){ t->vertices->count, t->vertices->node_count, t->scene->surface_count, t->mesh->patch_count,
                     t->mesh->element_count };
}

/* Mirror transforms turn every triangle over. */
static void reverse_triangles(const tessellation *out, const extent *before) {
    for (size_t i = before->surfaces; i < out->scene->surface_count; i++) reverse(out->scene->surfaces[i].corner, 0);
    for (size_t i = before->patches; i < out->mesh->patch_count; i++) reverse(out->mesh->patches[i].corner, 0);
    for (size_t i = before->elements; i < out->mesh->element_count; i++) reverse(out->mesh->elements[i].corner, 0);
}

static bool add_back_vertices(mesh_vertices *vertices, const extent *before, const extent *fronts) {
    uint32_t node_offset = fronts->nodes - before->nodes;
    for (uint32_t v = before->vertices; v < fronts->vertices; v++)
        if (mesh_vertices_copy(vertices, v, vertices->nodes[v] + node_offset) == NO_INDEX) return false;
    vertices->node_count += node_offset;
    return true;
}

static bool add_back_surface(builder *b, size_t front, uint32_t vertex_offset) {
    surface *back = builder_add_surface(b);
    if (!back) return false;
    scene *s = b->out->scene;
    *back = s->surfaces[front];
    reverse(back->corner, vertex_offset);
    back->twin = (uint32_t)front;
    s->surfaces[front].twin = (uint32_t)s->surface_count - 1;
    return true;
}

static bool add_back_patch(builder *b, size_t front, const extent *before, const extent *fronts) {
    patch *back = builder_add_patch(b);
    if (!back) return false;
    *back = b->out->mesh->patches[front];
    reverse(back->corner, fronts->vertices - before->vertices);
    back->surface += (uint32_t)(fronts->surfaces - before->surfaces);
    back->first_element += (uint32_t)(fronts->elements - before->elements);
    return true;
}

/* The backs of all that the mesh has added: the same pieces with their own vertices and nodes, wound the other way. */
static hemi_result add_backs(builder *b, const extent *before) {
    const extent fronts = extent_of(b->out);
    uint32_t vertex_offset = fronts.vertices - before->vertices;
    hemi_result result = HEMI_OK;
    bool ok = add_back_vertices(b->out->vertices, before, &fronts);
    for (size_t i = before->surfaces; ok && i < fronts.surfaces; i++) ok = add_back_surface(b, i, vertex_offset);
    for (size_t i = before->patches; ok && i < fronts.patches; i++) ok = add_back_patch(b, i, before, &fronts);
    for (size_t i = before->elements; ok && result == HEMI_OK && i < fronts.elements; i++) {
        uint32_t corner[4];
        memcpy(corner, b->out->mesh->elements[i].corner, sizeof corner);
        reverse(corner, vertex_offset);
        result = builder_add_element(b, corner);
    }
    return ok ? result : HEMI_ERROR_MEMORY;
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

/* The vertices of b->triangles. */
static hemi_result find_corners(builder *b) {
    size_t triangles = b->mesh->triangle_count;
    double *normals = block_new(b->desc->memory, (3 * triangles + 1) * sizeof *normals);
    uint32_t *planes = block_new(b->desc->memory, (triangles + 1) * sizeof *planes);
    hemi_result result = normals && planes ? find_places(b) : HEMI_ERROR_MEMORY;
    if (result == HEMI_OK) result = find_planes(b, normals, planes);
    if (result == HEMI_OK) result = add_corners(b, normals, planes);
    block_free(normals);
    block_free(planes);
    block_free(b->place);
    block_free(b->direction);
    block_free(b->same);
    b->place = b->direction = b->same = NULL;
    pair_map_clear(&b->edges);
    return result;
}

static hemi_result tessellate_mesh(builder *b) {
    tessellation *out = b->out;
    const extent before = extent_of(out);
    const tessellate_check check = out->check;
    size_t triangles = b->mesh->triangle_count;
    b->triangles = block_new(b->desc->memory, (3 * triangles + 1) * sizeof *b->triangles);
    b->faces = block_new(b->desc->memory, (triangles + 1) * sizeof *b->faces);
    b->face_count = 0;
    edge_midpoints_open(&b->midpoints, out->vertices);
    /* A closed mesh has so many edges. */
    bool ok = b->triangles && b->faces && pair_map_reserve(&b->edges, triangles + triangles / 2) &&
              pair_map_reserve(&b->welds, b->mesh->vertex_count);
    hemi_result result = ok ? find_corners(b) : HEMI_ERROR_MEMORY;
    if (result == HEMI_OK) result = pair_triangles(b);
    if (result == HEMI_OK) result = merge_faces(b, before.vertices, before.nodes);
    for (uint32_t i = 0; result == HEMI_OK && i < b->face_count; i++) result = split_face(b, &b->faces[i]);
    if (result == HEMI_OK && hemi_transform_determinant(b->mesh->transform) < 0.0) reverse_triangles(out, &before);
    if (result == HEMI_OK && b->desc->double_sided[b->mesh_index]) result = add_backs(b, &before);
    if (b->desc->is_proxy && b->desc->is_proxy[b->mesh_index]) out->check = check;
    pair_map_free(&b->edges);
    pair_map_free(&b->welds);
    edge_midpoints_close(&b->midpoints);
    block_free(b->triangles);
    block_free(b->faces);
    return result;
}

/* Gives back the room that growing left over; what cannot be given back stays. */
static void trim(allocator *memory, void **array, size_t bytes) {
    void *less = *array ? block_resize(memory, *array, bytes) : NULL;
    if (less) *array = less;
}

/* A flat ground throws no shadows on what stands on it. */
static void set_things(const wide_ground *g, scene *s) {
    s->has_surroundings = g && g->is_there;
    if (!s->has_surroundings) return;
    s->surroundings_shade = !g->is_plane;
    vec3_copy(s->things_center, g->center);
    s->things_radius = g->radius;
}

hemi_result tessellate(const tessellate_desc *desc, tessellation *out) {
    builder b = { .desc = desc, .out = out, .edges.memory = desc->memory, .welds.memory = desc->memory };
    hemi_result result = HEMI_OK;
    out->vertices->memory = out->scene->memory = out->mesh->memory = desc->memory;
    for (uint32_t i = 0; result == HEMI_OK && i < desc->mesh_count; i++) {
        b.mesh = &desc->meshes[i];
        b.mesh_index = i;
        result = tessellate_mesh(&b);
    }
    scene *s = out->scene;
    mesh *m = out->mesh;
    trim(desc->memory, (void **)&s->surfaces, s->surface_count * sizeof *s->surfaces);
    trim(desc->memory, (void **)&m->patches, m->patch_count * sizeof *m->patches);
    trim(desc->memory, (void **)&m->elements, m->element_count * sizeof *m->elements);
    s->vertices = m->vertices = out->vertices->positions;
    s->vertex_count = m->vertex_count = out->vertices->count;
    m->nodes = out->vertices->nodes;
    m->node_count = out->vertices->node_count;
    set_things(desc->ground, s);
    return result;
}

void tessellation_free(tessellation *t) {
    mesh_vertices_free(t->vertices);
    surface_grids_free(t->scene->grids);
    block_free(t->scene->surfaces);
    block_free(t->mesh->patches);
    block_free(t->mesh->elements);
    memset(t, 0, sizeof *t);
}
