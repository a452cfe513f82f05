/* SPDX-License-Identifier: MIT */
#include "output_mesh.h"

#include "detail_levels.h"
#include "flat_triangles.h"
#include "own_vertices.h"
#include "proxy_mesh.h"

#include "geometry/triangle.h"
#include "reconstruct/vertex_errors.h"

#include <hemibake/mesh_transform.h>

#include <string.h>

typedef struct output_builder {
    const hemi_scene *in;
    const bake_scene *f;
    const vertex_colors *colors;
    double *errors;     /* of the nodes, NULL unless asked for */
    size_t copy;        /* that takes the light of the mesh it lies in, or NO_COPY */
    double *attributes; /* of three corners of it */
    uint32_t *local;    /* local[v]: of vertex v in its mesh; set by output_triangles_list */
    uint32_t *order;    /* the vertices of one mesh, of which backs are marked */
} output_builder;

static const size_t NO_COPY = SIZE_MAX;

/* ---- meshes ---- */

/* A vertex interpolated in the mesh's own frame, so that nothing goes through the transform and back. */
static void interpolate(float *out, const float *values, size_t width, const hemi_mesh_desc *m, uint32_t triangle,
                        const float w[3]) {
    for (size_t k = 0; k < width; k++) {
        double sum = 0.0;
        for (int i = 0; i < 3; i++) sum += w[i] * (double)values[width * m->indices[3 * (size_t)triangle + i] + k];
        out[k] = (float)sum;
    }
}

static void set_face_normal(float out[3], const hemi_mesh_desc *m, uint32_t triangle) {
    double p[3][3], n[3];
    triangle_from_floats(p, m->positions, m->indices + 3 * (size_t)triangle);
    triangle_cross(n, p[0], p[1], p[2]);
    vec3_normalize(n);
    for (int k = 0; k < 3; k++) out[k] = (float)n[k];
}

static void set_light(const output_builder *h, uint32_t v, solved_mesh *out, uint32_t local) {
    size_t node = 3 * (size_t)h->f->vertices.nodes[v], at = 3 * (size_t)local;
    double radiance[3], demodulated[3];
    if (h->copy != NO_COPY) {
        const hemi_mesh_desc *own = &h->f->meshes[h->copy];
        if (mesh_desc_is_textured(own))
            bake_scene_attributes(h->f, &h->f->meshes[h->f->copy_of[h->copy]], v, h->attributes);
        mesh_desc_shade(h->in, own, h->colors->irradiance.radiance + node, h->attributes, radiance, demodulated);
    }
    for (size_t c = 0; c < 3; c++) {
        out->radiance[at + c] = (float)(h->copy != NO_COPY ? radiance[c] : h->colors->radiance.radiance[node + c]);
        if (out->demodulated)
            out->demodulated[at + c] =
                (float)(h->copy != NO_COPY ? demodulated[c] : h->colors->demodulated.radiance[node + c]);
    }
    if (out->errors) out->errors[local] = (float)h->errors[node / 3];
}

static void set_vertex(const output_builder *h, const hemi_mesh_desc *m, uint32_t v, solved_mesh *out, uint32_t local) {
    const mesh_vertices *t = &h->f->vertices;
    uint32_t triangle = t->source_triangles[v];
    const float *w = t->source_weights + 3 * (size_t)v;
    float *normal = out->normals + 3 * (size_t)local;
    interpolate(out->positions + 3 * (size_t)local, m->positions, 3, m, triangle, w);
    if (m->normals) {
        interpolate(normal, m->normals, 3, m, triangle, w);
        double n[3] = { normal[0], normal[1], normal[2] };
        if (vec3_normalize(n) > 1e-6)
            for (int k = 0; k < 3; k++) normal[k] = (float)n[k];
        else
            set_face_normal(normal, m, triangle);
    } else {
        set_face_normal(normal, m, triangle);
    }
    set_light(h, v, out, local);
    if (out->attribute_count)
        interpolate(out->attributes + (size_t)out->attribute_count * local, m->attributes, out->attribute_count, m,
                    triangle, w);
    if (!out->source_triangles) return;
    out->source_triangles[local] = triangle;
    memcpy(out->source_weights + 3 * (size_t)local, w, 3 * sizeof *w);
}

/* World triangles of a mirrored mesh are turned over; in the mesh's own frame they run as they came. */
static void set_triangles(const output_builder *h, size_t index, bool turn, solved_mesh *out) {
    const uint32_t *from = h->colors->triangles.all.corners + 3 * (size_t)h->colors->triangles.first[index];
    for (size_t c = 0; c < 3 * (size_t)out->triangle_count; c += 3) {
        out->indices[c] = h->local[from[c]];
        out->indices[c + (turn ? 2 : 1)] = h->local[from[c + 1]];
        out->indices[c + (turn ? 1 : 2)] = h->local[from[c + 2]];
    }
}

