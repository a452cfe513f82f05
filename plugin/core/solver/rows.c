/* SPDX-License-Identifier: MIT */
#include "solver/rows.h"

#include "base/arena.h"
#include "geometry/vec3.h"
#include "solver/row_allocation.h"
#include "solver/row_emitters.h"
#include "solver/row_gather.h"
#include "solver/row_iteration.h"
#include "solver/row_kept.h"

#include <math.h>
#include <string.h>

static const row_tolerance CONVERGED_PILOT = { 1e-2, INFINITY }; /* of light that only guides rays */
/* So many elements are one job; rays of a sample where there is neither time nor memory for more. */
enum { ELEMENTS_A_JOB = ROW_KEPT_ELEMENTS, LEAST_RAYS = 2 };
/* Initial rays are no more than so many times as many as adaptive ones, but for a few and these of each sample. By 1.5
 * and 4 rooms at medium took a quarter more time for a tenth of the error; by 0.375 windows of 7 cm are lost. */
static const double INITIAL_TO_ADAPTIVE = 0.75, INITIAL_FEW = 3e5;
enum { INITIAL_RAYS_MIN = 2 };

/* Where noise is to be no more than so much, this share of the adaptive rays is cast first; more are cast where they
 * are to be so many times as many, since the first are then cast anew. */
static const double FIRST_SHARE = 0.25, WORTH_CASTING = 1.5;
static const char NO_MEMORY[] = "out of memory";
/* Of the time, about, for whoever watches: the rest is that of the last iterations. */
static const double SHARE_OF_CASTING = 0.9;
static const double BYTES_OF_A_RAY = 8.0; /* what it hit, and its weight */

typedef struct rows {
    const rows_setup *setup;
    rows_result *out;
    deadline latest, least; /* least: of the least rays of all samples */
    double begin_s;         /* of the initial rays */
    row_rays rays;
    row_guiding guiding;
    row_sharing sharing;
    kept_pass pass;               /* of the rays that are being cast */
    double *direct;               /* direct[3*s+c]: what lights and emitters give */
    bool initial_are_cast, *done; /* done[e]: all rays of element e that there are room for are cast */
    bool all_are_cast;
    row_iteration light;      /* B[3*e+c]: what element e reflects */
    const double *B;          /* of the iteration under way ... */
    double *next;             /* ... and what it gives */
    double *luminance;        /* luminance[e]: of what it reflects, to find targets */
    double adaptive, planned; /* rays, of all samples: of those, and of all that may be cast */
    atomic_size_t cast;       /* rays so far */
    rows_progress so_far;
    bool failed; /* what others have did not come */
} rows;

static size_t job_count(const rows *r) {
    return (r->setup->mesh->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
}

static size_t job_end(const rows *r, size_t job) {
    size_t end = (job + 1) * ELEMENTS_A_JOB;
    return end < r->setup->mesh->element_count ? end : r->setup->mesh->element_count;
}

/* ---- casting ---- */

static void cast_job(void *user, size_t job, unsigned worker) {
    rows *r = user;
    uint16_t first[ELEMENTS_A_JOB];
    size_t begin = job * ELEMENTS_A_JOB, end = job_end(r, job);
    const row_kept_job kept = { &r->rays, &r->pass, begin, end, r->setup->mesh->element_count, first };
    (void)worker;
    for (size_t e = begin; e < end; e++) first[e - begin] = r->initial_are_cast ? r->rays.counts[e].initial : 0;
    bool is_kept = row_kept_take(&kept);
    size_t count = 0;
    for (size_t e = begin; e < end; e++) {
        bool casts = !is_kept && row_sharing_is_own(&r->sharing, e);
        if (casts) row_rays_cast(&r->rays, (uint32_t)e, first[e - begin], r->guiding.groups ? &r->guiding : NULL);
        r->done[e] = true;
        count +=
            (size_t)element_corner_count(&r->setup->mesh->elements[e]) * (row_count(&r->rays, e) - first[e - begin]);
    }
    atomic_fetch_add_explicit(&r->cast, count, memory_order_relaxed);
    if (!is_kept) row_kept_give(&kept);
}

/* Elements that no worker has come to when all is to end do with the initial rays, or with the least there is. */
static void end_job(void *user, size_t job, unsigned worker) {
    rows *r = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(r, job); e++) {
        if (r->done[e]) continue;
        row_rays_truncate(&r->rays, (uint32_t)e, r->initial_are_cast ? r->rays.counts[e].initial : LEAST_RAYS);
        row_rays_cast(&r->rays, (uint32_t)e, r->initial_are_cast ? r->rays.counts[e].initial : 0, NULL);
    }
}

