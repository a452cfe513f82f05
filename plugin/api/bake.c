/* SPDX-License-Identifier: MIT
 * What happens between a scene and its light? Refine, tessellate, build, look for lights, solve, output_mesh.
 */
#include "adapt.h"
#include "build_scene.h"
#include "duplicate_meshes.h"
#include "internal.h"
#include "output_mesh.h"
#include "proxy_mesh.h"
#include "scene_light.h"

#include "base/block.h"
#include "base/tolerance.h"
#include "formfactor/hemicube_weights.h"
#include "formfactor/near_distance.h"
#include "solver/progressive.h"

#include <math.h>
#include <string.h>

enum { HEMICUBE_MIN = 16, HEMICUBE_MAX = 4096, REFINE_MAX = 8 };

/* Shares of the whole that each stage gets in hemi_progress.fraction. */
static const double FRACTION_MESH = 0.05, FRACTION_LIGHT = 0.15, FRACTION_SOLVED = 0.7, FRACTION_REFINED = 0.95;

/* Light that arrives, or that a picture emits, is unshot on many patches alike: what may be left of it in all is less
 * than what one patch has, or some would never shoot. Measured: with the whole of draft's 1 % a strip of floor stayed
 * dark to the wall beside it.
 */
static const double UNSHOT_DIRECT = 0.1;

/* Beyond so many surfaces it costs less to quarter emitters than to look for what hides which part of one. */
enum { SURFACES_OF_EXACT_EMITTERS = 300 };

/* The pictures of hemi-cubes are small while few surfaces are in them. */
enum { SURFACES_OF_KEPT_CUBES = 20000 };

typedef struct baking {
    hemi_scene *in;
    hemi_bake_desc desc;
    double start_s;
    bake_span span;
    bake_scene bake_scene;
    scene_light scene_light;
    progressive_result light;
    double *weights, *weights_light;
    column_setup columns;
    double last_fraction;
    uint32_t even_levels; /* adapt_setup */
    bool unshot_given, light_tolerance_given;
    hemi_solution *out;
} baking;

static bool report(baking *b, const char *stage, double fraction, uint32_t shots, double unshot) {
    if (!b->desc.progress) return true;
    if (fraction > b->last_fraction) b->last_fraction = fraction;
    hemi_progress p = { b->span.low + (b->span.high - b->span.low) * b->last_fraction, stage, shots, unshot };
    return b->desc.progress(b->desc.progress_user, &p);
}

static bool report_solving(void *user, double fraction, uint32_t shots, double unshot) {
    return report(user, "factors", FRACTION_LIGHT + (FRACTION_SOLVED - FRACTION_LIGHT) * fraction, shots, unshot);
}

static bool report_refining(void *user, double fraction) {
    const baking *b = user;
    return report(user, "refine", FRACTION_SOLVED + (FRACTION_REFINED - FRACTION_SOLVED) * fraction, b->light.shots,
                  b->light.unshot_fraction);
}

static bool report_lighting(void *user, double fraction) {
    return report(user, "light", FRACTION_MESH + (FRACTION_LIGHT - FRACTION_MESH) * fraction, 0, 1.0);
}

static hemi_result prepare(baking *b) {
    hemi_result result = build_limit_surfaces(b->in, &b->bake_scene);
    if (result != HEMI_OK) return result;
    if (!duplicate_meshes_find(b->in, &b->bake_scene)) return HEMI_ERROR_MEMORY;
    double area = bake_scene_area(&b->bake_scene);
    if (!(area > 0.0) || isinf(area))
        return context_fail(b->in->context, HEMI_ERROR_NO_SURFACES, "there is no triangle with an area to bake");
    b->unshot_given = b->desc.unshot_target > 0.0;
    b->light_tolerance_given = b->desc.light_tolerance > 0.0;
    quality_resolve(&b->desc, area, b->span.scale);
    /* Even, so that a side face of the hemi-cube has half the rows of its top. */
    b->desc.hemicube += b->desc.hemicube & 1;
    b->desc.hemicube_light += b->desc.hemicube_light & 1;
    double element_size = b->desc.element_size;
    result = proxy_meshes_make(b->in, &b->desc, &b->bake_scene);
    b->even_levels = quality_even_levels(&b->desc);
    if (result == HEMI_OK) result = build_scene(b->in, &b->desc, &b->bake_scene);
    if (result == HEMI_OK &&
        ldexp((double)b->bake_scene.mesh.element_count, 2 * (int)b->even_levels) > b->desc.max_elements)
        return fail_too_many(b->in, element_size, &b->desc);
    if (result == HEMI_OK) say_clamped(b->in, &b->bake_scene);
    bake_scene *f = &b->bake_scene;
    f->items.pool = f->patches.items.pool = f->elements.items.pool = b->in->context->pool;
    return result;
}

