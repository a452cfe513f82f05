/* SPDX-License-Identifier: MIT
 * See tessellate.h. One mesh at a time: corners to vertices, triangles to faces, faces to patches and elements, and the
 * backs of double-sided meshes as mirror images behind.
 */
#include "tessellate.h"

#include "internal.h"

#include "geometry/places.h"
#include "geometry/plane.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <string.h>

/* Height over longest edge of a triangle that is called a sliver. */
static const double SLIVER_RATIO = 0.05;

/* Unit normal of a triangle in the world, and whether it has an area there: a transform may flatten a mesh. */
static bool plane_normal(const hemi_mesh_desc *mesh, const uint32_t index[3], double n[3], bool *sliver) {
    double p[3][3];
    for (int i = 0; i < 3; i++) hemi_transform_point(mesh->transform, mesh->positions + 3 * (size_t)index[i], p[i]);
    triangle_cross(n, p[0], p[1], p[2]);
    double twice_area = vec3_normalize(n), longest_squared = triangle_longest_squared(p[0], p[1], p[2]);
    *sliver = twice_area < SLIVER_RATIO * longest_squared;
    return !triangle_is_degenerate(twice_area, longest_squared);
}

/* Which vertices of the mesh are in one place, and which have one normal. */
static hemi_result find_places(builder *b) {
    const hemi_allocator *memory = b->desc->memory;
    size_t count = b->mesh->vertex_count;
    uint32_t *slots = hemi_allocate(memory, places_slot_count(count) * sizeof *slots);
    b->place = hemi_allocate(memory, count * sizeof *b->place);
    b->direction = b->mesh->normals ? hemi_allocate(memory, count * sizeof *b->direction) : NULL;
    bool ok = slots && b->place && (b->direction || !b->mesh->normals);
    if (ok) places_find_floats(b->mesh->positions, count, slots, b->place);
    if (ok && b->direction) places_find_floats(b->mesh->normals, count, slots, b->direction);
    hemi_deallocate(memory, slots);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

/* The vertex of a corner: corners with the same index are one vertex (of one plane, if the mesh brings no normals);
 * vertices with the same position and normal share a colour node. */
static uint32_t corner_vertex(builder *b, uint32_t index, uint64_t plane) {
    const hemi_mesh_desc *mesh = b->mesh;
    uint64_t own = mesh->normals ? 0 : plane;
    uint32_t *known = pair_map_at(&b->edges, (uint64_t)index | UINT64_C(1) << 62, own, TESSELLATE_NONE);
    if (!known) return TESSELLATE_NONE;
    if (*known != TESSELLATE_NONE) return *known;
    uint64_t normal = mesh->normals ? b->direction[index] : plane;
    uint32_t *node = pair_map_at(&b->welds, b->place[index], normal, TESSELLATE_NONE);
    if (!node) return TESSELLATE_NONE;
    if (*node == TESSELLATE_NONE) *node = b->out->node_count++;
    double position[3];
    hemi_transform_point(mesh->transform, mesh->positions + 3 * (size_t)index, position);
    return *known = builder_add_vertex(b, position, *node);
}

/* ---- planes of a mesh without normals
 * -------------------------------------------------------------------------------- */

static uint32_t plane_root(uint32_t *planes, uint32_t t) {
    while (planes[t] != t) t = planes[t] = planes[planes[t]];
    return t;
}

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
        planes[plane_root(planes, *other)] = plane_root(planes, t);
        return HEMI_OK;
    }
    return HEMI_OK;
}

/* On its three edges. normals[3*t+k] is all 0 for a dropped triangle. */
static hemi_result join_planes(builder *b, const double *normals, uint32_t *planes, uint32_t t) {
    hemi_result result = HEMI_OK;
    const uint32_t *index = b->mesh->indices + 3 * (size_t)t;
    for (int k = 0; result == HEMI_OK && k < 3; k++) {
        uint64_t high, low = low_high(b->place[index[k]], b->place[index[(k + 1) % 3]], &high);
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
            b->out->sliver_count += sliver;
            continue;
        }
        memset(normals + 3 * (size_t)t, 0, 3 * sizeof *normals);
        b->out->degenerate_count++;
    }
    result = mesh_check_drop_duplicates(b, normals);
    if (result == HEMI_OK) result = mesh_check_count_edges(b, normals);
    for (uint32_t t = 0; result == HEMI_OK && !b->mesh->normals && t < b->mesh->triangle_count; t++) {
        if (!vec3_is_zero(normals + 3 * (size_t)t)) result = join_planes(b, normals, planes, t);
    }
    pair_map_clear(&b->edges);
    return result;
}

