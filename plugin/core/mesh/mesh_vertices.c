/* SPDX-License-Identifier: MIT */
#include "mesh/mesh_vertices.h"

#include "geometry/triangle.h"
#include "scene/scene.h"

#include <string.h>

/* A vertex this far outside a source triangle, in barycentric coordinates, is on its edge up to rounding. */
static const double ON_EDGE = 1e-6;

/* The four arrays grow together. */
static bool grow(mesh_vertices *v) {
    size_t capacity[4] = { v->capacity, v->capacity, v->capacity, v->capacity };
    bool ok =
        block_grow(v->memory, (void **)&v->positions, &capacity[0], v->count, 3 * sizeof *v->positions) &&
        block_grow(v->memory, (void **)&v->nodes, &capacity[1], v->count, sizeof *v->nodes) &&
        block_grow(v->memory, (void **)&v->source_triangles, &capacity[2], v->count, sizeof *v->source_triangles) &&
        block_grow(v->memory, (void **)&v->source_weights, &capacity[3], v->count, 3 * sizeof *v->source_weights);
    if (ok) v->capacity = capacity[0];
    return ok && (!v->normals ||
                  block_grow(v->memory, (void **)&v->normals, &v->normal_capacity, v->count, 3 * sizeof *v->normals));
}

uint32_t mesh_vertices_add(mesh_vertices *v, const double position[3], uint32_t node) {
    if (v->count == NO_INDEX || !grow(v)) return NO_INDEX;
    uint32_t added = v->count++;
    vec3_copy(v->positions + 3 * (size_t)added, position);
    v->nodes[added] = node;
    v->source_triangles[added] = 0;
    memset(v->source_weights + 3 * (size_t)added, 0, 3 * sizeof *v->source_weights);
    if (v->normals) memset(v->normals + 3 * (size_t)added, 0, 3 * sizeof *v->normals);
    return added;
}

static uint32_t copy_to(mesh_vertices *v, uint32_t vertex, const double position[3], uint32_t node) {
    uint32_t copy = mesh_vertices_add(v, position, node);
    if (copy == NO_INDEX) return copy;
    v->source_triangles[copy] = v->source_triangles[vertex];
    memcpy(v->source_weights + 3 * (size_t)copy, v->source_weights + 3 * (size_t)vertex, 3 * sizeof *v->source_weights);
    if (v->normals) memcpy(v->normals + 3 * (size_t)copy, v->normals + 3 * (size_t)vertex, 3 * sizeof *v->normals);
    return copy;
}

uint32_t mesh_vertices_copy(mesh_vertices *v, uint32_t vertex, uint32_t node) {
    double position[3];
    vec3_copy(position, v->positions + 3 * (size_t)vertex);
    return copy_to(v, vertex, position, node);
}

uint32_t mesh_vertices_place(mesh_vertices *v, uint32_t vertex, const double position[3]) {
    return copy_to(v, vertex, position, v->nodes[vertex]);
}

void mesh_vertices_free(mesh_vertices *v) {
    block_free_all(v->positions, v->nodes, v->source_triangles, v->source_weights, v->normals);
    *v = (mesh_vertices){ .memory = v->memory };
}

void mesh_vertices_interpolate(const mesh_vertices *v, uint32_t vertex, const uint32_t *indices, const float *values,
                               size_t width, double *out) {
    const uint32_t *corner = indices + 3 * (size_t)v->source_triangles[vertex];
    const float *w = v->source_weights + 3 * (size_t)vertex;
    for (size_t k = 0; k < width; k++) {
        out[k] = 0.0;
        for (int i = 0; i < 3; i++) out[k] += (double)w[i] * values[width * corner[i] + k];
    }
}

/* The square of the distance of a point to a triangle, and the weights of its corners at the nearest place on it. */
static double nearest_on(const source_mesh *source, uint32_t triangle, const double point[3], double w[3]) {
    double p[3][3];
    triangle_from_floats(p, source->positions, source->indices + 3 * (size_t)triangle);
    return triangle_nearest(w, p[0], p[1], p[2], point);
}

/* Does a point of the triangle's plane lie in it? */
static bool inside_triangle(const source_mesh *source, uint32_t triangle, const double point[3]) {
    double p[3][3], w[3];
    triangle_from_floats(p, source->positions, source->indices + 3 * (size_t)triangle);
    if (!triangle_weights(w, p[0], p[1], p[2], point)) return false;
    return w[0] >= -ON_EDGE && w[1] >= -ON_EDGE && w[2] >= -ON_EDGE;
}

/* Which of a surface's one or two triangles a place is on, and the weights of its corners there. What rounding, or a
 * snap, put beside both is moved onto the nearer one: weights that do not add up to one are a place far away. */
static uint32_t find_source(const source_mesh *source, const uint32_t triangle[2], const double place[3], double w[3]) {
    double first = nearest_on(source, triangle[0], place, w), other[3];
    if (triangle[1] == NO_INDEX || inside_triangle(source, triangle[0], place)) return triangle[0];
    bool is_nearer = nearest_on(source, triangle[1], place, other) < first;
    if (!is_nearer && !inside_triangle(source, triangle[1], place)) return triangle[0];
    memcpy(w, other, sizeof other);
    return triangle[1];
}

/* If they all have the same source triangle, so has their mean; but a vertex has its source from any of the surfaces
 * around it, so else the surface's own triangles are asked. */
void mesh_vertices_set_source(mesh_vertices *v, const source_mesh *source, const surface *on, const uint32_t *others,
                              const double *weights, int count, uint32_t vertex) {
    double sum[3] = { 0, 0, 0 }, place[3] = { 0, 0, 0 }, found[3] = { 0, 0, 0 };
    bool is_one = true;
    for (int i = 0; i < count; i++) {
        const float *w = v->source_weights + 3 * (size_t)others[i];
        double at[3];
        is_one &= v->source_triangles[others[i]] == v->source_triangles[others[0]];
        mesh_vertices_interpolate(v, others[i], source->indices, source->positions, 3, at);
        vec3_add_scaled(place, place, weights[i], at);
        for (int k = 0; k < 3; k++) sum[k] += weights[i] * (double)w[k];
    }
    const uint32_t *triangle = on->grid ? surface_grid_triangles(on->grid, place) : on->triangle;
    v->source_triangles[vertex] = is_one ? v->source_triangles[others[0]] : find_source(source, triangle, place, found);
    for (int k = 0; k < 3; k++) v->source_weights[3 * (size_t)vertex + (size_t)k] = (float)(is_one ? sum[k] : found[k]);
}

void mesh_vertices_set_place(mesh_vertices *v, const source_mesh *source, const uint32_t triangle[2],
                             const double place[3], uint32_t vertex) {
    double w[3];
    v->source_triangles[vertex] = find_source(source, triangle, place, w);
    for (int k = 0; k < 3; k++) v->source_weights[3 * (size_t)vertex + (size_t)k] = (float)w[k];
}
