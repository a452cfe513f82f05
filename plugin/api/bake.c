/* SPDX-License-Identifier: MIT
 * What does hemi_bake do? It takes the desc, builds what the core solves on, lets the core bake it, as often as the
 * goal asks for, and hands the result out as a solution.
 */
#include "build_scene.h"
#include "desc_size.h"
#include "detail_levels.h"
#include "duplicate_meshes.h"
#include "output_mesh.h"
#include "proxy_mesh.h"
#include "solution.h"

#include "bake/forecast.h"
#include "bake/memory_fit.h"
#include "bake/relight_stage.h"
#include "bake/stage_watch.h"
#include "geometry/vec3.h"

enum { MESSAGE_SIZE = 240 };

/* One bake of a scene, and with which options. */
typedef struct baking {
    hemi_scene *in;
    const hemi_bake_desc *desc;
    bake_options options;
    bake_scene scene;
    lights lights;
    punctual *punctual;
    bake_setup setup;
    bake_result found;
    bool keeps_elements; /* they are not refined once the light has settled */
    hemi_result shaded;  /* why textures gave no materials, if they did not */
    hemi_solution *out;
    hemi_result prepared;
    struct watching *watching;
} baking;

/* A bake, or several, to reach a goal. */
typedef struct request {
    hemi_scene *in;
    const hemi_bake_desc *desc;
    hemi_solution *best;
    struct watching *watching;
    hemi_result result;
    hemi_forecast *forecast; /* where that alone is asked for */
} request;

/* ---- before the core bakes ---- */

/* By the shooters that columns would have at draft, whatever is asked for. A scene without any light gets a sky. */
static void choose_method(baking *b, double area) {
    bake_options columns = { .method = SOLVER_HYBRID, .quality = QUALITY_DRAFT };
    quality_resolve(&columns, area, b->setup.span.scale);
    const size_t emitting =
        mesh_descs_emitting(b->scene.meshes, b->scene.mesh_count, b->in->materials) + b->in->light_count;
    const size_t suns = lights_sun_count(&b->lights);
    bool far_lights = b->in->sky.struct_size > 0 || emitting == 0 || (suns > 0 && emitting > suns);
    size_t shooter_count = proxy_meshes_shooter_count(&b->scene, columns.element_size, columns.patch_size) +
                           tessellate_sliver_patches(b->scene.meshes, b->scene.mesh_count, columns.patch_size);
    bool transmits = mesh_descs_transmit(b->scene.meshes, b->scene.mesh_count, b->in->materials);
    char said[QUALITY_LINE_SIZE];
    b->options.method = quality_choose_method(&b->options, shooter_count, emitting, far_lights, transmits, said);
    if (*said && !b->in->method_said) context_log(b->in->context, HEMI_LOG_WARNING, "%s", said);
    b->in->method_said = b->in->method_said || *said;
    b->keeps_elements = transmits && b->options.method != SOLVER_ROWS;
    /* What adapted elements receive by columns, and on rows that are kept, knows no panes. */
    if (b->keeps_elements || (transmits && b->options.keeps_rows)) b->options.adapt_levels = -1;
}

/* Twice, since what has a proxy has few triangles then, and is said then. */
static void choose_hurry(baking *b, bool *said) {
    char line[QUALITY_LINE_SIZE];
    double triangles = mesh_descs_count(b->scene.meshes, b->scene.mesh_count);
    b->options.hurries = forecast_hurries(b->desc->time_limit_s, triangles, line);
    if (!said || *said || !b->options.hurries) return;
    context_log(b->in->context, HEMI_LOG_WARNING, "%s", line);
    *said = true;
}

