/* SPDX-License-Identifier: MIT
 * What does a host read from a finished bake?
 */
#include "desc_size.h"
#include "internal.h"

#include "base/block.h"

#include <string.h>

void solved_mesh_free(solved_mesh *m) {
    block_free(m->indices);
    block_free(m->source_triangles);
    block_free(m->positions);
    block_free(m->normals);
    block_free(m->radiance);
    block_free(m->demodulated);
    block_free(m->source_weights);
    block_free(m->attributes);
    memset(m, 0, sizeof *m);
}

bool solved_mesh_allocate(allocator *memory, solved_mesh *m, bool has_source, bool has_demodulated) {
    size_t v = m->vertex_count, three = 3 * sizeof(float);
    m->indices = block_new(memory, 3 * (size_t)m->triangle_count * sizeof *m->indices);
    m->positions = block_new(memory, v * three);
    m->normals = block_zeroed(memory, v, three);
    m->radiance = block_new(memory, v * three);
    m->demodulated = has_demodulated ? block_new(memory, v * three) : NULL;
    m->source_triangles = has_source ? block_new(memory, v * sizeof *m->source_triangles) : NULL;
    m->source_weights = has_source ? block_zeroed(memory, v, three) : NULL;
    m->attributes = m->attribute_count ? block_new(memory, v * m->attribute_count * sizeof *m->attributes) : NULL;
    return m->indices && m->positions && m->normals && m->radiance && (!has_demodulated || m->demodulated) &&
           (!has_source || (m->source_triangles && m->source_weights)) && (!m->attribute_count || m->attributes);
}

void hemi_solution_destroy(hemi_solution *solution) {
    if (!solution) return;
    for (size_t i = 0; i < solution->mesh_count; i++) solved_mesh_free(&solution->meshes[i]);
    block_free(solution->meshes);
    block_free(solution->curve);
    block_free(solution->shooters);
    block_free(solution);
}

/* The host has set struct_size of the view; `last` is the last field that every version has. */
#define GIVE(type, last, out, known)                                                                                   \
    (view_give(out, DESC_THROUGH(type, last), known, sizeof *(known)) ? HEMI_OK : HEMI_ERROR_ARGUMENT)

hemi_result hemi_solution_mesh(const hemi_solution *solution, uint32_t mesh, hemi_mesh_view *out) {
    if (!solution || mesh >= solution->mesh_count) return HEMI_ERROR_ARGUMENT;
    const solved_mesh *m = &solution->meshes[mesh];
    const hemi_mesh_view view = { .vertex_count = m->vertex_count,
                                  .triangle_count = m->triangle_count,
                                  .indices = m->indices,
                                  .positions = m->positions,
                                  .normals = m->normals,
                                  .radiance = m->radiance,
                                  .demodulated = m->demodulated,
                                  .source_triangles = m->source_triangles,
                                  .source_weights = m->source_weights,
                                  .attributes = m->attributes,
                                  .attribute_count = m->attribute_count };
    return GIVE(hemi_mesh_view, attribute_count, out, &view);
}

hemi_result hemi_solution_statistics(const hemi_solution *solution, hemi_statistics *out) {
    if (!solution) return HEMI_ERROR_ARGUMENT;
    return GIVE(hemi_statistics, error, out, &solution->statistics);
}

size_t hemi_solution_shooter_count(const hemi_solution *solution) {
    return solution ? solution->shooter_count : 0;
}

hemi_result hemi_solution_shooter(const hemi_solution *solution, size_t index, hemi_shooter *out) {
    if (!solution || index >= solution->shooter_count) return HEMI_ERROR_ARGUMENT;
    return GIVE(hemi_shooter, split, out, &solution->shooters[index]);
}

size_t hemi_solution_curve_count(const hemi_solution *solution) {
    return solution ? solution->curve_count : 0;
}

hemi_result hemi_solution_curve_point(const hemi_solution *solution, size_t index, hemi_curve_point *out) {
    if (!solution || index >= solution->curve_count) return HEMI_ERROR_ARGUMENT;
    return GIVE(hemi_curve_point, evaluations, out, &solution->curve[index]);
}
