/* SPDX-License-Identifier: MIT
 * See bake.h. [Baum89] in seven steps: the light that no surface emits arrives; patches shoot theirs until little is
 * unshot; what near shooters give is corrected by the slope of their radiosity; elements are adapted to the light on
 * them; vertex colours are fitted to the samples; what is shown is measured against the radiosity equation; triangles
 * that the picture does not need are decimated.
 */
#include "bake/bake.h"

#include "bake/rows_stage.h"

/* The share of the whole that is done after each stage. */
static const double DONE_MESH = 0.05, DONE_LIGHT = 0.15, DONE_SOLVED = 0.7, DONE_ADAPTED = 0.95;

static const char NO_LIGHT[] = "no light reaches the front of a surface";

typedef struct baking {
    const bake_setup *setup;
    bake_result *out;
    shooting shooting;
    vertex_colors_setup colors;
    double done, unshot; /* done never falls */
    double noise;        /* of rows: rows_stage.h */
    uint32_t shots;
    char *message;
    size_t message_size;
} baking;

static bool report(baking *b, const char *stage, double done) {
    const bake_watch *w = &b->setup->watch;
    const bake_span *span = &b->setup->span;
    b->done = fmax(b->done, done);
    if (w->progress &&
        !w->progress(w->user, stage, span->low + (span->high - span->low) * b->done, b->shots, b->unshot))
        b->out->cancelled = true;
    return !b->out->cancelled;
}

static bool report_light(void *user, double fraction) {
    return report(user, "light", DONE_MESH + (DONE_LIGHT - DONE_MESH) * fraction);
}

static bool report_shooting(void *user, double fraction, uint32_t shots, double unshot) {
    baking *b = user;
    b->shots = shots, b->unshot = unshot;
    return report(b, "factors", DONE_LIGHT + (DONE_SOLVED - DONE_LIGHT) * fraction);
}

static bool report_adapting(void *user, double fraction) {
    return report(user, "refine", DONE_SOLVED + (DONE_ADAPTED - DONE_SOLVED) * fraction);
}

/* ---- the stages: NULL, or why one failed ---- */

static const char *light_directly(baking *b) {
    const bake_setup *setup = b->setup;
    direct_light *direct = &b->out->direct;
    bool emits = mesh_emits(setup->scene.mesh);
    double begin = setup->watch.clock();
    if (!lights_open(jobs_memory(setup->jobs), emits, setup->options->direct_light.fineness, setup->lights))
        return "out of memory";
    if (setup->lights->sky_is_default) setup->say_default_sky(setup->user);
    if (!lights_any(setup->lights)) return NULL;
    const direct_light_setup how = direct_light_setup_of(setup, report_light, b);
    bool rows = setup->options->method == SOLVER_ROWS; /* which see the sky themselves */
    const char *failure = lights_arrive(setup->lights, !rows, &how, direct, b->message, b->message_size);
    b->out->direct_light_s = setup->watch.clock() - begin;
    b->out->cancelled = direct->cancelled;
    b->out->no_light = !failure && !direct->cancelled && !emits && !(direct->punctual_w + direct->sky_w > 0.0) &&
                       !(rows && setup->lights->has_sky);
    return b->out->no_light ? NO_LIGHT : failure;
}

/* Near shooters are corrected on the way: the solution is finished when the solver returns. */
static const char *shoot(baking *b) {
    bake_result *out = b->out;
    if (!shooting_open(b->setup, &b->shooting)) return "out of memory";
    const char *failure = b->setup->options->method == SOLVER_ROWS
                              ? rows_stage_solve(b->setup, &b->shooting, &out->direct, report_shooting, b,
                                                 &out->solution, &b->noise, b->message, b->message_size)
                              : shooting_solve(b->setup, &b->shooting, &out->direct, report_shooting, b, &out->solution,
                                               b->message, b->message_size);
    b->shots = out->solution.shots, b->unshot = out->solution.unshot_fraction;
    out->cancelled = out->solution.cancelled;
    if (b->setup->options->method == SOLVER_ROWS && !failure && !out->cancelled && !mesh_emits(b->setup->scene.mesh) &&
        !(out->direct.punctual_w + out->direct.sky_w > 0.0)) {
        out->no_light = true;
        return NO_LIGHT;
    }
    return failure;
}

/* Elements are adapted while there is time for it. */
static const char *adapt_elements(baking *b) {
    const bake_setup *setup = b->setup;
    const bake_options *o = setup->options;
    double begin = setup->watch.clock();
    bool is_late = o->time_limit_s > 0.0 && begin - setup->span.start_s > o->time_limit_s;
    bool is_stopped = setup->watch.stop && *setup->watch.stop;
    const char *failure = NULL;
    b->out->coarse_elements = (uint32_t)setup->scene.mesh->element_count;
    if (b->out->solution.corrected && !is_late && !is_stopped) {
        const adapt_setup how = adapt_setup_of(setup, report_adapting, b);
        failure = adapt(&how, &b->out->direct, &b->out->solution, &b->out->adapted, b->message, b->message_size);
        b->out->cancelled = b->out->adapted.cancelled;
    }
    progressive_forget_shooters(&b->out->solution);
    b->out->adapt_s = setup->watch.clock() - begin;
    return failure;
}

static const char *fit(baking *b) {
    b->colors = vertex_colors_setup_of(b->setup, &b->out->direct, &b->out->solution);
    if (!vertex_colors_open(&b->colors, &b->out->colors)) return "out of memory";
    if (!b->colors.demodulated && !b->colors.fits_irradiance) progressive_forget_samples(&b->out->solution);
    return vertex_colors_fit(&b->colors, &b->out->colors);
}

static const char *measure(baking *b) {
    if (b->setup->options->method == SOLVER_ROWS) {
        vertex_colors_estimate(&b->colors, b->noise, &b->out->colors);
        return NULL;
    }
    return vertex_colors_measure(&b->colors, &b->out->colors, b->message, b->message_size);
}

static const char *decimate_output(baking *b) {
    return vertex_colors_decimate(&b->colors, &b->out->colors);
}

const char *bake(const bake_setup *setup, bake_result *out, char *message, size_t message_size) {
    static const char *(*const stages[])(baking *) = { light_directly, shoot,          adapt_elements, fit,
                                                       measure,        decimate_output };
    baking b = { .setup = setup, .out = out, .unshot = 1.0, .message = message, .message_size = message_size };
    const char *failure = NULL;
    *out = (bake_result){ 0 };
    report(&b, "mesh", DONE_MESH);
    for (size_t i = 0; !failure && !out->cancelled && i < sizeof stages / sizeof *stages; i++) failure = stages[i](&b);
    shooting_free(&b.shooting);
    return failure;
}

void bake_result_free(bake_result *r) {
    direct_light_free(&r->direct);
    progressive_result_free(&r->solution);
    vertex_colors_free(&r->colors);
}
