/* SPDX-License-Identifier: MIT
 * See rows_stage.h.
 */
#include "bake/rows_stage.h"

#include "base/block.h"
#include "solver/rows.h"

#include <string.h>

/* Nothing is to shoot; this is what roundings leave. */
static const double UNSHOT = 1e-9;

/* The share of the work that is done when rays begin. */
static const double DONE_SHOT = 0.05;

/* Of a time limit, what rays may take: then elements are fitted, and triangles merged. */
static const double SHARE_OF_TIME = 0.75;

/* Fewer than these of the rays that the quality means are worth a line. */
static const double ALL_RAYS = 0.99;

typedef struct rows_watch {
    bool (*progress)(void *user, double fraction, uint32_t shots, double unshot_fraction);
    void *user;
    const progressive_result *solution;
} rows_watch;

static bool watch_shooting(void *user, double fraction, uint32_t shots, double unshot_fraction) {
    const rows_watch *w = user;
    return w->progress(w->user, DONE_SHOT * fraction, shots, unshot_fraction);
}

static bool watch_rows(void *user, double fraction) {
    const rows_watch *w = user;
    return w->progress(w->user, DONE_SHOT + (1.0 - DONE_SHOT) * fraction, w->solution->shots, 0.0);
}

/* A solution in which nothing is shot, since nothing reflects or emits: it holds what arrives from lights. */
static const char *begin_solution(const bake_setup *setup, const shooting *s, const direct_light *direct, rows_watch *w,
                                  progressive_result *out, char *message, size_t message_size) {
    const mesh *m = setup->scene.mesh;
    mesh black = *m;
    black.patches = block_new(m->memory, (m->patch_count + 1) * sizeof *black.patches);
    if (!black.patches) return "out of memory";
    memcpy(black.patches, m->patches, m->patch_count * sizeof *black.patches);
    for (size_t p = 0; p < m->patch_count; p++)
        for (int c = 0; c < 3; c++) black.patches[p].material.rho[c] = black.patches[p].material.M[c] = 0.0;
    progressive_setup solver = { .method = SOLVER_HYBRID,
                                 .patches = setup->patches,
                                 .columns = s->columns,
                                 .jobs = setup->jobs,
                                 .arrived = direct->irradiance,
                                 .open_rows = true,
                                 .even_shooters = true,
                                 .unshot_target = UNSHOT,
                                 .time_limit_s = setup->options->time_limit_s,
                                 .start_s = setup->span.start_s,
                                 .memory_limit = setup->options->memory_limit,
                                 .clock = setup->watch.clock,
                                 .progress = watch_shooting,
                                 .progress_user = w,
                                 .stop = setup->watch.stop };
    solver.columns.mesh = &black;
    const char *failure = progressive_solve(&solver, out, message, message_size);
    progressive_forget_shooters(out);
    block_free(black.patches);
    return failure;
}

static double emitted_w(const mesh *m) {
    double sum = 0.0;
    for (size_t p = 0; p < m->patch_count; p++)
        for (int c = 0; c < 3; c++) sum += m->patches[p].area * m->patches[p].coverage * m->patches[p].material.M[c];
    return sum;
}

/* What emitters give away is known by what arrived: the rest met nothing. */
static void keep_books(const rows_result *r, const mesh *m, direct_light *direct, progressive_result *out) {
    double emitted = emitted_w(m);
    direct->sky_w = r->sky_w;
    out->books.emitted += emitted;
    out->books.escaped += emitted - r->emitters_w;
    out->books.emitted += r->sky_w;
    out->books.escaped += r->escaped_w;
    out->books.absorbed = r->absorbed_w;
    out->books.unshot = r->residual_w;
    out->unshot_fraction = out->books.emitted > 0.0 ? r->residual_w / out->books.emitted : 0.0;
}

const char *rows_stage_solve(const bake_setup *setup, const shooting *s, direct_light *direct,
                             bool (*progress)(void *user, double fraction, uint32_t shots, double unshot_fraction),
                             void *user, progressive_result *out, double *noise, char *message, size_t message_size) {
    rows_watch w = { progress, user, out };
    rows_result rows = { 0 };
    double limit = setup->options->time_limit_s;
    const char *failure = begin_solution(setup, s, direct, &w, out, message, message_size);
    if (failure || out->cancelled) return failure;
    double begin = setup->watch.clock();
    failure = rows_solve(&(rows_setup){ .scene = setup->scene.scene,
                                        .mesh = setup->scene.mesh,
                                        .jobs = setup->jobs,
                                        .seed = setup->options->seed,
                                        .first_rays = setup->options->rows_first,
                                        .further_rays = setup->options->rows_further,
                                        .lights = setup->lights,
                                        .direct = out->irradiance,
                                        .emitter_rays = setup->options->rows_emitter,
                                        .progress = watch_rows,
                                        .progress_user = &w,
                                        .stop = setup->watch.stop,
                                        .deadline_s = limit > 0.0 ? setup->span.start_s + SHARE_OF_TIME * limit : 0.0,
                                        .clock = setup->watch.clock,
                                        .memory_limit = setup->options->memory_limit },
                         &rows, message, message_size);
    out->solve_s += setup->watch.clock() - begin;
    out->cancelled = rows.cancelled;
    if (rows.cut) out->converged = false;
    if (!failure && rows.ray_share < ALL_RAYS) setup->say_fewer_rays(setup->user, rows.ray_share);
    if (!failure && !rows.cancelled) {
        keep_books(&rows, setup->scene.mesh, direct, out);
        memset(out->crossed, true, setup->scene.mesh->patch_count); /* row sums say which samples are buried */
        progressive_forget_samples(out);
        out->irradiance = rows.irradiance, out->row_sum = rows.row_sum;
        *noise = rows.noise;
        memset(&rows, 0, sizeof rows);
    }
    rows_result_free(&rows);
    return failure;
}