static hemi_result prepare(baking *b) {
    bake_scene *f = &b->scene;
    hemi_result result = build_limit_surfaces(b->in, f);
    if (result != HEMI_OK) return result;
    if (!detail_levels_find(f) || !duplicate_meshes_find(b->in, f)) return HEMI_ERROR_MEMORY;
    const wide_ground_scene all = { f->meshes, f->mesh_count, b->in->materials, b->in->lights, b->in->light_count };
    double area = wide_ground_find(&all, &f->ground);
    if (!(area > 0.0) || isinf(area))
        return context_fail(b->in->context, HEMI_ERROR_NO_SURFACES, "there is no triangle with an area to bake");
    choose_method(b, area);
    if (b->options.method != SOLVER_ROWS) item_pool_warm(b->in->context->pool, jobs_worker_count(b->in->context->jobs));
    /* Rows are told by their rays, of which what is dark takes few, and not by how many elements there are. */
    if (b->options.method != SOLVER_ROWS && !f->ground.is_there) area = bake_scene_lit_area(b->in, f, &b->lights);
    if (area < 0.0) return HEMI_ERROR_MEMORY;
    bool is_free = b->options.method == SOLVER_ROWS && !(b->options.element_size > 0.0);
    quality_resolve(&b->options, area, b->setup.span.scale);
    b->options.max_elements = memory_most_elements(&b->options);
    choose_hurry(b, NULL);
    result = proxy_meshes_make(b->in, &b->options, f);
    double *size = &b->options.element_size;
    if (is_free) quality_fit_crowd(&b->options, tessellate_crowding(f->memory.memory, f->meshes, f->mesh_count, *size));
    if (is_free) quality_fit_common(&b->options, tessellate_common_size(f->memory.memory, f->meshes, f->mesh_count));
    if (!b->keeps_elements) quality_resolve_even(&b->options);
    if (result == HEMI_OK) choose_hurry(b, &b->in->hurry_said);
    if (result == HEMI_OK) result = build_scene(b->in, &b->options, f);
    if (result == HEMI_OK &&
        ldexp((double)f->mesh.element_count, 2 * (int)b->options.even_levels) > b->options.max_elements)
        return fail_too_many(b->in, ldexp(*size, -(int)b->options.even_levels), &b->options);
    if (result == HEMI_OK) say_clamped(b->in, f);
    prepared_scene_set_pool(&f->prepared, b->in->context->pool, &b->options);
    return result;
}

static hemi_result check_memory(baking *b) {
    char text[MESSAGE_SIZE];
    bool fits = memory_fit(&b->options, &b->scene.scene, &b->scene.mesh, text, sizeof text);
    if (!fits) return context_fail(b->in->context, HEMI_ERROR_LIMIT, "%s", text);
    if (*text) context_log(b->in->context, HEMI_LOG_INFO, "%s", text);
    return HEMI_OK;
}

/* What the whole call has told whoever watches. */
typedef struct watching {
    hemi_context *context;
    const hemi_bake_desc *desc;
    double start_s, fraction, error; /* error: the best estimate so far, below 0: none */
    bool is_cancelled;
} watching;

static bool watch_progress(void *user, const char *stage, double fraction, uint32_t shots, double unshot,
                           double error) {
    watching *w = user;
    double elapsed_s = monotonic_seconds() - w->start_s;
    context_say_pending(w->context);
    w->fraction = fmax(w->fraction, fraction);
    if (w->error >= 0.0 && (error < 0.0 || error > w->error)) error = w->error;
    if (!w->desc->progress || w->is_cancelled) return !w->is_cancelled;
    const hemi_progress now = { .struct_size = sizeof now,
                                .fraction = w->fraction,
                                .stage = stage,
                                .shots = shots,
                                .unshot_fraction = unshot,
                                .error_estimate = error,
                                .elapsed_s = elapsed_s,
                                .left_s = stage_watch_left(w->fraction, elapsed_s, w->desc->time_limit_s) };
    if (!w->desc->progress(w->desc->progress_user, &now)) w->is_cancelled = true;
    return !w->is_cancelled;
}

/* Nobody waits for what is left of a mesh: who stops here gets nothing. */
static bool watch_preparing(void *user) {
    baking *b = user;
    bool is_stopped = b->desc->stop && *b->desc->stop;
    if (is_stopped || !watch_progress(b->watching, "mesh", b->setup.span.low, 0, 1.0, 1.0))
        atomic_store(&b->in->context->memory.unwanted, true);
    return !block_unwanted(&b->in->context->memory);
}