/* ---- corners
 * --------------------------------------------------------------------------------------------------------- */

static hemi_result add_corners(builder *b, const double *normals, uint32_t *planes) {
    for (uint32_t t = 0; t < b->mesh->triangle_count; t++) {
        const uint32_t *index = b->mesh->indices + 3 * (size_t)t;
        uint32_t *corner = b->triangles + 3 * (size_t)t;
        corner[0] = corner[1] = corner[2] = TESSELLATE_NONE;
        if (vec3_is_zero(normals + 3 * (size_t)t)) continue;
        uint64_t plane = plane_root(planes, t);
        for (int k = 0; k < 3; k++) {
            corner[k] = corner_vertex(b, index[k], plane);
            if (corner[k] == TESSELLATE_NONE) return HEMI_ERROR_MEMORY;
        }
    }
    return HEMI_OK;
}

static void reverse(uint32_t corner[4], uint32_t offset) {
    int n = corner[3] == TESSELLATE_NONE ? 3 : 4;
    uint32_t front[4];
    memcpy(front, corner, sizeof front);
    for (int i = 0; i < n; i++) corner[i] = front[n - 1 - i] + offset;
}

/* Mirror transforms turn every triangle over. */
static void turn_over(builder *b, uint32_t surface, uint32_t patch, uint32_t element) {
    for (uint32_t i = surface; i < b->out->surface_count; i++) reverse(b->out->surfaces[i].corner, 0);
    for (uint32_t i = patch; i < b->out->patch_count; i++) reverse(b->out->patches[i].corner, 0);
    for (uint32_t i = element; i < b->out->element_count; i++) reverse(b->out->elements[i].corner, 0);
}

static hemi_result add_back_vertices(builder *b, uint32_t first, uint32_t end, uint32_t node_offset) {
    tessellation *out = b->out;
    for (uint32_t v = first; v < end; v++) {
        double position[3];
        memcpy(position, out->positions + 3 * (size_t)v, sizeof position);
        uint32_t back = builder_add_vertex(b, position, out->nodes[v] + node_offset);
        if (back == TESSELLATE_NONE) return HEMI_ERROR_MEMORY;
        out->source_triangles[back] = out->source_triangles[v];
        memcpy(out->source_weights + 3 * (size_t)back, out->source_weights + 3 * (size_t)v, 3 * sizeof(float));
    }
    return HEMI_OK;
}

/* The backs of all that the mesh has added: the same pieces with vertices and nodes of their own, wound the other way.
 */
static hemi_result add_backs(builder *b, const tessellation *before) {
    tessellation *out = b->out;
    uint32_t surfaces = out->surface_count, patches = out->patch_count, elements = out->element_count;
    uint32_t vertex_offset = out->vertex_count - before->vertex_count,
             node_offset = out->node_count - before->node_count;
    uint32_t surface_offset = surfaces - before->surface_count, element_offset = elements - before->element_count;
    hemi_result result = add_back_vertices(b, before->vertex_count, out->vertex_count, node_offset);
    out->node_count += node_offset;
    if (out->element_count + element_offset > b->desc->max_elements) return HEMI_ERROR_LIMIT;
    for (uint32_t i = before->surface_count; result == HEMI_OK && i < surfaces; i++) {
        if (!builder_grow(b, (void **)&out->surfaces, &b->surface_capacity, out->surface_count, sizeof *out->surfaces))
            return HEMI_ERROR_MEMORY;
        tessellate_surface back = out->surfaces[i];
        reverse(back.corner, vertex_offset);
        back.twin = i;
        out->surfaces[i].twin = out->surface_count;
        out->surfaces[out->surface_count++] = back;
    }
    for (uint32_t i = before->patch_count; result == HEMI_OK && i < patches; i++) {
        if (!builder_grow(b, (void **)&out->patches, &b->patch_capacity, out->patch_count, sizeof *out->patches))
            return HEMI_ERROR_MEMORY;
        tessellate_patch back = out->patches[i];
        reverse(back.corner, vertex_offset);
        back.surface += surface_offset;
        back.first_element += element_offset;
        out->patches[out->patch_count++] = back;
    }
    for (uint32_t i = before->element_count; result == HEMI_OK && i < elements; i++) {
        if (!builder_grow(b, (void **)&out->elements, &b->element_capacity, out->element_count, sizeof *out->elements))
            return HEMI_ERROR_MEMORY;
        tessellate_element back = out->elements[i];
        reverse(back.corner, vertex_offset);
        out->elements[out->element_count++] = back;
    }
    return result;
}

