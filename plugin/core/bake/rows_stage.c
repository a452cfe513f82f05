/* SPDX-License-Identifier: MIT */
#include "bake/rows_stage.h"

#include "bake/forecast.h"
#include "bake/interpolation_error.h"
#include "bake/relight_stage.h"
#include "base/block.h"
#include "geometry/vec3.h"
#include "reconstruct/noise_filter.h"
#include "scene/contact_lines.h"
#include "solver/row_gather.h"

#include <math.h>
#include <string.h>

/* Of a time limit, what rays may take at most: then elements are fitted, and triangles merged. But the least that there
 * must be may take longer. */
static const double SHARE_OF_TIME = 0.75, SHARE_OF_LEAST = 0.9;

/* Fewer than these of the rays that the quality means are worth a line. */
static const double ALL_RAYS = 0.99;

/* A sky that nobody asked for and that lights no more of the area than this, as the underside of what stands in a
 * closed room, lights nothing that is looked at. */
static const double LIT_SHARE = 0.02;

/* Of the noise that is smoothed away, squared, so much is taken for light that was lost: which of the two it was is not
 * known. By it the estimates of ten real scenes and of plain rooms are within a factor two of what these are off by. */
static const double LOST = 0.35;

typedef struct rows_watch {
    const bake_setup *setup;
    bool (*progress)(void *user, const rows_progress *so_far);
    void *user;
    double noise; /* of the last point of the curve */
    progressive_result *out;
} rows_watch;

/* Of noise, fitting leaves the share that nodes are of samples. */
static double fitted_share(const mesh *m) {
    return fmin((double)m->node_count / ((double)m->sample_count + 1.0), 1.0);
}

/* Without memory for it the curve is a point short, and the bake ends for want of memory. */
static void add_curve_point(const bake_setup *setup, double unshot, double error, progressive_result *out) {
    size_t bytes = (out->curve_count + 1) * sizeof *out->curve;
    progressive_point *grown = block_resize(jobs_memory(setup->jobs), out->curve, bytes);
    if (!grown) return;
    out->curve = grown;
    out->curve[out->curve_count++] = (progressive_point){ .t_s = setup->watch.clock() - setup->span.start_s,
                                                          .unshot_fraction = unshot,
                                                          .unshot_error = error };
}

/* What is known of the noise is said at once, so the curve is the same however often anybody asks. */
static bool watch_rays(void *user, const rows_progress *so_far) {
    rows_watch *w = user;
    if (so_far->noise != w->noise) {
        double share = fitted_share(w->setup->scene.mesh);
        add_curve_point(w->setup, so_far->residual, so_far->noise * sqrt(share), w->out);
        w->noise = so_far->noise;
    }
    return w->progress(w->user, so_far);
}

bool rows_stage_begin(const bake_setup *setup, const direct_light *direct, progressive_result *out) {
    const mesh *m = setup->scene.mesh;
    allocator *memory = jobs_memory(setup->jobs);
    *out = (progressive_result){ .by_rows = true, .converged = true, .kept_rows = out->kept_rows };
    out->irradiance = block_zeroed(memory, 3 * m->sample_count + 1, sizeof *out->irradiance);
    out->crossed = block_zeroed(memory, m->patch_count + 1, sizeof *out->crossed);
    add_curve_point(setup, 1.0, 1.0, out);
    if (!out->irradiance || !out->crossed || !out->curve) return false;
    if (direct->irradiance) memcpy(out->irradiance, direct->irradiance, 3 * m->sample_count * sizeof *out->irradiance);
    for (size_t p = 0; p < m->patch_count; p++) out->light_count += material_emits(&m->patches[p].material);
    return true;
}

/* What emitters give away is known by what arrived: the rest hit nothing. In a closed room that is none, but for the
 * noise of rays; what arrived beyond what was sent cannot have been absorbed. */
static void keep_books(const bake_setup *setup, const rows_result *r, direct_light *direct, progressive_result *out) {
    const mesh *m = setup->scene.mesh;
    double emitted_w = 0.0, arrived_w = 0.0;
    for (size_t p = 0; p < m->patch_count; p++) {
        const patch *one = &m->patches[p];
        for (size_t c = 0; c < 3 && one->contact != CONTACT_COPY; c++) {
            emitted_w += one->area * one->material.M[c];
            for (size_t s = one->first_sample; direct->irradiance && s < one->first_sample + one->sample_count; s++)
                arrived_w += m->sample_area[s] * direct->irradiance[3 * s + c] * (1.0 - one->material.transmittance[c]);
        }
    }
    direct->sky_w = r->sky_w;
    direct->punctual_w += r->lights_w - direct->crowd_w, direct->crowd_w = r->lights_w;
    const double past = r->escaped_w + emitted_w - r->emitters_w;
    out->books = (energy_books){ .emitted = emitted_w + arrived_w + r->lights_w + r->sky_w,
                                 .absorbed = r->absorbed_w + fmin(past, 0.0),
                                 .escaped = fmax(past, 0.0),
                                 .unshot = r->residual_w };
    out->unshot_fraction = out->books.emitted > 0.0 ? r->residual_w / out->books.emitted : 0.0;
    if (setup->options->bounces != 0) out->unshot_fraction = 0.0; /* nobody asked for it */
}