static hemi_result begin_rows(baking *b) {
    const hemi_bake_desc *d = b->desc;
    char said[MESSAGE_SIZE];
    b->setup.rows = (rows_store){ d->rows_read, d->rows_write, d->rows_user, d->rows_name, NULL, NULL, NULL };
    const char *why = relight_stage_begin(&b->setup.rows, &b->scene.memory, b->in->mesh_count, &b->scene.scene, said);
    return why ? context_core_failure(b->in->context, why) : HEMI_OK;
}

static void prepare_alone(void *user) {
    baking *b = user;
    b->prepared = begin_rows(b);
    if (b->prepared == HEMI_OK) b->prepared = scene_lights(b->in, &b->lights, &b->punctual);
    if (b->prepared == HEMI_OK) b->prepared = scene_groups(b->in, &b->options, &b->scene.memory, &b->setup.groups);
    if (b->prepared == HEMI_OK) b->prepared = prepare(b);
}

/* A thread of its own makes it, so that whoever watches sees that it goes on. */
static hemi_result prepare_watched(baking *b) {
    jobs_run_alone(prepare_alone, watch_preparing, b);
    context_say_pending(b->in->context);
    return block_unwanted(&b->in->context->memory) ? HEMI_CANCELLED : b->prepared;
}

static void say_default_sky(void *user) {
    const baking *b = user;
    context_log(b->in->context, HEMI_LOG_WARNING, "nothing in the scene emits light; a sky of radiance 1 lights it");
}

static void say_fewer_rays(void *user, double share) {
    const baking *b = user;
    context_log(b->in->context, HEMI_LOG_WARNING,
                "the memory limit leaves %.0f %% of the rays that the quality means; allow more for less noise",
                100.0 * share);
}

static const char *shade(void *user) {
    baking *b = user;
    b->shaded = build_textures(b->in, &b->scene);
    return b->shaded == HEMI_OK ? NULL : "";
}

static void set_up(baking *b) {
    const bake_scene *f = &b->scene;
    b->setup.options = &b->options;
    b->setup.watch = (bake_watch){
        .clock = monotonic_seconds, .progress = watch_progress, .user = b->watching, .stop = b->desc->stop
    };
    b->setup.jobs = b->in->context->jobs;
    if (b->desc->keep_rows) b->setup.rows.write = chunk_memory_write, b->setup.rows.user = &b->out->rows;
    b->setup.lights = &b->lights;
    b->setup.scene =
        (refinement_setup){ &b->scene.scene, &b->scene.mesh, &b->scene.vertices, f->sources, b->setup.jobs };
    b->setup.memory = &b->scene.memory;
    b->setup.items = &f->prepared.surfaces.items;
    b->setup.triangle_surface = f->prepared.surfaces.triangle_piece;
    b->setup.patches = &f->prepared.patches;
    b->setup.elements = &f->prepared.elements;
    b->setup.emitters_are_split = f->prepared.emitters_are_split;
    b->setup.demodulated = &b->scene.demodulated;
    b->setup.fits_irradiance = f->duplicate_count > 0 || f->level_count > 0;
    b->setup.triangles = (output_triangles_input){ .input_count = (uint32_t)f->mesh_count,
                                                   .flat_face = f->prepared.flat_face,
                                                   .kept = f->kept };
    b->setup.shade = shade;
    b->setup.say_default_sky = say_default_sky;
    b->setup.say_fewer_rays = say_fewer_rays;
    b->setup.user = b;
}

/* ---- one bake ---- */

/* A surface whose material emits where a texture allows. */
static const char *unlit_emitter(const hemi_scene *in) {
    for (size_t i = 0; i < in->mesh_count; i++) {
        const hemi_mesh_desc *m = &in->meshes[i].desc;
        if (m->texture && !vec3_is_zero(in->materials[m->material].emission)) return m->name ? m->name : "";
    }
    return NULL;
}

static hemi_result fail_dark(const baking *b) {
    const char *name = unlit_emitter(b->in);
    if (name)
        return context_fail(b->in->context, HEMI_ERROR_NO_LIGHT,
                            "no light: the textures of all that emits are black where they are used, as on mesh "
                            "\"%.64s\"; paint light into the emissive texture, or add a light",
                            name);
    return context_fail(
        b->in->context, HEMI_ERROR_NO_LIGHT, "no light reaches the front of a surface: %s",
        b->setup.lights->sky_is_default
            ? "nothing in the scene emits, and no sky gets in; add a light, or open it to the sky"
            : "its lights are shut out, or see only backs; open it, move them, or make materials double-sided");
}