static hemi_result tessellate_mesh(builder *b) {
    tessellation before = *b->out;
    b->triangles = hemi_allocate(b->desc->memory, (3 * (size_t)b->mesh->triangle_count + 1) * sizeof *b->triangles);
    b->faces = hemi_allocate(b->desc->memory, ((size_t)b->mesh->triangle_count + 1) * sizeof *b->faces);
    b->face_count = 0;
    double *normals = hemi_allocate(b->desc->memory, (3 * (size_t)b->mesh->triangle_count + 1) * sizeof *normals);
    uint32_t *planes = hemi_allocate(b->desc->memory, ((size_t)b->mesh->triangle_count + 1) * sizeof *planes);
    bool ok = b->triangles && b->faces && normals && planes;
    hemi_result result = ok ? find_places(b) : HEMI_ERROR_MEMORY;
    if (result == HEMI_OK) result = find_planes(b, normals, planes);
    if (result == HEMI_OK) result = add_corners(b, normals, planes);
    uint32_t *scratch[] = { planes, b->place, b->direction };
    for (int i = 0; i < 3; i++) hemi_deallocate(b->desc->memory, scratch[i]);
    hemi_deallocate(b->desc->memory, normals);
    b->place = b->direction = NULL;
    pair_map_clear(&b->edges);
    if (result == HEMI_OK) result = pair_triangles(b);
    for (uint32_t i = 0; result == HEMI_OK && i < b->face_count; i++) result = split_face(b, &b->faces[i]);
    if (result == HEMI_OK && hemi_transform_determinant(b->mesh->transform) < 0.0)
        turn_over(b, before.surface_count, before.patch_count, before.element_count);
    if (result == HEMI_OK && b->desc->double_sided[b->mesh_index]) result = add_backs(b, &before);
    if (b->desc->is_proxy && b->desc->is_proxy[b->mesh_index]) {
        b->out->degenerate_count = before.degenerate_count;
        b->out->duplicate_count = before.duplicate_count;
        b->out->nonmanifold_count = before.nonmanifold_count;
        b->out->sliver_count = before.sliver_count;
    }
    b->out->ranges[b->mesh_index] = (tessellate_range){ .first_vertex = before.vertex_count,
                                                        .vertex_count = b->out->vertex_count - before.vertex_count,
                                                        .first_element = before.element_count,
                                                        .element_count = b->out->element_count - before.element_count };
    pair_map *maps[] = { &b->edges, &b->midpoints, &b->node_midpoints, &b->welds };
    for (int i = 0; i < 4; i++) pair_map_free(maps[i]);
    hemi_deallocate(b->desc->memory, b->triangles);
    hemi_deallocate(b->desc->memory, b->faces);
    return result;
}

hemi_result tessellate(const tessellate_desc *desc, tessellation *out) {
    builder b = { .desc = desc, .out = out };
    pair_map *maps[] = { &b.edges, &b.midpoints, &b.node_midpoints, &b.welds };
    for (int i = 0; i < 4; i++) maps[i]->memory = desc->memory;
    *out = (tessellation){ .memory = desc->memory };
    out->mesh_count = desc->mesh_count;
    out->ranges = hemi_allocate_zeroed(desc->memory, desc->mesh_count + 1, sizeof *out->ranges);
    hemi_result result = out->ranges ? HEMI_OK : HEMI_ERROR_MEMORY;
    for (uint32_t i = 0; result == HEMI_OK && i < desc->mesh_count; i++) {
        b.mesh = &desc->meshes[i];
        b.mesh_index = i;
        result = tessellate_mesh(&b);
    }
    if (result != HEMI_OK) tessellation_free(out);
    return result;
}

void tessellation_free(tessellation *t) {
    hemi_deallocate(t->memory, t->positions);
    hemi_deallocate(t->memory, t->nodes);
    hemi_deallocate(t->memory, t->source_triangles);
    hemi_deallocate(t->memory, t->source_weights);
    hemi_deallocate(t->memory, t->surfaces);
    hemi_deallocate(t->memory, t->patches);
    hemi_deallocate(t->memory, t->elements);
    hemi_deallocate(t->memory, t->ranges);
    memset(t, 0, sizeof *t);
}
