/* SPDX-License-Identifier: MIT
 * See bake.h. [Baum89] in seven steps: the light that no surface emits arrives; patches shoot theirs until little is
 * unshot; what near shooters give is corrected by the slope of their radiosity; elements are adapted to the light on
 * them; vertex colours are fitted to the samples; what is shown is measured against the radiosity equation; triangles
 * that the picture does not need are decimated.
 */
#include "bake/bake.h"

#include "bake/relight_stage.h"
#include "bake/rows_stage.h"
#include "bake/stage_watch.h"
#include "mesh/emission_edges.h"

static const char NEEDS_ROWS[] =
    "how often light is reflected, how far it is followed, groups of lights and kept rows are for the method rows "
    "alone, in a build with Embree; take that or auto, or leave it open";
static const char NO_LIGHT[] = "no light reaches the front of a surface";

typedef struct baking {
    const bake_setup *setup;
    bake_result *out;
    stage_watch watch;
    shooting shooting;
    vertex_colors_setup colors;
    double fit_s; /* when fitting began, by the clock */
    rows_error rows;
    char *message;
    size_t message_size;
} baking;

/* ---- the stages: NULL, or why one failed ---- */

static const char *light_directly(baking *b) {
    const bake_setup *setup = b->setup;
    direct_light *direct = &b->out->direct;
    bool emits = mesh_emits(setup->scene.mesh);
    double begin = setup->watch.clock();
    bool rows = setup->options->method == SOLVER_ROWS; /* which see the sky themselves, and draw among lights */
    if (!lights_open(jobs_memory(setup->jobs), emits, rows, setup->options->direct_light.fineness, setup->lights))
        return "out of memory";
    if (setup->lights->sky_is_default) setup->say_default_sky(setup->user);
    if (!lights_any(setup->lights) || setup->rows.read) return NULL; /* kept rows are of elements to come */
    stage_watch_begin(&b->watch, STAGE_LIGHT);
    direct_light_setup how = direct_light_setup_of(setup, stage_watch_progress, &b->watch);
    how.deadline_s = b->watch.latest;
    const char *failure = lights_arrive(setup->lights, !rows, &how, direct, b->message, b->message_size);
    direct->seconds = setup->watch.clock() - begin;
    b->out->cancelled = direct->cancelled;
    b->out->no_light = !failure && !direct->cancelled && !emits && !(direct->punctual_w + direct->sky_w > 0.0) &&
                       !(rows && (setup->lights->has_sky || setup->lights->is_crowd));
    return b->out->no_light ? NO_LIGHT : failure;
}

static const char *shoot_columns(baking *b) {
    bake_result *out = b->out;
    if (quality_needs_rows(b->setup->options)) return NEEDS_ROWS;
    if (!shooting_open(b->setup, &b->shooting)) return "out of memory";
    if (b->watch.latest > 0.0) b->shooting.time_limit_s = b->watch.latest - b->setup->span.start_s;
    return shooting_solve(b->setup, &b->shooting, &out->direct, stage_watch_shooting, &b->watch, &out->solution,
                          b->message, b->message_size);
}

/* Near shooters are corrected on the way: the solution is finished when the solver returns. */
static const char *shoot(baking *b) {
    bake_result *out = b->out;
    stage_watch_begin(&b->watch, STAGE_FACTORS);
    const char *failure = b->setup->options->method == SOLVER_ROWS
                              ? rows_stage_solve(b->setup, &out->direct, stage_watch_rows, &b->watch, &out->solution,
                                                 b->message, b->message_size)
                              : shoot_columns(b);
    out->cancelled = out->solution.cancelled;
    if (!failure && !out->cancelled) stage_watch_solved(&b->watch);
    out->no_light = b->setup->options->method == SOLVER_ROWS && !failure && !out->cancelled &&
                    rows_stage_is_dark(b->setup, &out->direct, &out->solution);
    return out->no_light ? NO_LIGHT : failure;
}

/* Elements are adapted while there is time for it. */
static const char *adapt_elements(baking *b) {
    const bake_setup *setup = b->setup;
    double begin = setup->watch.clock();
    const char *failure = NULL;
    b->out->coarse_elements = (uint32_t)setup->scene.mesh->element_count;
    if ((b->out->solution.corrected || b->out->solution.final_gather) && stage_watch_begin(&b->watch, STAGE_REFINE)) {
        adapt_setup how = adapt_setup_of(setup);
        how.watch = stage_watch_watcher(&b->watch);
        failure = adapt(&how, &b->out->direct, &b->out->solution, &b->out->adapted, b->message, b->message_size);
        b->out->cancelled = b->out->adapted.cancelled;
    }
    if (!failure && !b->out->cancelled && b->out->solution.half_difference)
        failure =
            rows_stage_judge(setup, stage_watch_watcher(&b->watch), b->out, &b->rows, b->message, b->message_size);
    progressive_forget_shooters(&b->out->solution);
    b->out->adapt_s = setup->watch.clock() - begin;
    return failure;
}

static const char *fit(baking *b) {
    const refinement_setup *on = &b->setup->scene;
    b->fit_s = b->setup->watch.clock();
    if (!emission_edges_part(on->scene, on->mesh, on->vertices)) return "out of memory";
    b->colors = vertex_colors_setup_of(b->setup, &b->out->direct, &b->out->solution);
    b->colors.watch = stage_watch_watcher(&b->watch);
    stage_watch_begin(&b->watch, STAGE_FIT);
    if (!vertex_colors_open(&b->colors, &b->out->colors)) return "out of memory";
    if (!b->colors.demodulated && !b->colors.fits_irradiance) progressive_forget_samples(&b->out->solution);
    return vertex_colors_fit(&b->colors, &b->out->colors);
}

static const char *measure(baking *b) {
    if (b->setup->options->method == SOLVER_ROWS) {
        vertex_colors_estimate(&b->colors, b->rows.noise, b->rows.interpolation, &b->out->colors);
        return light_groups_fit(b->setup, &b->colors, &b->out->colors, &b->out->groups);
    }
    return vertex_colors_measure(&b->colors, &b->out->colors, b->message, b->message_size);
}

static const char *decimate_output(baking *b) {
    stage_watch_begin(&b->watch, STAGE_DECIMATE);
    const char *failure = vertex_colors_decimate(&b->colors, &b->out->colors);
    if (!failure) failure = relight_stage_end(b->setup);
    b->out->reconstruct_s = b->setup->watch.clock() - b->fit_s;
    return failure;
}

const char *bake(const bake_setup *setup, bake_result *out, char *message, size_t message_size) {
    static const char *(*const stages[])(baking *) = { light_directly, shoot,          adapt_elements, fit,
                                                       measure,        decimate_output };
    baking b = { .setup = setup, .out = out, .watch = { setup, out, .unshot = 1.0, .noise = 1.0 } };
    b.message = message, b.message_size = message_size;
    b.watch.mesh_s = setup->watch.clock() - setup->span.start_s;
    const char *failure = NULL;
    *out = (bake_result){ 0 };
    stage_watch_report(&b.watch, 1.0);
    for (size_t i = 0; !failure && !out->cancelled && i < sizeof stages / sizeof *stages; i++) failure = stages[i](&b);
    shooting_free(&b.shooting);
    return failure;
}

void bake_result_free(bake_result *r) {
    direct_light_free(&r->direct);
    progressive_result_free(&r->solution);
    vertex_colors_free(&r->colors);
    light_groups_free(&r->groups);
}
