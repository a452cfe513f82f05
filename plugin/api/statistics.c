/* SPDX-License-Identifier: MIT
 * See statistics.h.
 */
#include "statistics.h"

#include "base/block.h"

#include <math.h>

static hemi_result copy_curve(const bake_setup *setup, const progressive_result *light, hemi_solution *out) {
    out->curve = block_new(jobs_memory(setup->jobs), (light->curve_count + 1) * sizeof *out->curve);
    if (!out->curve) return HEMI_ERROR_MEMORY;
    out->curve_count = light->curve_count;
    double final = out->statistics.error_estimate, unshot = light->unshot_error;
    double rest = sqrt(fmax(final * final - unshot * unshot, 0.0));
    for (size_t i = 0; i < out->curve_count; i++) {
        const progressive_point *p = &light->curve[i];
        /* What was seen only at the end was there all the time. */
        out->curve[i] = (hemi_curve_point){ .t_s = p->t_s,
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
        out->shooters[i] = (hemi_shooter){ .patch = s->patch,
                                           .depth = (uint32_t)subpatch_path_depth(s->path),
                                           .shots = s->shots,
                                           .hemicubes = s->hemicubes,
                                           .analytic = s->analytic,
                                           .estimated = s->evaluations - s->analytic,
                                           .split = s->split };
    }
    return HEMI_OK;
}

static void fill_scene_statistics(const bake_scene *f, hemi_statistics *s) {
    s->surfaces = (uint32_t)f->scene.surface_count;
    s->materials = (uint32_t)f->scene.material_count;
    size_t clustered;
    s->clusters = (uint32_t)mesh_count_clusters(&f->mesh, &clustered);
    s->clustered_patches = (uint32_t)clustered;
    s->patches = (uint32_t)f->mesh.patch_count;
    s->elements = (uint32_t)f->mesh.element_count;
    s->samples = (uint32_t)f->mesh.sample_count;
    s->degenerate_triangles = f->pieces.degenerate_count + f->dense_check.degenerate_count;
    s->duplicate_triangles = f->pieces.duplicate_count + f->dense_check.duplicate_count;
    s->nonmanifold_edges = f->pieces.nonmanifold_count + f->dense_check.nonmanifold_count;
    s->clamped_materials = f->clamped_materials;
    s->slivers = f->pieces.sliver_count;
    s->t_junctions = f->pieces.junction_count;
    s->overlapping_triangles = f->overlapping_count;
    s->crossing_surfaces = f->crossing_count;
    s->duplicate_meshes = f->duplicate_count;
}

static void fill_light_statistics(const progressive_result *l, hemi_statistics *s) {
    s->lights = l->light_count;
    s->shots = l->shots;
    s->hemicubes = l->hemicubes;
    s->unshot_fraction = l->unshot_fraction;
    s->converged = l->converged;
    s->factors_s = l->factors_s;
    s->solve_s = l->solve_s;
    s->emitted_w = l->books.emitted;
    s->absorbed_w = l->books.absorbed;
    s->escaped_w = l->books.escaped;
    s->unshot_w = l->books.unshot;
    s->energy_residual = energy_residual(&l->books);
    s->closure_min = l->closure_min;
    s->closure_mean = l->closure_mean;
    s->closure_max = l->closure_max;
    s->analytic_fraction = l->evaluations ? (double)l->analytic / (double)l->evaluations : 0.0;
    s->subdivided_patches = l->split_count;
    s->clipped = l->clipped_count;
    s->column_bytes = l->column_bytes;
    s->rows_closed = l->rows_closed;
    s->error_unshot = l->unshot_error;
    s->error_factors = l->factor_error;
}

static void fill_direct_light_statistics(const bake_setup *setup, const bake_result *found, hemi_statistics *s) {
    s->punctual_lights = (uint32_t)setup->lights->punctual_count;
    s->sky_patches = (uint32_t)setup->lights->sky.patch_count;
    s->sky_by_default = setup->lights->sky_is_default;
    s->punctual_w = found->direct.punctual_w;
    s->sky_w = found->direct.sky_w;
    s->arrival_s = found->direct_light_s;
    s->solve_s += found->direct_light_s;
}

static void fill_color_statistics(const bake_result *found, hemi_statistics *s) {
    const vertex_colors *c = &found->colors;
    s->coarse_elements = found->coarse_elements;
    s->fine_share = found->fine_share;
    s->refine_s = found->adapt_s;
    s->reconstruct_s += found->reconstruct_s;
    s->error_estimate = c->error;
    s->error_bias = c->bias;
    s->error_points = (uint32_t)c->points;
    s->error_discretisation = c->residual;
    s->triangles_cut = c->decimation.triangles_before;
    s->triangles_merged = c->decimation.triangles_before - c->triangles.all.count;
    s->merge_error = c->decimation.error;
    s->error_merge = c->decimation.rms;
}

hemi_result statistics_fill(const bake_setup *setup, const bake_scene *f, const bake_result *found,
                            hemi_solution *out) {
    hemi_statistics *s = &out->statistics;
    double target = setup->options->error_target;
    s->threads = jobs_worker_count(setup->jobs);
    fill_scene_statistics(f, s);
    fill_light_statistics(&found->solution, s);
    fill_direct_light_statistics(setup, found, s);
    fill_color_statistics(found, s);
    /* Shooting on does not help against elements that are too large: the goal is then not met, and is not called met.
     */
    if (target > 0.0) s->converged = s->converged && s->error_estimate <= target;
    hemi_result result = copy_curve(setup, &found->solution, out);
    return result == HEMI_OK ? copy_shooters(setup, &found->solution, out) : result;
}
