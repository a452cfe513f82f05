/* SPDX-License-Identifier: MIT
 * Where are the corners of surfaces, patches and elements, and where on the input does each lie? A vertex is added and
 * never moves; arrays grow by doubling, so pointers into them end when a vertex is added.
 */
#ifndef HEMIBAKE_CORE_MESH_MESH_VERTICES_H
#define HEMIBAKE_CORE_MESH_MESH_VERTICES_H

#include "base/block.h"
#include "geometry/vec3.h"

#include <stdint.h>

/* The triangles of a mesh of the input, in the mesh's own frame. */
typedef struct source_mesh {
    const float *positions;  /* positions[3*i+k] */
    const float *normals;    /* normals[3*i+k]; NULL: none */
    const float *attributes; /* attributes[attribute_count*i+k]; NULL: none */
    const uint32_t *indices; /* indices[3*t+k] */
    uint32_t attribute_count;
    double normal_matrix[9]; /* row by row: takes its normals to the world, up to their length and sign */
} source_mesh;

struct surface;

typedef struct mesh_vertices {
    allocator *memory;          /* NULL: the C library */
    double *positions;          /* positions[3*v+k], world, m */
    uint32_t *nodes;            /* the colour node of vertex v: vertices that smooth neighbours share have one */
    uint32_t *source_triangles; /* a triangle of the source mesh that holds vertex v ... */
    float *source_weights;      /* ... and its barycentric coordinates there: source_weights[3*v+k] */
    float *normals; /* normals[3*v+k]: of shading, world, unit, 0: none; NULL: no mesh has any (shading_normals.h) */
    uint32_t count, node_count;
    size_t capacity, normal_capacity;
} mesh_vertices;

/* The number of a new vertex, whose source is not set; NO_INDEX when out of memory. */
uint32_t mesh_vertices_add(mesh_vertices *v, const double position[3], uint32_t node);

/* The number of a copy with another node; NO_INDEX when out of memory. */
uint32_t mesh_vertices_copy(mesh_vertices *v, uint32_t vertex, uint32_t node);

/* The same elsewhere, with the same node: for outlines, which show no colours. */
uint32_t mesh_vertices_place(mesh_vertices *v, uint32_t vertex, const double position[3]);

void mesh_vertices_free(mesh_vertices *v);

static inline double mesh_vertices_distance(const mesh_vertices *v, uint32_t a, uint32_t b) {
    return vec3_distance(v->positions + 3 * (size_t)a, v->positions + 3 * (size_t)b);
}

/* out[k]: what values[width*i+k] of the source's vertices are at a vertex. */
void mesh_vertices_interpolate(const mesh_vertices *v, uint32_t vertex, const uint32_t *indices, const float *values,
                               size_t width, double *out);

/* Sets the source of a vertex that is the mean of others, by weights whose sum is 1, on a surface of the source. */
void mesh_vertices_set_source(mesh_vertices *v, const source_mesh *source, const struct surface *on,
                              const uint32_t *others, const double *weights, int count, uint32_t vertex);

/* The same of a vertex at a place on one of two triangles of the source, or one and NO_INDEX. */
void mesh_vertices_set_place(mesh_vertices *v, const source_mesh *source, const uint32_t triangle[2],
                             const double place[3], uint32_t vertex);

#endif