static bool report(rows *r) {
    double share = fmin((double)atomic_load_explicit(&r->cast, memory_order_relaxed) / r->planned, 1.0);
    r->so_far.fraction = r->all_are_cast ? SHARE_OF_CASTING : SHARE_OF_CASTING * share;
    r->so_far.residual = r->light.residual;
    if (r->setup->progress && !r->setup->progress(r->setup->progress_user, &r->so_far)) r->out->cancelled = true;
    return !r->out->cancelled;
}

static bool may_go_on(rows *r) {
    if ((r->setup->stop && *r->setup->stop) || deadline_is_over(&r->latest)) r->out->cut = true;
    return !r->out->cut && !r->out->cancelled;
}

static bool may_go_on_gathering(void *user) {
    return may_go_on(user);
}

/* Of the initial rays the least are cast of each sample: those are ended in time for that. */
static bool wait(void *user) {
    rows *r = user;
    const double all = r->planned - r->adaptive, least = LEAST_RAYS * (double)r->setup->mesh->sample_count / all;
    const double done = (double)atomic_load_explicit(&r->cast, memory_order_relaxed) / all,
                 still = least * (1.0 - done);
    r->out->cut |= !r->initial_are_cast && deadline_is_near(&r->least, r->begin_s, done, still);
    return report(r) && may_go_on(r);
}

static void cast_all(rows *r) {
    r->pass = jobs_begin_pass(r->setup->jobs);
    memset(r->done, 0, r->setup->mesh->element_count);
    r->begin_s = deadline_begin(&r->latest);
    if (!jobs_run(r->setup->jobs, job_count(r), cast_job, wait, r) && !r->out->cancelled)
        jobs_run(r->setup->jobs, job_count(r), end_job, NULL, r);
    r->initial_are_cast = true;
}

/* ---- iterating ---- */

static void iterate_job(void *user, size_t job, unsigned worker) {
    rows *r = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(r, job); e++)
        if (row_sharing_is_own(&r->sharing, e))
            row_gather_element(&r->rays, r->B, e, r->direct, r->out->irradiance, r->next + 3 * e);
}

static void reflect_job(void *user, size_t job, unsigned worker) {
    rows *r = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(r, job); e++)
        if (row_sharing_is_own(&r->sharing, e))
            row_panes_reflect(&r->rays.panes, e, r->out->irradiance, r->next + 3 * e);
}

static void give_irradiance(rows *r) {
    if (!row_sharing_give_samples(&r->sharing, r->out->irradiance, 3 * sizeof(double))) r->failed = true;
}

/* One iteration. */
static void gather_all(void *user, const double *B, double *next) {
    rows *r = user;
    r->B = B, r->next = next;
    jobs_run(r->setup->jobs, job_count(r), iterate_job, NULL, r);
    if (r->rays.panes.other_side) {
        give_irradiance(r);
        jobs_run(r->setup->jobs, job_count(r), reflect_job, NULL, r);
    }
    if (!row_sharing_give_elements(&r->sharing, next, 3 * sizeof *next)) r->failed = true;
}

static bool report_iteration(void *user) {
    rows *r = user;
    return report(r) && !r->failed;
}

/* ---- what it says of itself ---- */

