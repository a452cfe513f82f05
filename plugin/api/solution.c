/* SPDX-License-Identifier: MIT
 * What does a host read from a finished bake?
 */
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

void hemi_solution_destroy(hemi_solution *solution) {
    if (!solution) return;
    for (size_t i = 0; i < solution->mesh_count; i++) solved_mesh_free(&solution->meshes[i]);
    block_free(solution->meshes);
    block_free(solution->curve);
    block_free(solution->shooters);
    block_free(solution);
}

hemi_result hemi_solution_mesh(const hemi_solution *solution, uint32_t mesh, hemi_mesh_view *out) {
    if (!solution || !out || mesh >= solution->mesh_count) return HEMI_ERROR_ARGUMENT;
    const solved_mesh *m = &solution->meshes[mesh];
    *out = (hemi_mesh_view){ .vertex_count = m->vertex_count,
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
    return HEMI_OK;
}

hemi_result hemi_solution_statistics(const hemi_solution *solution, hemi_statistics *out, size_t struct_size) {
    if (!solution || !out) return HEMI_ERROR_ARGUMENT;
    memcpy(out, &solution->statistics, struct_size < sizeof *out ? struct_size : sizeof *out);
    return HEMI_OK;
}

hemi_result hemi_solution_shooters(const hemi_solution *solution, const hemi_shooter **shooters, size_t *count) {
    if (!solution || !shooters || !count) return HEMI_ERROR_ARGUMENT;
    *shooters = solution->shooters;
    *count = solution->shooter_count;
    return HEMI_OK;
}

hemi_result hemi_solution_curve(const hemi_solution *solution, const hemi_curve_point **points, size_t *count) {
    if (!solution || !points || !count) return HEMI_ERROR_ARGUMENT;
    *points = solution->curve;
    *count = solution->curve_count;
    return HEMI_OK;
}