static double *new_weights(allocator *memory, uint32_t resolution) {
    double *weights = block_new(memory, 3 * (size_t)resolution * resolution * sizeof *weights);
    if (weights) hemicube_weights((int)resolution, weights);
    return weights;
}

/* Only a full matrix needs memory that cannot be done without. */
static hemi_result check_memory(const baking *b, const progressive_setup *setup) {
    uint64_t bytes = progressive_memory(setup);
    const hemi_context *c = b->in->context;
    double mib = (double)bytes / (1 << 20), limit = (double)setup->memory_limit / (1 << 20);
    if (bytes == 0) return HEMI_OK;
    context_log(c, HEMI_LOG_INFO, "a full matrix of %zu elements and %zu patches takes %.0f MiB",
                b->bake_scene.mesh.element_count, b->bake_scene.mesh.patch_count, mib);
    if (bytes <= setup->memory_limit) return HEMI_OK;
    return context_fail(
        c, HEMI_ERROR_LIMIT,
        "a full matrix of %zu elements and %zu patches takes %.0f MiB and %.0f are allowed; allow more, ask "
        "for larger elements or patches, or take another method",
        b->bake_scene.mesh.element_count, b->bake_scene.mesh.patch_count, mib, limit);
}

static void set_columns(baking *b) {
    b->columns = (column_setup){ .method = b->desc.method == HEMI_METHOD_ANALYTIC ? COLUMN_ANALYTIC : COLUMN_HYBRID,
                                 .elements = &b->bake_scene.elements,
                                 .scene = &b->bake_scene.scene,
                                 .mesh = &b->bake_scene.mesh,
                                 .items = b->bake_scene.items,
                                 .triangle_surface = b->bake_scene.triangle_surface,
                                 .resolution = (int)b->desc.hemicube,
                                 .resolution_light = (int)b->desc.hemicube_light,
                                 .weights = b->weights,
                                 .weights_light = b->weights_light,
                                 .seed = b->desc.seed,
                                 .light_depth = quality_light_depth(b->desc.quality),
                                 .patch_depth = quality_patch_depth(b->desc.quality),
                                 .keep_cubes = b->desc.refine_levels + b->even_levels > 0 &&
                                               b->bake_scene.scene.surface_count <= SURFACES_OF_KEPT_CUBES,
                                 .exact_emitters = !b->light_tolerance_given &&
                                                   b->bake_scene.scene.surface_count <= SURFACES_OF_EXACT_EMITTERS,
                                 .light_tolerance = b->desc.light_tolerance,
                                 .near_diameters = near_distance(TOLERANCE_POINT_FACTOR) };
}

static hemi_result solve(baking *b) {
    static const solver_method methods[] = { [HEMI_METHOD_DEFAULT] = SOLVER_HYBRID,
                                             [HEMI_METHOD_HYBRID] = SOLVER_HYBRID,
                                             [HEMI_METHOD_ANALYTIC] = SOLVER_ANALYTIC,
                                             [HEMI_METHOD_PR] = SOLVER_PR,
                                             [HEMI_METHOD_FM] = SOLVER_FM };
    char message[160];
    bool spread = (scene_light_irradiance(&b->scene_light) || b->bake_scene.emitters_are_split) && !b->unshot_given;
    b->weights = new_weights(&b->in->context->memory, b->desc.hemicube);
    b->weights_light = new_weights(&b->in->context->memory, b->desc.hemicube_light);
    if (!b->weights || !b->weights_light) return HEMI_ERROR_MEMORY;
    set_columns(b);
    progressive_setup setup = { .method = methods[b->desc.method],
                                .patches = &b->bake_scene.patches,
                                .columns = b->columns,
                                .jobs = b->in->context->jobs,
                                .arrived = scene_light_irradiance(&b->scene_light),
                                .open_rows = b->scene_light.direct_light.sky_w > 0.0,
                                .unshot_target = b->desc.unshot_target * (spread ? UNSHOT_DIRECT : 1.0),
                                .error_target = b->desc.error_target,
                                .time_limit_s = b->desc.time_limit_s,
                                .start_s = b->start_s,
                                .memory_limit = b->desc.memory_limit,
                                .clock = monotonic_seconds,
                                .progress = report_solving,
                                .progress_user = b,
                                .stop = b->desc.stop };
    hemi_result fits = check_memory(b, &setup);
    if (fits != HEMI_OK) return fits;
    const char *failure = progressive_solve(&setup, &b->light, message, sizeof message);
    if (failure) return context_core_failure(b->in->context, failure);
    return b->light.cancelled ? HEMI_CANCELLED : HEMI_OK;
}