void rows_stage_take(const bake_setup *setup, rows_result *r, direct_light *direct, progressive_result *out) {
    keep_books(setup, r, direct, out);
    memset(out->crossed, true, setup->scene.mesh->patch_count); /* row sums say which samples are buried */
    progressive_forget_samples(out);
    out->irradiance = r->irradiance, out->row_sum = r->row_sum, out->half_difference = r->half_difference;
    out->final_gather = r->final_gather;
    out->ray_noise = r->ray_noise, out->emitter_noise = r->emitter_noise;
    memset(r, 0, sizeof *r);
    const mesh *m = setup->scene.mesh;
    double noise = row_noise(m, out->irradiance, out->half_difference);
    add_curve_point(setup, out->unshot_fraction, noise * sqrt(fitted_share(m)), out);
}

/* Emitters are asked by themselves: what else there is to see of direct light is the sky. */
static bool sees_emitters_alone(const bake_setup *setup) {
    return setup->options->bounces < 0 && !setup->lights->has_sky;
}

/* Rows that were kept are soon read, and light settles as soon: until then there is none. */
static bool watch_relighting(void *user) {
    const rows_watch *w = user;
    return w->progress(w->user, &(rows_progress){ .fraction = 0.9, .residual = 1.0, .noise = 1.0 });
}

static const char *relight(const bake_setup *setup, rows_watch *w, direct_light *direct, progressive_result *out,
                           char *message, size_t message_size) {
    double begin = setup->watch.clock();
    const char *failure = relight_stage_solve(setup, direct, watch_relighting, w, out, message, message_size);
    out->solve_s = setup->watch.clock() - begin - direct->seconds;
    return failure;
}

/* By the clock; 0: whenever they are all cast. begin_s: when light was first looked for. */
static double rays_end(const bake_setup *setup, double share, double begin_s) {
    const double limit = setup->options->time_limit_s, start_s = setup->span.start_s;
    if (!(limit > 0.0)) return 0.0;
    return start_s + forecast_end_s(limit, share, 1.0, setup->scene.scene, setup->scene.mesh, begin_s - start_s);
}

const char *rows_stage_solve(const bake_setup *setup, direct_light *direct,
                             bool (*progress)(void *user, const rows_progress *so_far), void *user,
                             progressive_result *out, char *message, size_t message_size) {
    rows_watch w = { setup, progress, user, 1.0, out };
    rows_result rows = { 0 };
    double begin = setup->watch.clock();
    if (setup->rows.read) return relight(setup, &w, direct, out, message, message_size);
    if (!rows_stage_begin(setup, direct, out)) return "out of memory";
    const char *failure =
        rows_solve(&(rows_setup){ .scene = setup->scene.scene,
                                  .mesh = setup->scene.mesh,
                                  .jobs = setup->jobs,
                                  .seed = setup->options->seed,
                                  .initial_rays = setup->options->rows_initial,
                                  .adaptive_rays = sees_emitters_alone(setup) ? 0.0 : setup->options->rows_adaptive,
                                  .noise_target = setup->options->rows_noise,
                                  .lights = setup->lights,
                                  .direct = out->irradiance,
                                  .emitter_rays = setup->options->rows_emitter,
                                  .progress = watch_rays,
                                  .progress_user = &w,
                                  .stop = setup->watch.stop,
                                  .deadline_s = rays_end(setup, SHARE_OF_TIME, begin),
                                  .least_s = rays_end(setup, SHARE_OF_LEAST, begin),
                                  .clock = setup->watch.clock,
                                  .memory_limit = setup->options->memory_limit,
                                  .keeps = setup->options->adapt_levels > 0,
                                  .keeps_rows = setup->options->keeps_rows,
                                  .bounces = setup->options->bounces,
                                  .open_distance = setup->options->open_distance },
                   &rows, message, message_size);
    if (rows.final_gather) rows.final_gather->geometry = relight_digest(setup->scene.scene, setup->scene.mesh);
    out->solve_s = setup->watch.clock() - begin;
    out->cancelled = rows.cancelled;
    if (rows.cut) out->converged = false;
    if (!failure && rows.ray_share < ALL_RAYS) setup->say_fewer_rays(setup->user, rows.ray_share);
    if (!failure && !rows.cancelled) rows_stage_take(setup, &rows, direct, out);
    rows_result_free(&rows);
    return failure;
}

