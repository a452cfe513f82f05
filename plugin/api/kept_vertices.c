/* SPDX-License-Identifier: MIT */
#include "kept_vertices.h"

#include "own_vertices.h"

#include "geometry/triangle.h"

#include <math.h>
#include <string.h>

static void set_normals(const hemi_mesh_desc *m, solved_mesh *out) {
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], n[3];
        triangle_from_floats(p, m->positions, m->indices + 3 * t);
        triangle_cross(n, p[0], p[1], p[2]);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                out->normals[3 * (size_t)m->indices[3 * t + (size_t)i] + (size_t)k] += (float)n[k];
    }
    for (size_t v = 0; v < m->vertex_count; v++) {
        float *to = out->normals + 3 * v;
        const float *given = m->normals ? m->normals + 3 * v : to;
        double length = sqrt(vec3_dot_floats(given, given));
        if (!(length > 0.0)) given = to, length = sqrt(vec3_dot_floats(to, to));
        for (int k = 0; k < 3; k++) to[k] = length > 0.0 ? (float)(given[k] / length) : k == 1;
    }
}

static void set_sources(const hemi_mesh_desc *m, solved_mesh *out) {
    for (size_t c = 3 * (size_t)m->triangle_count; c-- > 0;) {
        size_t v = m->indices[c];
        out->source_triangles[v] = (uint32_t)(c / 3);
        memset(out->source_weights + 3 * v, 0, 3 * sizeof *out->source_weights);
        out->source_weights[3 * v + c % 3] = 1.0f;
    }
}

static void add_backs(const hemi_mesh_desc *m, solved_mesh *out) {
    size_t n = m->vertex_count, corners = 3 * (size_t)m->triangle_count;
    memcpy(out->positions + 3 * n, out->positions, 3 * n * sizeof *out->positions);
    memcpy(out->source_triangles + n, out->source_triangles, n * sizeof *out->source_triangles);
    memcpy(out->source_weights + 3 * n, out->source_weights, 3 * n * sizeof *out->source_weights);
    for (size_t i = 0; i < 3 * n; i++) out->normals[3 * n + i] = -out->normals[i];
    for (size_t c = 0; c < corners; c++) out->indices[corners + c] = m->indices[c - c % 3 + 2 - c % 3] + (uint32_t)n;
}

bool kept_vertices_lay_out(allocator *memory, const hemi_mesh_desc *m, uint32_t sides, bool demodulates,
                           solved_mesh *out) {
    *out = (solved_mesh){ .vertex_count = sides * m->vertex_count, .triangle_count = sides * m->triangle_count };
    if (!solved_mesh_allocate(memory, out, true, demodulates)) return false;
    memset(out->source_triangles, 0, out->vertex_count * sizeof *out->source_triangles);
    memset(out->radiance, 0, 3 * (size_t)out->vertex_count * sizeof *out->radiance);
    if (demodulates) memset(out->demodulated, 0, 3 * (size_t)out->vertex_count * sizeof *out->demodulated);
    memcpy(out->positions, m->positions, 3 * (size_t)m->vertex_count * sizeof *out->positions);
    memcpy(out->indices, m->indices, 3 * (size_t)m->triangle_count * sizeof *out->indices);
    set_normals(m, out);
    set_sources(m, out);
    if (sides == 2) add_backs(m, out);
    return true;
}

hemi_result kept_vertices_fit(const hemi_scene *in, size_t mesh_index, solved_mesh *solved) {
    const hemi_mesh_desc *m = &in->meshes[mesh_index].desc;
    allocator *memory = &in->context->memory;
    uint32_t sides = in->materials[m->material].double_sided ? 2 : 1;
    solved_mesh out = { 0 };
    if (!m->keep_vertices || !solved->source_triangles || solved->triangle_count == 0) return HEMI_OK;
    const own_vertices_input known = { .positions = solved->positions,
                                       .indices = solved->indices,
                                       .source_triangles = solved->source_triangles,
                                       .source_weights = solved->source_weights,
                                       .vertex_count = solved->vertex_count,
                                       .triangle_count = solved->triangle_count,
                                       .values = { solved->radiance, solved->demodulated } };
    bool ok =
        kept_vertices_lay_out(memory, m, sides, solved->demodulated, &out) &&
        own_vertices_fit(memory, m, &known, out.normals, sides, (float *const[2]){ out.radiance, out.demodulated });
    solved_mesh_free(ok ? solved : &out);
    if (ok) *solved = out;
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
