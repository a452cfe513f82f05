/* SPDX-License-Identifier: MIT
 * What does a host read from a finished bake, and what does the bake say of itself?
 */
#include "solution.h"

#include "desc_size.h"

#include <string.h>

void solved_mesh_free(solved_mesh *m) {
    block_free_all(m->indices, m->source_triangles, m->positions, m->normals, m->radiance, m->demodulated,
                   m->source_weights, m->attributes, m->light_groups, m->errors);
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
    m->errors = m->has_errors ? block_zeroed(memory, v, sizeof *m->errors) : NULL;
    return m->indices && m->positions && m->normals && m->radiance && (!m->has_errors || m->errors) &&
           (!has_demodulated || m->demodulated) && (!has_source || (m->source_triangles && m->source_weights)) &&
           (!m->attribute_count || m->attributes);
}

void hemi_solution_destroy(hemi_solution *solution) {
    if (!solution) return;
    for (size_t i = 0; i < solution->mesh_count; i++) solved_mesh_free(&solution->meshes[i]);
    block_free_all(solution->meshes, solution->curve, solution->shooters, solution->rows.bytes, solution);
}

/* The host has set struct_size of the view; `last` is the last field that every version has. */
#define GIVE(type, last, out, known)                                                                                   \
    (view_give(out, DESC_THROUGH(type, last), known, sizeof *(known)) ? HEMI_OK : HEMI_ERROR_ARGUMENT)

hemi_result hemi_solution_mesh(const hemi_solution *solution, uint32_t index, hemi_mesh_view *out) {
    if (!solution || index >= solution->mesh_count) return HEMI_ERROR_ARGUMENT;
    const solved_mesh *m = &solution->meshes[index];
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
                                  .attribute_count = m->attribute_count,
                                  .light_groups = m->light_groups,
                                  .light_group_count = m->light_group_count,
                                  .errors = m->errors };
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

/* ---- what a bake says of itself ---- */

static hemi_result copy_curve(const bake_setup *setup, const progressive_result *light, hemi_solution *out) {
    out->curve = block_new(jobs_memory(setup->jobs), (light->curve_count + 1) * sizeof *out->curve);
    if (!out->curve) return HEMI_ERROR_MEMORY;
    const size_t count = out->curve_count = light->curve_count;
    double unshot = light->by_rows && count ? light->curve[count - 1].unshot_error : light->unshot_error;
    double final = out->statistics.error.estimate, rest = sqrt(fmax(final * final - unshot * unshot, 0.0));
    for (size_t i = 0; i < count; i++) {
        const progressive_point *p = &light->curve[i];
        /* What was seen only at the end was there all the time. */
        out->curve[i] = (hemi_curve_point){ .struct_size = sizeof(hemi_curve_point),
                                            .t_s = p->t_s,
                                            .shots = p->shots,
                                            .unshot_fraction = p->unshot_fraction,
                                            .error_estimate = hypot(p->unshot_error, rest),
                                            .analytic = p->analytic,
                                            .evaluations = p->evaluations };
    }
    return HEMI_OK;
}

static hemi_result copy_shooters(const bake_setup *setup, const progressive_result *light, hemi_solution *out) {
    out->shooters = block_new(jobs_memory(setup->jobs), (light->shooter_count + 1) * sizeof *out->shooters);
    if (!out->shooters) return HEMI_ERROR_MEMORY;
    out->shooter_count = light->shooter_count;
    for (size_t i = 0; i < out->shooter_count; i++) {
        const progressive_shooter *s = &light->shooters[i];
        out->shooters[i] = (hemi_shooter){ .struct_size = sizeof(hemi_shooter),
                                           .patch = s->patch,
                                           .depth = (uint32_t)subpatch_path_depth(s->path),
                                           .shots = s->shots,
                                           .hemicubes = s->hemicubes,
                                           .analytic = s->analytic,
                                           .estimated = s->evaluations - s->analytic,
                                           .split = s->split };
    }
    return HEMI_OK;
}

