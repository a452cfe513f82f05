/* SPDX-License-Identifier: MIT */
#include "bake/stage_watch.h"

#include "bake/forecast.h"
#include "solver/row_gather.h"

#include <math.h>

/* done: the share of the whole that is done after a stage. latest: the share of a time limit after which it ends with
 * what it has: what comes after it must fit in too, colors of what makes colours of light, and what shoots nothing more
 * is worth less than a shot. Light that has not been shot is nothing to show: whoever stops before waits for nothing.
 */
static const struct {
    const char *name;
    double done, latest, colors;
    bool is_vain;
} STAGES[] = {
    [STAGE_MESH] = { "mesh", 0.05, 1.0, 0.0, true },         [STAGE_LIGHT] = { "light", 0.15, 0.4, 1.0, true },
    [STAGE_FACTORS] = { "factors", 0.7, 0.8, 1.0, false },   [STAGE_REFINE] = { "refine", 0.95, 0.86, 1.0, false },
    [STAGE_FIT] = { "reconstruct", 0.98, 0.92, 0.3, false }, [STAGE_DECIMATE] = { "reconstruct", 1.0, 0.95, 0.0, false }
};

static bool is_stopped(const stage_watch *w) {
    return w->setup->watch.stop && *w->setup->watch.stop;
}

bool stage_watch_begin(stage_watch *w, bake_stage stage) {
    const bake_setup *setup = w->setup;
    double limit = setup->options->time_limit_s;
    w->stage = stage;
    w->latest = 0.0;
    if (limit > 0.0)
        w->latest = setup->span.start_s + forecast_end_s(limit, STAGES[stage].latest, STAGES[stage].colors,
                                                         setup->scene.scene, setup->scene.mesh, w->mesh_s);
    atomic_store(&w->over, false);
    stage_watch_report(w, 0.0);
    return !atomic_load(&w->over);
}

/* What is unshot is the most of it while patches shoot, and noise while rays are cast; what elements are too coarse for
 * is known at the end. Before that all light is missing. */
static double error_so_far(const stage_watch *w) {
    const bake_result *r = w->out;
    if (r->colors.points > 0) return r->colors.error;
    if (r->solution.by_rows) return w->noise;
    return r->solution.curve_count > 0 ? r->solution.unshot_error : 1.0;
}

bool stage_watch_report(stage_watch *w, double fraction) {
    const bake_watch *to = &w->setup->watch;
    const bake_span *span = &w->setup->span;
    double before = w->stage == STAGE_MESH ? 0.0 : STAGES[w->stage - 1].done;
    w->done = fmax(w->done, before + fraction * (STAGES[w->stage].done - before));
    if (is_stopped(w) || (w->latest > 0.0 && to->clock() > w->latest)) atomic_store(&w->over, true);
    if (to->progress && !to->progress(to->user, STAGES[w->stage].name, span->low + (span->high - span->low) * w->done,
                                      w->shots, w->unshot, error_so_far(w)))
        w->out->cancelled = true;
    return !w->out->cancelled && !(STAGES[w->stage].is_vain && is_stopped(w));
}

bool stage_watch_progress(void *user, double fraction) {
    return stage_watch_report(user, fraction);
}

bool stage_watch_shooting(void *user, double fraction, uint32_t shots, double unshot) {
    stage_watch *w = user;
    w->shots = shots, w->unshot = unshot;
    return stage_watch_report(w, fraction);
}

bool stage_watch_rows(void *user, const rows_progress *so_far) {
    stage_watch *w = user;
    w->unshot = so_far->residual, w->noise = so_far->noise;
    return stage_watch_report(w, so_far->fraction);
}

void stage_watch_solved(stage_watch *w) {
    const progressive_result *s = &w->out->solution;
    w->shots = s->shots, w->unshot = s->unshot_fraction;
    if (s->half_difference) w->noise = row_noise(w->setup->scene.mesh, s->irradiance, s->half_difference);
}

static bool wait(void *user) {
    stage_watch *w = user;
    return stage_watch_report(w, w->stage == STAGE_REFINE ? w->out->adapted.done : 0.0);
}

watcher stage_watch_watcher(stage_watch *w) {
    return (watcher){ wait, w, &w->over };
}

double stage_watch_left(double fraction, double elapsed_s, double limit_s) {
    double left = fraction > 0.02 ? elapsed_s * (1.0 - fraction) / fraction : -1.0;
    if (limit_s > 0.0 && (left < 0.0 || left > limit_s - elapsed_s)) left = fmax(limit_s - elapsed_s, 0.0);
    return left;
}
