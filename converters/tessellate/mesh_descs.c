/* SPDX-License-Identifier: MIT */
#include "mesh_descs.h"

#include "geometry/triangle.h"
#include "scene/material.h"

#include <hemibake/mesh_transform.h>

double mesh_descs_extent(const hemi_mesh_desc *const *meshes, size_t count) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < count; i++)
        for (size_t v = 0; v < meshes[i]->vertex_count; v++) {
            double p[3];
            hemi_transform_point(meshes[i]->transform, meshes[i]->positions + 3 * v, p);
            for (int k = 0; k < 3; k++) low[k] = fmin(low[k], p[k]), high[k] = fmax(high[k], p[k]);
        }
    return vec3_distance(low, high);
}

double mesh_desc_area(const hemi_mesh_desc *m) {
    double area = 0.0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][3];
        for (int k = 0; k < 3; k++)
            hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + k], p[k]);
        area += triangle_area(p[0], p[1], p[2]);
    }
    return area;
}

void mesh_desc_world_normal(const hemi_mesh_desc *m, const float position[3], const float normal[3], float out[3]) {
    double from[3], to[3];
    float tip[3];
    for (int k = 0; k < 3; k++) tip[k] = position[k] + normal[k];
    hemi_transform_point(m->transform, position, from);
    hemi_transform_point(m->transform, tip, to);
    for (int k = 0; k < 3; k++) out[k] = (float)(to[k] - from[k]);
}

double mesh_desc_scale(const hemi_mesh_desc *m) {
    double square = 0.0;
    for (int c = 0; c < 3; c++) square = fmax(square, vec3_dot(m->transform + 4 * c, m->transform + 4 * c));
    return m->transform[15] == 0.0 ? 1.0 : sqrt(square);
}

double mesh_descs_area(const hemi_mesh_desc *meshes, size_t count) {
    double area = 0.0;
    for (size_t i = 0; i < count; i++) area += mesh_desc_area(&meshes[i]);
    return area;
}

static void set_triangles(const hemi_mesh_desc *m, double (*corners)[3][3]) {
    bool turned = hemi_transform_determinant(m->transform) < 0.0;
    for (size_t t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + (size_t)k],
                                 corners[t][turned ? 2 - k : k]);
}

bool mesh_descs_triangles(jobs *j, const hemi_mesh_desc *meshes, size_t count, triangle_bvh *out, uint32_t **mesh_of) {
    size_t triangles = 0, first = 0;
    allocator *memory = jobs_memory(j);
    for (size_t i = 0; i < count; i++) triangles += meshes[i].triangle_count;
    *mesh_of = block_new(memory, (triangles + 1) * sizeof **mesh_of);
    if (!triangle_bvh_allocate(memory, triangles, out) || !*mesh_of) return false;
    for (size_t i = 0; i < count; first += meshes[i++].triangle_count) {
        set_triangles(&meshes[i], out->corners + first);
        for (size_t t = 0; t < meshes[i].triangle_count; t++) (*mesh_of)[first + t] = (uint32_t)i;
    }
    return triangle_bvh_build(memory, j, out);
}

double mesh_desc_balls(const hemi_mesh_desc *m) {
    double swept = 0.0;
    for (size_t t = 0; m->normals && t < m->triangle_count; t++) {
        double n[3][3], across[3];
        for (int k = 0; k < 3; k++) vec3_from_floats(n[k], m->normals + 3 * (size_t)m->indices[3 * t + (size_t)k]);
        vec3_cross(across, n[0], n[1]);
        swept += fabs(vec3_dot(across, n[2])) / 2.0; /* of a small triangle */
    }
    return m->normals ? swept / (4.0 * PI) : 1.0;
}

double mesh_descs_count(const hemi_mesh_desc *meshes, size_t count) {
    double triangles = 0.0;
    for (size_t i = 0; i < count; i++) triangles += meshes[i].triangle_count;
    return triangles;
}

size_t mesh_descs_emitting(const hemi_mesh_desc *meshes, size_t count, const hemi_material_desc *materials) {
    size_t triangles = 0;
    for (size_t i = 0; i < count; i++)
        if (!vec3_is_zero(materials[meshes[i].material].emission)) triangles += meshes[i].triangle_count;
    return triangles;
}

bool mesh_descs_transmit(const hemi_mesh_desc *meshes, size_t count, const hemi_material_desc *materials) {
    for (size_t i = 0; i < count; i++) {
        const hemi_material_desc *m = &materials[meshes[i].material];
        if (meshes[i].triangle_count == 0) continue;
        if (material_tints(m->reflectance, m->transmission, m->diffuse_transmission, meshes[i].texture)) return true;
    }
    return false;
}