static hemi_result output_one_mesh(output_builder *h, size_t index, solved_mesh *out) {
    const hemi_mesh_desc *m = &h->f->meshes[index];
    bool has_source = !mesh_is_subdivided(&h->in->meshes[index].desc);
    bool demodulates = h->f->meshes[h->copy != NO_COPY ? h->copy : index].texture && h->f->demodulated;
    out->vertex_count = output_triangles_list(&h->colors->triangles, &h->f->scene, index, h->local, h->order);
    out->triangle_count = h->colors->triangles.first[index + 1] - h->colors->triangles.first[index];
    out->attribute_count = m->attributes && !has_source ? m->attribute_count : 0;
    out->has_errors = h->errors != NULL;
    if (!solved_mesh_allocate(h->f->memory.memory, out, has_source, demodulates)) return HEMI_ERROR_MEMORY;
    for (uint32_t i = 0; i < out->vertex_count; i++) {
        set_vertex(h, m, h->order[i] & ~OUTPUT_TRIANGLES_BACK, out, i);
        for (size_t k = 3 * (size_t)i; h->order[i] & OUTPUT_TRIANGLES_BACK && k < 3 * (size_t)i + 3; k++)
            out->normals[k] = -out->normals[k];
    }
    set_triangles(h, index, hemi_transform_determinant(m->transform) < 0.0, out);
    return HEMI_OK;
}

static hemi_result output_mesh_whole(output_builder *h, size_t index, solved_mesh *out, hemi_statistics *statistics) {
    hemi_result result = output_one_mesh(h, index, out);
    return result == HEMI_OK ? proxy_mesh_transfer(h->in, h->f, index, out, statistics) : result;
}

/* The mesh that a copy lies in, with what the copy makes of its light. */
static hemi_result output_mesh_copy(output_builder *h, size_t copy, solved_mesh *out) {
    size_t solved = h->f->copy_of[copy], attributes = 3 * (size_t)h->f->meshes[solved].attribute_count;
    hemi_statistics counted_before;
    h->attributes = block_new(h->f->memory.memory, (attributes + 1) * sizeof *h->attributes);
    if (!h->attributes) return HEMI_ERROR_MEMORY;
    h->copy = copy;
    memset(&counted_before, 0, sizeof counted_before);
    hemi_result result = output_mesh_whole(h, solved, out, &counted_before);
    h->copy = NO_COPY;
    block_free(h->attributes);
    return result;
}

/* ---- meshes as they came ---- */

bool output_mesh_as_it_came(allocator *memory, const hemi_mesh_desc *m, uint32_t sides, bool demodulates,
                            bool has_errors, solved_mesh *out) {
    *out = (solved_mesh){ sides * m->vertex_count, sides * m->triangle_count, .has_errors = has_errors };
    if (!solved_mesh_allocate(memory, out, true, demodulates)) return false;
    const own_vertices_mesh own = { out->positions, out->normals, out->source_weights, out->indices,
                                    out->source_triangles };
    own_vertices_lay_out(m, sides, &own);
    return true;
}

/* What was solved on a mesh, cut as it was, becomes the mesh as it came, where its vertices are to be kept: what moves
 * by the weights of its vertices cannot be cut into elements. */