static hemi_result run_core(baking *b) {
    char message[MESSAGE_SIZE];
    set_up(b);
    const char *failure = bake(&b->setup, &b->found, message, sizeof message);
    if (b->found.no_light) return fail_dark(b);
    if (b->shaded != HEMI_OK) return b->shaded;
    return failure ? context_core_failure(b->in->context, failure) : b->found.cancelled ? HEMI_CANCELLED : HEMI_OK;
}

static hemi_result bake_scene_once(baking *b) {
    const bake_span *span = &b->setup.span;
    hemi_statistics *s = &b->out->statistics;
    hemi_result result = prepare_watched(b);
    s->time.mesh_s = monotonic_seconds() - span->start_s;
    if (result == HEMI_OK) result = check_memory(b);
    if (result == HEMI_OK) result = run_core(b);
    if (result == HEMI_OK) result = output_meshes(b->in, &b->options, &b->scene, &b->found.colors, b->out);
    if (result == HEMI_OK) result = output_light_groups(b->in, &b->options, &b->scene, &b->found, b->out);
    if (result == HEMI_OK) result = statistics_fill(&b->setup, &b->scene, &b->found, b->out);
    s->time.own_s = s->time.total_s = monotonic_seconds() - span->start_s;
    return result;
}

static hemi_result forecast_once(baking *b, hemi_forecast *out) {
    hemi_result result = prepare_watched(b);
    if (result != HEMI_OK) return result;
    size_t emitting = mesh_descs_emitting(b->scene.meshes, b->scene.mesh_count, b->in->materials);
    const forecast f = forecast_make(&b->options, &b->scene.scene, &b->scene.mesh, emitting > 0);
    const hemi_forecast found = { .method = bake_desc_method(b->options.method),
                                  .surfaces = (uint32_t)b->scene.scene.surface_count,
                                  .patches = (uint32_t)b->scene.mesh.patch_count,
                                  .elements = (uint32_t)f.elements,
                                  .samples = (uint32_t)f.samples,
                                  .processor_s = f.processor_s,
                                  .memory_bytes = (uint64_t)f.memory_bytes };
    const size_t least = DESC_THROUGH(hemi_forecast, memory_bytes);
    return view_give(out, least, &found, sizeof found) ? HEMI_OK : HEMI_ERROR_ARGUMENT;
}

static hemi_result bake_once(const request *r, const bake_options *options, const bake_span *span,
                             bake_outcome *outcome, hemi_solution **out) {
    baking b = { .in = r->in, .desc = r->desc, .options = *options, .setup.span = *span, .watching = r->watching };
    allocator *memory = &r->in->context->memory;
    b.scene.memory.memory = b.scene.scene.memory = b.scene.mesh.memory = memory;
    b.out = block_zeroed(memory, 1, sizeof *b.out);
    hemi_result result = HEMI_ERROR_MEMORY;
    if (b.out) result = r->forecast ? forecast_once(&b, r->forecast) : bake_scene_once(&b);
    *outcome = bake_outcome_of(&b.found, &b.options);
    bake_result_free(&b.found);
    lights_free(&b.lights);
    block_free(b.punctual);
    bake_scene_free(&b.scene);
    atomic_store(&memory->unwanted, false);
    if (result == HEMI_OK)
        *out = b.out;
    else
        hemi_solution_destroy(b.out);
    return result;
}

static bool attempt(void *user, const bake_options *options, const bake_span *span, bake_outcome *last) {
    request *r = user;
    hemi_solution *next = NULL;
    r->result = bake_once(r, options, span, last, &next);
    bool is_stopped = r->desc->stop && *r->desc->stop && !r->watching->is_cancelled;
    if (r->result == HEMI_CANCELLED && is_stopped && r->best) r->result = HEMI_OK;
    if (!next) return false;
    bool is_better = !r->best || next->statistics.error.estimate < r->best->statistics.error.estimate;
    hemi_solution_destroy(is_better ? r->best : next);
    if (is_better) r->best = next;
    last->error = r->watching->error = r->best->statistics.error.estimate;
    return true;
}