/* False when out of memory, or others are lost. */
static bool sum_up(rows *r) {
    const mesh *m = r->setup->mesh;
    rows_result *out = r->out;
    give_irradiance(r);
    if (!r->failed) out->emitter_noise = row_noise(m, out->irradiance, out->half_difference);
    bool ok = !r->failed && row_sharing_give_samples(&r->sharing, out->row_sum, sizeof *out->row_sum) &&
              row_gather_books(&r->rays, out->irradiance, r->light.B, r->setup->jobs, &out->sky_w, &out->absorbed_w,
                               &out->escaped_w) &&
              row_gather_halves(&r->rays, r->light.B, r->setup->jobs, out->half_difference);
    if (ok) out->noise = row_noise(m, out->irradiance, out->half_difference);
    out->ray_noise = sqrt(fmax(out->noise * out->noise - out->emitter_noise * out->emitter_noise, 0.0));
    return ok;
}

/* ---- all of it ---- */

/* Where samples are very many, the initial rays of each are fewer, so that adaptive ones are as many. And how many rays
 * fit into the memory: while rows are extended, both the initial rays and all are kept. */
static uint16_t fit_memory(rows *r) {
    double samples = (double)r->setup->mesh->sample_count + 1.0, initial = r->setup->initial_rays;
    double room = r->setup->memory_limit > 0 ? (double)r->setup->memory_limit / BYTES_OF_A_RAY : INFINITY;
    while (initial > INITIAL_RAYS_MIN && r->setup->adaptive_rays > 0.0 &&
           initial * samples > fmax(INITIAL_TO_ADAPTIVE * r->setup->adaptive_rays, INITIAL_FEW))
        initial /= 2;
    const double asked = initial * samples + r->setup->adaptive_rays;
    while (initial > LEAST_RAYS && 2.0 * initial * samples > room) initial /= 2;
    r->adaptive = fmin(r->setup->adaptive_rays, fmax(room - 2.0 * initial * samples, 0.0));
    r->planned = initial * samples + r->adaptive;
    r->out->ray_share = r->planned / asked;
    return (uint16_t)initial;
}

static bool allocate(rows *r) {
    const mesh *m = r->setup->mesh;
    allocator *memory = jobs_memory(r->setup->jobs);
    r->light = (row_iteration){ .memory = memory,
                                .jobs = r->setup->jobs,
                                .elements = m->elements,
                                .element_count = m->element_count,
                                .gather = gather_all,
                                .go_on = report_iteration,
                                .user = r };
    r->luminance = block_new(memory, (m->element_count + 1) * sizeof *r->luminance);
    r->done = block_new(memory, m->element_count + 1);
    r->direct = block_new(memory, (3 * m->sample_count + 1) * sizeof *r->direct);
    r->out->half_difference = block_zeroed(memory, 3 * m->sample_count + 1, sizeof *r->out->half_difference);
    if (r->direct) memcpy(r->direct, r->setup->direct, 3 * m->sample_count * sizeof *r->direct);
    r->out->irradiance = block_zeroed(memory, 3 * m->sample_count + 1, sizeof *r->out->irradiance);
    r->out->row_sum = block_zeroed(memory, m->sample_count + 1, sizeof *r->out->row_sum);
    r->rays = (row_rays){ .scene = r->setup->scene,
                          .mesh = m,
                          .lights = r->setup->lights,
                          .seed = r->setup->seed,
                          .sharing = &r->sharing,
                          .row_sum = r->out->row_sum,
                          .sky = block_zeroed(memory, 6 * m->sample_count + 1, sizeof *r->rays.sky) };
    return row_iteration_open(&r->light) && r->luminance && r->out->irradiance && r->out->row_sum && r->rays.sky &&
           r->done && r->direct && r->out->half_difference &&
           row_guiding_share(&r->rays, jobs_ranks(r->setup->jobs), &r->sharing) &&
           row_panes_create(r->setup->scene, m, m, &r->rays.panes) && row_rays_create(&r->rays, fit_memory(r));
}