bool rows_stage_is_dark(const bake_setup *setup, const direct_light *direct, const progressive_result *solution) {
    const mesh *m = setup->scene.mesh;
    double lit = 0.0, area = 0.0;
    if (mesh_emits(m) || direct->punctual_w > 0.0) return false;
    if (!setup->lights->sky_is_default) return !(direct->sky_w > 0.0);
    for (size_t s = 0; s < m->sample_count; s++) {
        area += m->sample_area[s];
        if (!vec3_is_zero(&solution->irradiance[3 * s])) lit += m->sample_area[s];
    }
    return lit <= LIT_SHARE * area;
}

/* Of each element, integrated: squares of its noise and of what it is too large for, and of its radiance. */
typedef struct element_errors {
    double *noise, *uneven, *levels;
} element_errors;

static void add_noise(const mesh *m, const double *half_difference, double share, double *noise) {
    for (size_t e = 0; e < m->element_count; e++) {
        double square = 0.0;
        row_add_squares(m, half_difference, e, &square);
        noise[e] += share * square / (PI * PI);
    }
}

static double interpolation_of(const mesh *m, const element_errors *off) {
    double sum = 0.0, level = 0.0;
    for (size_t e = 0; e < m->element_count; e++) sum += off->uneven[e], level += off->levels[e];
    return level > 0.0 ? sqrt(fmax(sum, 0.0) / level) : 0.0;
}

static bool find_worst(const bake_setup *setup, element_errors *off, part_error *out) {
    const mesh *m = setup->scene.mesh;
    double share = fitted_share(m);
    for (size_t e = 0; e < m->element_count; e++) off->uneven[e] += share * off->noise[e];
    return worst_part_find(setup->scene.scene, m, off->uneven, off->levels, out);
}

const char *rows_stage_judge(const bake_setup *setup, watcher watch, bake_result *baked, rows_error *out, char *message,
                             size_t message_size) {
    const mesh *m = setup->scene.mesh;
    const char *failure =
        setup->options->keeps_rows ? relight_stage_settle(setup, watch, baked, message, message_size) : NULL;
    const direct_light *direct = &baked->direct;
    const progressive_result *solution = &baked->solution;
    if (failure || baked->cancelled) return failure;
    const noise_filter_input noisy = { .scene = setup->scene.scene,
                                       .mesh = m,
                                       .jobs = setup->jobs,
                                       .exact = direct->irradiance,
                                       .row_sum = solution->row_sum,
                                       .irradiance = solution->irradiance,
                                       .half_difference = solution->half_difference };
    size_t bytes = (m->element_count + 1) * sizeof(double);
    element_errors off = { block_zeroed(m->memory, bytes, 1), block_new(m->memory, bytes),
                           block_new(m->memory, bytes) };
    bool ok = off.noise && off.uneven && off.levels;
    double before = row_noise(m, solution->irradiance, solution->half_difference);
    if (ok) add_noise(m, solution->half_difference, LOST, off.noise);
    ok = ok && noise_filter(&noisy);
    const leaf_light light = { solution->irradiance, solution->row_sum, direct->irradiance,
                               direct->row_sum,      direct->uneven,    solution->half_difference };
    double after = row_noise(m, solution->irradiance, solution->half_difference);
    if (ok) add_noise(m, solution->half_difference, 1.0 - LOST, off.noise);
    out->noise = sqrt(LOST * before * before + (1.0 - LOST) * after * after);
    add_curve_point(setup, solution->unshot_fraction, out->noise * sqrt(fitted_share(m)), &baked->solution);
    ok = ok && interpolation_error_measure(m, &light, solution->crossed, setup->jobs, off.uneven, off.levels);
    if (ok) out->interpolation = interpolation_of(m, &off);
    ok = ok && find_worst(setup, &off, &baked->worst);
    block_free_all(off.noise, off.uneven, off.levels);
    if (!ok) return "out of memory";
    /* Rows whose factors do not quite add up to 1 are all off one way, as nearly white rooms show: by all that the
     * books are off, and no noise tells of it. */
    out->interpolation = hypot(out->interpolation, energy_residual(&solution->books));
    return NULL;
}