hemi_result hemi_bake(hemi_scene *in, const hemi_bake_desc *given, hemi_solution **out) {
    double start_s = monotonic_seconds();
    hemi_bake_desc desc;
    if (!in || !out) return HEMI_ERROR_ARGUMENT;
    *out = NULL;
    hemi_result taken = bake_desc_take(in->context, given, &desc);
    if (taken != HEMI_OK) return taken;
    watching w = { .context = in->context, .desc = &desc, .start_s = start_s, .error = -1.0 };
    request r = { .in = in, .desc = &desc, .watching = &w };
    const hemi_checkpoint none = { 0 }, *c = desc.checkpoint ? desc.checkpoint : &none;
    jobs_set_kept(in->context->jobs, &(kept_results){ c->find, c->add, c->user, desc.stop, 0 });
    const hemi_ranks alone = { .count = 1 }, *all = desc.ranks ? desc.ranks : &alone;
    ranks shared = { all->rank, all->count, all->exchange, all->user, false };
    jobs_set_ranks(in->context->jobs, shared.exchange ? &shared : NULL);
    context_begin(in->context);
    goal_reach(&(goal){ bake_desc_options(&desc), start_s, monotonic_seconds, desc.stop, attempt, &r });
    jobs_set_kept(in->context->jobs, NULL), jobs_set_ranks(in->context->jobs, NULL);
    if (shared.lost) r.result = context_fail(in->context, HEMI_ERROR_BACKEND, "another process of the bake is lost");
    /* Whoever watches sees the end, which not every attempt comes to. */
    const hemi_statistics *found = r.best ? &r.best->statistics : NULL;
    if (r.result == HEMI_OK && !watch_progress(&w, "reconstruct", 1.0, found->solver.shots,
                                               found->solver.unshot_fraction, found->error.estimate))
        r.result = HEMI_CANCELLED;
    /* What was stopped may have come to its end by then, or not: it was not let. */
    if (r.result == HEMI_OK && desc.stop && *desc.stop) r.best->statistics.solver.converged = false;
    hemi_result result = context_end(in->context, r.result);
    if (result == HEMI_OK)
        r.best->statistics.time.total_s = monotonic_seconds() - start_s, *out = r.best;
    else
        hemi_solution_destroy(r.best);
    return result;
}

hemi_result hemi_solution_relight(const hemi_solution *solution, hemi_scene *in, const hemi_bake_desc *given,
                                  hemi_solution **out) {
    hemi_bake_desc desc;
    if (!solution || !in) return HEMI_ERROR_ARGUMENT;
    if (!solution->rows.bytes) return context_fail(in->context, HEMI_ERROR_ARGUMENT, "relight: no rows were kept");
    hemi_result taken = bake_desc_take(in->context, given, &desc);
    if (taken != HEMI_OK) return taken;
    chunk_memory rows = { .bytes = solution->rows.bytes, .size = solution->rows.used };
    desc.keep_rows = false, desc.rows_write = NULL, desc.rows_read = chunk_memory_read, desc.rows_user = &rows;
    return hemi_bake(in, &desc, out);
}

hemi_result hemi_scene_forecast(hemi_scene *in, const hemi_bake_desc *given, hemi_forecast *out) {
    hemi_bake_desc desc;
    hemi_solution *none = NULL;
    if (!in || !out) return HEMI_ERROR_ARGUMENT;
    hemi_result result = bake_desc_take(in->context, given, &desc);
    if (result != HEMI_OK) return result;
    watching w = { .context = in->context, .desc = &desc, .start_s = monotonic_seconds(), .error = -1.0 };
    const request r = { .in = in, .desc = &desc, .watching = &w, .forecast = out };
    const bake_options options = bake_desc_options(&desc);
    context_begin(in->context);
    result = context_end(in->context, bake_once(&r, &options, &(bake_span){ 0 }, &(bake_outcome){ 0 }, &none));
    hemi_solution_destroy(none);
    return result;
}