/* Iterates so far that the light says where targets are. False when out of memory. */
static bool update_guiding(rows *r) {
    const mesh *m = r->setup->mesh;
    row_guiding next;
    row_iteration_settle(&r->light, CONVERGED_PILOT);
    const double *B = r->light.B;
    for (size_t e = 0; e < m->element_count; e++) r->luminance[e] = B[3 * e] + B[3 * e + 1] + B[3 * e + 2];
    if (!row_guiding_create(&r->rays, r->guiding.groups ? &r->guiding : NULL, r->setup->jobs, r->luminance, &next))
        return false;
    row_guiding_free(&r->guiding);
    r->guiding = next;
    return true;
}

/* Takes counts. False when out of memory. */
static bool extend(rows *r, row_counts *counts) {
    if (row_rays_extend(&r->rays, counts)) return cast_all(r), true;
    block_free(counts);
    return false;
}

/* So many adaptive rays, of all samples. False when out of memory. */
static bool cast_share(rows *r, double total) {
    row_counts *counts = block_new(r->setup->mesh->memory, (r->setup->mesh->element_count + 1) * sizeof *counts);
    if (!counts) return false;
    if (row_allocation_share(&r->rays, &r->guiding, total, counts)) return extend(r, counts);
    block_free(counts);
    return false;
}

/* What rays that are cast leave of noise once light has settled; that of emitters is none of theirs. False when out of
 * memory, or others are lost. */
static bool measure_noise(rows *r, double *noise) {
    const mesh *m = r->setup->mesh;
    double *halves = block_zeroed(m->memory, 3 * m->sample_count + 1, sizeof *halves);
    if (!halves) return false;
    give_irradiance(r);
    bool ok = !r->failed && row_gather_halves(&r->rays, r->light.B, r->setup->jobs, halves);
    if (ok) *noise = row_noise(m, r->out->irradiance, halves);
    if (ok) r->so_far.noise = hypot(*noise, row_noise(m, r->out->irradiance, r->out->half_difference)), report(r);
    block_free(halves);
    return ok;
}

/* For whoever watches. Processes that share rows would have to bring samples to each other for it. */
static bool say_noise(rows *r) {
    double noise;
    return !r->setup->progress || jobs_ranks(r->setup->jobs) || measure_noise(r, &noise);
}

/* A share first, where few may do; then as many as its noise asks for, if there is time. False when out of memory. */
static bool cast_enough(rows *r) {
    double target = r->setup->noise_target, first = FIRST_SHARE * r->adaptive, noise, begin_s;
    if (!(target > 0.0)) return cast_share(r, r->adaptive);
    begin_s = deadline_begin(&r->latest);
    if (!cast_share(r, first)) return false;
    if (!may_go_on(r)) return true;
    row_iteration_settle(&r->light, CONVERGED_PILOT);
    if (!measure_noise(r, &noise)) return false;
    double needed = fmin(first * (noise / target) * (noise / target), r->adaptive);
    if (needed < WORTH_CASTING * first || !may_go_on(r) || deadline_is_near(&r->latest, begin_s, first, needed))
        return true;
    return update_guiding(r) && cast_share(r, needed);
}

/* False when out of memory. */
static bool cast_adaptive(rows *r) {
    size_t bytes = (r->setup->mesh->element_count + 1) * sizeof(row_counts);
    row_counts *pilot = block_new(r->setup->mesh->memory, bytes);
    if (!pilot || !update_guiding(r) || !say_noise(r)) return block_free(pilot), false;
    if (!row_allocation_pilot(&r->rays, &r->guiding, pilot))
        block_free(pilot);
    else if (!extend(r, pilot) || (may_go_on(r) && !update_guiding(r)))
        return false;
    return !may_go_on(r) || cast_enough(r);
}

/* False when out of memory. */
static bool gather_emitters(rows *r) {
    const rows_setup *in = r->setup;
    const row_emitters_setup setup = { .scene = in->scene,
                                       .mesh = in->mesh,
                                       .rays = r->rays.rays,
                                       .lights = in->lights,
                                       .jobs = in->jobs,
                                       .seed = in->seed,
                                       .ray_count = in->emitter_rays,
                                       .wait = wait,
                                       .wait_user = r,
                                       .latest = &r->least,
                                       .rays_after = LEAST_RAYS,
                                       .is_late = &r->out->cut,
                                       .irradiance = r->direct,
                                       .half_difference = r->out->half_difference,
                                       .lights_w = &r->out->lights_w };
    if (in->emitter_rays > 0 && !row_emitters_gather(&setup)) return false;
    r->out->emitters_w += row_gather_added(in->mesh, r->direct, in->direct) - r->out->lights_w;
    return true;
}