static hemi_result fit_own_vertices(const hemi_scene *in, size_t mesh_index, solved_mesh *solved) {
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
        output_mesh_as_it_came(memory, m, sides, solved->demodulated, solved->errors, &out) &&
        own_vertices_fit(memory, m, &known, out.normals, sides, (float *const[2]){ out.radiance, out.demodulated }) &&
        (!out.errors || own_vertices_mean(memory, m, &known, solved->errors, sides, out.errors));
    solved_mesh_free(ok ? solved : &out);
    if (ok) *solved = out;
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

/* ---- one colour a triangle ---- */

static hemi_result make_flat(allocator *memory, solved_mesh *m) {
    const size_t three = 3 * sizeof(float), attributes = m->attribute_count * sizeof(float);
    void **const arrays[] = { (void **)&m->positions,        (void **)&m->normals,        (void **)&m->radiance,
                              (void **)&m->demodulated,      (void **)&m->source_weights, (void **)&m->attributes,
                              (void **)&m->source_triangles, (void **)&m->errors };
    const size_t bytes[] = {
        three, three, three, three, three, attributes, sizeof *m->source_triangles, sizeof *m->errors
    };
    if (m->triangle_count > UINT32_MAX / 3) return HEMI_ERROR_LIMIT;
    for (size_t i = 0; i < sizeof bytes / sizeof *bytes; i++)
        if (!flat_triangles_spread(memory, m->indices, m->triangle_count, arrays[i], bytes[i]))
            return HEMI_ERROR_MEMORY;
    m->vertex_count = 3 * m->triangle_count;
    for (uint32_t i = 0; i < m->vertex_count; i++) m->indices[i] = i;
    flat_triangles_average(m->radiance, m->triangle_count);
    flat_triangles_average(m->demodulated, m->triangle_count);
    return HEMI_OK;
}

hemi_result output_meshes(const hemi_scene *in, const bake_options *options, const bake_scene *f,
                          const vertex_colors *colors, hemi_solution *out) {
    output_builder h = { .in = in, .f = f, .colors = colors, .copy = NO_COPY };
    hemi_statistics *s = &out->statistics;
    double begin = monotonic_seconds();
    h.local = block_new(f->memory.memory, ((size_t)f->vertices.count + 1) * sizeof *h.local);
    h.order = block_new(f->memory.memory, ((size_t)f->vertices.count + 1) * sizeof *h.order);
    out->meshes = block_zeroed(f->memory.memory, f->mesh_count + 1, sizeof *out->meshes);
    if (options->vertex_errors) h.errors = vertex_errors_find(&f->mesh, &colors->samples, colors->error);
    bool ok = h.local && h.order && out->meshes && f->vertices.count < OUTPUT_TRIANGLES_BACK &&
              (h.errors || !options->vertex_errors);
    hemi_result result = ok ? HEMI_OK : HEMI_ERROR_MEMORY;
    if (out->meshes) out->mesh_count = f->mesh_count;
    for (size_t i = 0; result == HEMI_OK && i < f->mesh_count; i++) {
        solved_mesh *m = &out->meshes[i];
        result = f->is_level[i]              ? detail_levels_output(in, f, colors, h.errors, i, m)
                 : f->copy_of[i] == NO_INDEX ? output_mesh_whole(&h, i, m, s)
                                             : output_mesh_copy(&h, i, m);
        if (result == HEMI_OK) result = fit_own_vertices(in, i, m);
        if (result == HEMI_OK && options->flat && !in->meshes[i].desc.keep_vertices)
            result = make_flat(f->memory.memory, m);
        s->scene.vertices_out += m->vertex_count;
        s->scene.triangles_out += m->triangle_count;
    }
    block_free_all(h.local, h.order, h.errors);
    s->time.reconstruct_s = monotonic_seconds() - begin;
    return result;
}

/* ---- groups of lights ---- */

/* Adds what these colours give to a group; NO_INDEX: to all of them, and takes it away. */
static hemi_result add_group(const hemi_scene *in, const bake_options *options, const bake_scene *f,
                             const vertex_colors *colors, uint32_t group, hemi_solution *out) {
    hemi_solution part = { 0 };
    bake_options light = *options;
    light.vertex_errors = false;
    hemi_result result = output_meshes(in, &light, f, colors, &part);
    for (size_t i = 0; result == HEMI_OK && i < part.mesh_count; i++) {
        solved_mesh *to = &out->meshes[i];
        size_t count = 3 * (size_t)to->vertex_count, first = group == NO_INDEX ? 0 : group;
        size_t end = group == NO_INDEX ? options->light_groups : first + 1;
        for (size_t g = first; g < end; g++) {
            /* What a mesh emits that is shaded by itself is in each group: it stays in its own. */
            float sign = group != NO_INDEX ? 1.0f : g == in->meshes[i].desc.light_group ? 0.0f : -1.0f;
            for (size_t k = 0; k < count; k++) to->light_groups[g * count + k] += sign * part.meshes[i].radiance[k];
        }
    }
    for (size_t i = 0; i < part.mesh_count; i++) solved_mesh_free(&part.meshes[i]);
    block_free(part.meshes);
    return result;
}

hemi_result output_light_groups(const hemi_scene *in, const bake_options *options, const bake_scene *f,
                                const bake_result *found, hemi_solution *out) {
    vertex_colors colors = found->colors;
    if (options->light_groups == 0) return HEMI_OK;
    double *none = block_zeroed(f->memory.memory, 3 * f->vertices.node_count + 1, sizeof *none);
    hemi_result result = none ? HEMI_OK : HEMI_ERROR_MEMORY;
    for (size_t i = 0; result == HEMI_OK && i < out->mesh_count; i++) {
        solved_mesh *m = &out->meshes[i];
        m->light_group_count = options->light_groups;
        m->light_groups = block_zeroed(f->memory.memory, 3 * (size_t)m->vertex_count * options->light_groups + 1,
                                       sizeof *m->light_groups);
        if (!m->light_groups) result = HEMI_ERROR_MEMORY;
    }
    for (uint32_t g = 0; result == HEMI_OK && g < options->light_groups; g++) {
        colors.radiance = found->groups.all[g].radiance, colors.irradiance = found->groups.all[g].incident;
        result = add_group(in, options, f, &colors, g, out);
    }
    colors.radiance.radiance = colors.irradiance.radiance = none;
    if (result == HEMI_OK) result = add_group(in, options, f, &colors, NO_INDEX, out);
    block_free(none);
    return result;
}