/* Elements are refined while there is time for it. */
static hemi_result refine(baking *b) {
    hemi_statistics *s = &b->out->statistics;
    double begin = monotonic_seconds();
    bool late = b->desc.time_limit_s > 0.0 && begin - b->start_s > b->desc.time_limit_s;
    const adapt_setup setup = {
        .in = b->in, .desc = &b->desc, .even_levels = b->even_levels, .progress = report_refining, .progress_user = b
    };
    hemi_result result = HEMI_OK;
    s->coarse_elements = (uint32_t)b->bake_scene.mesh.element_count;
    if (b->light.corrected && !late && !(b->desc.stop && *b->desc.stop))
        result = adapt(&setup, &b->bake_scene, &b->scene_light, &b->light, s);
    progressive_forget_shooters(&b->light);
    s->refine_s = monotonic_seconds() - begin;
    return result;
}

static hemi_result copy_curve(const baking *b) {
    hemi_solution *out = b->out;
    out->curve = block_new(&b->in->context->memory, (b->light.curve_count + 1) * sizeof *out->curve);
    if (!out->curve) return HEMI_ERROR_MEMORY;
    out->curve_count = b->light.curve_count;
    double final = out->statistics.error_estimate, unshot = b->light.unshot_error;
    double rest = sqrt(fmax(final * final - unshot * unshot, 0.0));
    for (size_t i = 0; i < out->curve_count; i++) {
        const progressive_point *p = &b->light.curve[i];
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

static hemi_result copy_shooters(const baking *b) {
    hemi_solution *out = b->out;
    out->shooters = block_new(&b->in->context->memory, (b->light.shooter_count + 1) * sizeof *out->shooters);
    if (!out->shooters) return HEMI_ERROR_MEMORY;
    out->shooter_count = b->light.shooter_count;
    for (size_t i = 0; i < out->shooter_count; i++) {
        const progressive_shooter *s = &b->light.shooters[i];
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

static void fill_scene_statistics(const baking *b, hemi_statistics *s) {
    s->surfaces = (uint32_t)b->bake_scene.scene.surface_count;
    s->materials = (uint32_t)b->bake_scene.scene.material_count;
    size_t clustered;
    s->clusters = (uint32_t)mesh_count_clusters(&b->bake_scene.mesh, &clustered);
    s->clustered_patches = (uint32_t)clustered;
    s->patches = (uint32_t)b->bake_scene.mesh.patch_count;
    s->elements = (uint32_t)b->bake_scene.mesh.element_count;
    s->samples = (uint32_t)b->bake_scene.mesh.sample_count;
    s->degenerate_triangles = b->bake_scene.pieces.degenerate_count + b->bake_scene.dense_check.degenerate_count;
    s->duplicate_triangles = b->bake_scene.pieces.duplicate_count + b->bake_scene.dense_check.duplicate_count;
    s->nonmanifold_edges = b->bake_scene.pieces.nonmanifold_count + b->bake_scene.dense_check.nonmanifold_count;
    s->clamped_materials = b->bake_scene.clamped_materials;
    s->slivers = b->bake_scene.pieces.sliver_count;
    s->t_junctions = b->bake_scene.pieces.junction_count;
    s->overlapping_triangles = b->bake_scene.overlapping_count;
    s->crossing_surfaces = b->bake_scene.crossing_count;
    s->duplicate_meshes = b->bake_scene.duplicate_count;
    s->threads = jobs_worker_count(b->in->context->jobs);
}

static void fill_light_statistics(const baking *b, hemi_statistics *s) {
    const progressive_result *l = &b->light;
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

static void fill_direct_light_statistics(const baking *b, hemi_statistics *s) {
    const scene_light *l = &b->scene_light;
    s->punctual_lights = (uint32_t)b->in->light_count;
    s->sky_patches = (uint32_t)l->sky.patch_count;
    s->punctual_w = l->direct_light.punctual_w;
    s->sky_w = l->direct_light.sky_w;
    s->arrival_s = l->seconds;
    s->solve_s += l->seconds;
    s->sky_by_default = l->sky_by_default;
}

static hemi_result bake(baking *b) {
    hemi_statistics *s = &b->out->statistics;
    hemi_result result = prepare(b);
    if (result != HEMI_OK) return result;
    s->mesh_s = monotonic_seconds() - b->start_s;
    if (!report(b, "mesh", FRACTION_MESH, 0, 1.0)) return HEMI_CANCELLED;
    double deadline_s = b->desc.time_limit_s > 0.0 ? b->start_s + b->desc.time_limit_s : 0.0;
    result =
        scene_light_compute(b->in, b->desc.quality, deadline_s, &b->bake_scene, report_lighting, b, &b->scene_light);
    if (result == HEMI_OK) result = solve(b);
    if (result == HEMI_OK) result = refine(b);
    if (result != HEMI_OK) return result;
    double begin = monotonic_seconds();
    result = output_mesh(b->in, &b->desc, &b->bake_scene, &b->scene_light.direct_light, &b->light, b->out);
    s->reconstruct_s = monotonic_seconds() - begin;
    if (result == HEMI_OK) result = copy_curve(b);
    if (result == HEMI_OK) result = copy_shooters(b);
    if (result != HEMI_OK) return result;
    fill_scene_statistics(b, s);
    fill_light_statistics(b, s);
    fill_direct_light_statistics(b, s);
    /* Shooting on does not help against elements that are too large: the goal is then not met, and is not called met.
     */
    if (b->desc.error_target > 0.0) s->converged = s->converged && s->error_estimate <= b->desc.error_target;
    s->total_s = monotonic_seconds() - b->start_s;
    return report(b, "reconstruct", 1.0, s->shots, s->unshot_fraction) ? HEMI_OK : HEMI_CANCELLED;
}

const char *bake_desc_fault(const hemi_bake_desc *d) {
    const double sizes[] = { d->element_size, d->patch_size, d->unshot_target, d->error_target, d->time_limit_s };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (!(sizes[i] >= 0.0) || isinf(sizes[i])) return "a size, target or limit is negative or not a number";
    const uint32_t cubes[] = { d->hemicube, d->hemicube_light };
    for (int i = 0; i < 2; i++)
        if (cubes[i] && (cubes[i] < HEMICUBE_MIN || cubes[i] > HEMICUBE_MAX))
            return "a hemi-cube has 16 to 4096 pixels across";
    if (d->unshot_target >= 1.0) return "the unshot target is a fraction below 1";
    if (!(d->light_tolerance >= 0.0 && d->light_tolerance <= 1.0)) return "the light tolerance is a fraction";
    if (d->refine_levels > REFINE_MAX && d->refine_levels != HEMI_REFINE_NEVER)
        return "elements are refined by 8 levels at most";
    if (!(d->refine_error >= 0.0) || isinf(d->refine_error))
        return "the refinement's error is negative or not a number";
    if ((unsigned)d->method > HEMI_METHOD_FM) return "the method is unknown";
    if (!(d->merge_error <= 1.0)) return "what merging may change is not a share";
    if (!(fabs(d->proxy_error) < INFINITY)) return "the deviation of proxies is not a number";
    return (unsigned)d->quality > HEMI_QUALITY_REFERENCE ? "the quality is unknown" : NULL;
}

hemi_result bake_once(hemi_scene *in, const hemi_bake_desc *desc, const bake_span *span, hemi_solution **out) {
    baking b = { .in = in, .desc = *desc, .start_s = span->start_s, .span = *span };
    allocator *memory = &in->context->memory;
    b.bake_scene.memory.memory = b.bake_scene.scene.memory = b.bake_scene.mesh.memory = memory;
    b.out = block_zeroed(memory, 1, sizeof *b.out);
    hemi_result result = b.out ? bake(&b) : HEMI_ERROR_MEMORY;
    progressive_result_free(&b.light);
    scene_light_free(&b.scene_light);
    bake_scene_free(&b.bake_scene);
    block_free(b.weights);
    block_free(b.weights_light);
    if (result == HEMI_OK)
        *out = b.out;
    else
        hemi_solution_destroy(b.out);
    return result;
}