static bool solve(rows *r) {
    if (!gather_emitters(r)) return false;
    if (r->out->cancelled) return true;
    cast_all(r);
    if (may_go_on(r) && r->adaptive > 0.0 && !cast_adaptive(r)) return false;
    if (r->out->cancelled) return true;
    r->all_are_cast = true;
    if (r->setup->bounces != 0)
        row_iteration_bounces(&r->light, r->setup->bounces < 0 ? 0 : r->setup->bounces, may_go_on_gathering);
    else
        row_iteration_settle(&r->light, may_go_on(r) ? ROW_ITERATION_CONVERGED : CONVERGED_PILOT);
    r->out->iterations = r->light.count, r->out->residual_w = r->light.residual_w;
    return sum_up(r);
}

/* What parts of elements can receive from. NULL when out of memory. */
static final_gather *keep(rows *r, final_gather *with) {
    const rows_setup *in = r->setup;
    with->scene = in->scene, with->mesh = in->mesh, with->lights = in->lights, with->jobs = in->jobs;
    with->seed = in->seed, with->emitter_rays = in->emitter_rays;
    if (in->keeps_rows && !final_gather_own_elements(with)) return NULL;
    with->guiding = r->guiding, with->counts = r->rays.counts, with->B = r->light.B;
    memset(&r->guiding, 0, sizeof r->guiding);
    r->rays.counts = NULL, r->light.B = NULL;
    return with;
}

/* NULL, or why it failed. The rays point at the items, which are where they stay. */
static const char *solve_with(rows *r, final_gather *with, char *message, size_t message_size) {
    const rows_setup *in = r->setup;
    if (!allocate(r) || !mesh_items_create(in->scene, in->mesh, MESH_ELEMENTS, &with->memory, &with->items))
        return NO_MEMORY;
    r->rays.rays = with->rays = rays_create(in->scene, &with->items, message, message_size);
    if (!with->rays) return message;
    if (in->open_distance > 0.0) rays_reach(with->rays, in->open_distance);
    if (!solve(r)) return NO_MEMORY;
    return r->rays.panes.failed || !row_panes_combine_sides(&r->rays.panes, r->out->irradiance) ? NO_MEMORY : NULL;
}

const char *rows_solve(const rows_setup *setup, rows_result *out, char *message, size_t message_size) {
    rows r = { .setup = setup, .out = out, .so_far.noise = 1.0 };
    r.latest = (deadline){ setup->clock, setup->deadline_s }, r.least = (deadline){ setup->clock, setup->least_s };
    memset(out, 0, sizeof *out);
    final_gather *with = block_zeroed(setup->mesh->memory, 1, sizeof *with);
    if (!with) return NO_MEMORY;
    with->memory.memory = setup->mesh->memory;
    const char *failure = solve_with(&r, with, message, message_size);
    if (!failure && (setup->keeps || setup->keeps_rows) && !out->cancelled && !out->cut) {
        out->final_gather = keep(&r, with);
        if (!out->final_gather) failure = NO_MEMORY;
    }
    if (!out->final_gather) final_gather_free(with);
    row_guiding_free(&r.guiding);
    row_rays_free(&r.rays);
    row_panes_free(&r.rays.panes);
    row_iteration_free(&r.light);
    row_sharing_free(&r.sharing);
    block_free_all(r.rays.sky, r.luminance, r.done, r.direct);
    return failure;
}

void rows_result_free(rows_result *r) {
    block_free_all(r->irradiance, r->row_sum, r->half_difference);
    final_gather_free(r->final_gather);
    memset(r, 0, sizeof *r);
}
