/* SPDX-License-Identifier: MIT */
#include "detail_levels.h"

#include "closest_point.h"
#include "output_mesh.h"

#include <hemibake/mesh_transform.h>

#include <string.h>

/* A point of the nearest level that faces the right way is taken though one that does not is nearer by so much of the
 * extent of the level: about how far levels of one thing are apart. */
static const double TURNED_EXTENT = 0.1;

/* ---- which ---- */

static bool has_nearest(const bake_scene *f, uint32_t group) {
    for (size_t i = 0; i < f->mesh_count; i++)
        if (f->meshes[i].detail_group == group && f->meshes[i].detail_level == 0 && f->meshes[i].triangle_count)
            return true;
    return false;
}

bool detail_levels_find(bake_scene *f) {
    f->is_level = arena_alloc(&f->memory, f->mesh_count + 1, sizeof *f->is_level);
    if (!f->is_level) return false;
    memset(f->is_level, 0, (f->mesh_count + 1) * sizeof *f->is_level);
    for (size_t i = 0; i < f->mesh_count; i++) {
        const hemi_mesh_desc *m = &f->meshes[i];
        if (!m->detail_group || !m->detail_level || !m->triangle_count || mesh_is_subdivided(m)) continue;
        f->is_level[i] = has_nearest(f, m->detail_group);
        f->level_count += f->is_level[i];
    }
    for (size_t i = 0; i < f->mesh_count; i++)
        if (f->is_level[i]) f->meshes[i].triangle_count = 0;
    return true;
}

/* ---- what arrives ---- */

/* The surface of the nearest level, world, with the colour node of each corner. */
typedef struct nearest_level {
    float *positions;
    uint32_t *indices, *nodes;
    size_t triangle_count;
    closest_point *tree;
    double turned;
} nearest_level;

static void copy_triangles(const bake_scene *f, const output_triangles *from, size_t index, nearest_level *out) {
    for (size_t t = from->first[index]; t < from->first[index + 1]; t++, out->triangle_count++)
        for (size_t k = 0; k < 3; k++) {
            size_t at = 3 * out->triangle_count + k;
            uint32_t v = from->all.corners[3 * t + k];
            for (size_t c = 0; c < 3; c++) out->positions[3 * at + c] = (float)f->vertices.positions[3 * (size_t)v + c];
            out->indices[at] = (uint32_t)at;
            out->nodes[at] = f->vertices.nodes[v];
        }
}

static bool make_nearest(const bake_scene *f, const vertex_colors *colors, uint32_t group, nearest_level *out) {
    const output_triangles *all = &colors->triangles;
    size_t count = 0;
    for (size_t i = 0; i < f->mesh_count; i++)
        if (f->meshes[i].detail_group == group && !f->is_level[i]) count += all->first[i + 1] - all->first[i];
    out->positions = block_new(f->memory.memory, 9 * count * sizeof *out->positions + 1);
    out->indices = block_new(f->memory.memory, 3 * count * sizeof *out->indices + 1);
    out->nodes = block_new(f->memory.memory, 3 * count * sizeof *out->nodes + 1);
    if (!out->positions || !out->indices || !out->nodes) return false;
    for (size_t i = 0; i < f->mesh_count; i++)
        if (f->meshes[i].detail_group == group && !f->is_level[i]) copy_triangles(f, all, i, out);
    out->tree = closest_point_create(f->memory.memory, NULL, out->positions, out->indices, out->triangle_count);
    return out->tree != NULL;
}

static void free_nearest(nearest_level *n) {
    closest_point_destroy(n->tree);
    block_free_all(n->positions, n->indices, n->nodes);
}

/* What the level's own material makes of irradiance / pi at a vertex. attributes: three times the mesh's. */
static void shade(const hemi_scene *in, const hemi_mesh_desc *m, const double incident[3], double *attributes,
                  solved_mesh *out, size_t v) {
    double radiance[3], demodulated[3];
    size_t n = m->attributes ? m->attribute_count : 0;
    for (size_t i = 0; i < n; i++) attributes[i] = (double)m->attributes[n * (v % m->vertex_count) + i];
    mesh_desc_shade(in, m, incident, attributes, radiance, demodulated);
    for (size_t c = 0; c < 3; c++) {
        out->radiance[3 * v + c] = (float)radiance[c];
        if (out->demodulated) out->demodulated[3 * v + c] = (float)demodulated[c];
    }
}

static void light_vertices(const hemi_scene *in, const hemi_mesh_desc *m, const nearest_level *n,
                           const double *irradiance, const double *errors, double *attributes, solved_mesh *out) {
    uint32_t guess = 0;
    for (size_t v = 0; v < out->vertex_count; v++) {
        double world[3], incident[3] = { 0.0, 0.0, 0.0 };
        float point[3], normal[3];
        hemi_transform_point(m->transform, out->positions + 3 * v, world);
        for (int k = 0; k < 3; k++) point[k] = (float)world[k];
        mesh_desc_world_normal(m, out->positions + 3 * v, out->normals + 3 * v, normal);
        closest_point_hit hit = closest_point_find(n->tree, point, normal, n->turned, guess);
        for (size_t i = 0; hit.triangle != UINT32_MAX && i < 3; i++) {
            size_t node = n->nodes[3 * (size_t)hit.triangle + i];
            if (out->errors) out->errors[v] += (float)(hit.weights[i] * errors[node]);
            for (size_t c = 0; c < 3; c++) incident[c] += hit.weights[i] * irradiance[3 * node + c];
        }
        guess = hit.triangle == UINT32_MAX ? 0 : hit.triangle;
        shade(in, m, incident, attributes, out, v);
    }
}

hemi_result detail_levels_output(const hemi_scene *in, const bake_scene *f, const vertex_colors *colors,
                                 const double *errors, size_t index, solved_mesh *out) {
    const hemi_mesh_desc *m = &in->meshes[index].desc;
    uint32_t sides = in->materials[m->material].double_sided ? 2 : 1;
    nearest_level n = { .turned = TURNED_EXTENT * mesh_descs_extent(&m, 1) };
    double *attributes = block_new(f->memory.memory, (3 * (size_t)m->attribute_count + 1) * sizeof *attributes);
    bool ok = attributes && make_nearest(f, colors, m->detail_group, &n) &&
              output_mesh_as_it_came(f->memory.memory, m, sides, mesh_desc_is_textured(m), errors, out);
    if (ok) light_vertices(in, m, &n, colors->irradiance.radiance, errors, attributes, out);
    free_nearest(&n);
    block_free(attributes);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