static void fill_scene(const bake_scene *f, const bake_result *found, hemi_scene_statistics *s) {
    const decimation_figures *decimation = &found->colors.decimation;
    size_t clustered;
    s->surfaces = (uint32_t)f->scene.surface_count;
    s->materials = (uint32_t)f->scene.material_count;
    s->emitting_patches = found->solution.light_count;
    s->clusters = (uint32_t)mesh_count_clusters(&f->mesh, &clustered);
    s->clustered_patches = (uint32_t)clustered;
    s->patches = (uint32_t)f->mesh.patch_count;
    s->coarse_elements = found->coarse_elements;
    s->elements = (uint32_t)f->mesh.element_count;
    s->samples = (uint32_t)f->mesh.sample_count;
    s->triangles_before_decimation = decimation->triangles_before;
    s->triangles_decimated = decimation->triangles_before - found->colors.triangles.all.count;
    s->degenerate_triangles = f->check.degenerate_count + f->dense_check.degenerate_count;
    s->duplicate_triangles = f->check.duplicate_count + f->dense_check.duplicate_count;
    s->nonmanifold_edges = f->check.nonmanifold_count + f->dense_check.nonmanifold_count;
    s->clamped_materials = f->clamped_materials;
    s->slivers = f->check.sliver_count;
    s->t_junctions = f->check.junction_count;
    s->overlapping_triangles = f->prepared.overlapping_count;
    s->intersecting_surfaces = f->prepared.crossing_count;
    s->duplicate_meshes = f->duplicate_count;
}

static hemi_factor_statistics factors_of(const progressive_result *l, double gathered_fraction) {
    double analytic = l->evaluations ? (double)l->analytic / (double)l->evaluations : 0.0;
    return (hemi_factor_statistics){ .closure_min = l->closure_min,
                                     .closure_mean = l->closure_mean,
                                     .closure_max = l->closure_max,
                                     .analytic_fraction = analytic,
                                     .subdivided_patches = l->split_count,
                                     .clipped_columns = l->clipped_count,
                                     .gathered_fraction = gathered_fraction };
}

static hemi_error_statistics error_of(const progressive_result *l, const vertex_colors *c, const part_error *p) {
    /* What is unshot lacks in what is shown, and in what that is measured against. */
    double unshot = fmax(l->unshot_error, l->unshot_fraction);
    return (hemi_error_statistics){ .estimate = hypot(c->error, unshot),
                                    .unshot = l->unshot_error,
                                    .factors = l->factor_error,
                                    .discretisation = c->residual,
                                    .bias = c->bias,
                                    .points = (uint32_t)c->points,
                                    .decimation = c->decimation.rms,
                                    .decimation_largest = c->decimation.error,
                                    .worst = { p->mesh, p->error, p->light, p->area } };
}

hemi_result statistics_fill(const bake_setup *setup, const bake_scene *f, const bake_result *found,
                            hemi_solution *out) {
    const progressive_result *l = &found->solution;
    hemi_statistics *s = &out->statistics;
    fill_scene(f, found, &s->scene);
    s->time.factors_s = l->factors_s, s->time.adapt_s = found->adapt_s;
    s->time.solve_s = l->solve_s + found->direct.seconds, s->memory.column_bytes = l->column_bytes;
    s->time.reconstruct_s += found->reconstruct_s; /* what the meshes took is there already */
    s->solver = (hemi_solver_statistics){ .threads = jobs_worker_count(setup->jobs),
                                          .shots = l->shots,
                                          .method = bake_desc_method(setup->options->method),
                                          .hemicubes = l->hemicubes,
                                          .unshot_fraction = l->unshot_fraction,
                                          .converged = l->converged,
                                          .rows_closed = l->rows_closed,
                                          .drawn_by = item_pool_used_backends(setup->items->pool) };
    s->energy = (hemi_energy_statistics){ .emitted_w = l->books.emitted,
                                          .absorbed_w = l->books.absorbed,
                                          .escaped_w = l->books.escaped,
                                          .unshot_w = l->books.unshot,
                                          .residual = energy_residual(&l->books) };
    bool are_given = setup->lights->given_count > 0; /* else what is punctual are suns of the panorama */
    s->arrived = (hemi_arrived_statistics){ .punctual_lights = (uint32_t)setup->lights->given_count,
                                            .sky_patches = (uint32_t)setup->lights->sky.patch_count,
                                            .punctual_w = are_given ? found->direct.punctual_w : 0.0,
                                            .sky_w = found->direct.sky_w + (are_given ? 0.0 : found->direct.punctual_w),
                                            .direct_light_s = found->direct.seconds,
                                            .sky_by_default = setup->lights->sky_is_default };
    s->factors =
        factors_of(l, (found->adapted.pairs ? (double)found->adapted.fine / (double)found->adapted.pairs : 0.0));
    s->error = error_of(l, &found->colors, &found->worst);
    /* Shooting on does not help against elements that are too large: the goal is not met then, nor called met. */
    if (setup->options->error_target > 0.0) s->solver.converged &= s->error.estimate <= setup->options->error_target;
    hemi_result result = copy_curve(setup, l, out);
    return result == HEMI_OK ? copy_shooters(setup, l, out) : result;
}
