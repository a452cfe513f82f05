/* SPDX-License-Identifier: MIT */
#include "solver/shooting.h"

#include "base/tolerance.h"
#include "scene/contact_lines.h"
#include "solver/final_gather.h"
#include "solver/full_matrix.h"
#include "solver/gather.h"
#include "solver/kept_rows.h"

#include <stdio.h>
#include <string.h>

/* What a method may do with a shooter. */
typedef struct method_policy {
    column_method columns;
    bool full_matrix; /* all columns at once, from rows */
    bool subdivides;  /* cuts shooters by the criteria of [Cohen88] */
    bool over_shoots; /* [Feda92] */
    bool closes_rows; /* row_closure.h */
    bool corrects;    /* shooter_gradient.h */
} method_policy;

static const method_policy POLICIES[] = {
    [SOLVER_HYBRID] = { .columns = COLUMN_HYBRID, .over_shoots = true, .closes_rows = true, .corrects = true },
    [SOLVER_ANALYTIC] = { .columns = COLUMN_ANALYTIC, .over_shoots = true, .closes_rows = true, .corrects = true },
    [SOLVER_PR] = { .columns = COLUMN_PIXELS, .subdivides = true },
    [SOLVER_FM] = { .columns = COLUMN_PIXELS, .full_matrix = true, .over_shoots = true },
    [SOLVER_ROWS] = { .columns = COLUMN_HYBRID },
};

/* Of all shooters; what is missing of them, as what is black, is computed for the sake of closing rows: with a third of
 * the patches black, the rest of a room at draft was up to 4 % too dark. */
static const double ENOUGH = 0.5;

/* What covers less of its outline takes nothing from anybody's row. */
static const double ALL_HOLES = 1e-3;

/* What samples have before anything is shot. */
static void set_irradiance(const shooting *s) {
    size_t size = 3 * s->mesh->sample_count * sizeof *s->out->irradiance;
    if (s->setup->arrived)
        memcpy(s->out->irradiance, s->setup->arrived, size);
    else
        memset(s->out->irradiance, 0, size);
}

/* False ends a batch of columns early: those that are missing then are not needed any more. */
static bool while_computing(void *user) {
    shooting *s = user;
    return shooting_report(s) && !s->out_of_time;
}

/* ---- closing rows ---- */

/* Has light from anywhere come to a shooter, or could it? What nobody who shot can see is in the dark. */
static bool is_reached(const shooting *s, const shooter *one) {
    uint32_t member_count;
    const uint32_t *members = mesh_members(s->mesh, &one->subpatch.patch, &member_count);
    if (shooter_unshot_power(one) != 0.0) return true;
    for (uint32_t i = 0; i < member_count; i++) {
        const patch *p = &s->mesh->patches[members[i]];
        for (uint32_t k = p->first_sample; k < p->first_sample + p->sample_count; k++)
            if (s->out->row_sum[k] > 0.0) return true;
    }
    return false;
}

/* What lies in another surface or under one need not shoot, nor what is in the dark: backs of walls, closed boxes; nor
 * what is all holes. */
static bool is_missing(const shooting *s, size_t index) {
    const shooter *one = &s->shooters->all[index];
    const patch *p = &s->mesh->patches[one->subpatch.patch];
    if (one->is_counted || p->contact != CONTACT_OPEN || p->coverage < ALL_HOLES) return false;
    return shooter_is_whole(one) && shooter_leads(s->shooters, index) && is_reached(s, one);
}

static size_t count_shooters(const shooting *s, bool (*which)(const shooting *s, size_t index)) {
    size_t count = 0;
    for (size_t i = 0; i < s->shooters->count; i++) count += which(s, i);
    return count;
}

/* Nothing that was shot has met the sky, and enough columns are there. */
static bool may_close_rows(const shooting *s) {
    const energy_books *b = &s->out->books;
    size_t missing = count_shooters(s, is_missing);
    return POLICIES[s->setup->method].closes_rows && !s->setup->open_rows && !s->store->setup.scene->panes &&
           !s->out->cancelled && !s->out_of_time && b->escaped <= TOLERANCE_CLOSED * b->emitted &&
           (double)missing <= (1.0 - ENOUGH) * (double)mesh_shooter_count(s->mesh);
}

/* *room: how many columns more may be computed; each may reach what was in the dark. */
static const char *compute_missing_once(shooting *s, size_t *room) {
    for (uint32_t i = 0; i < s->shooters->count && !s->out_of_time && *room > 0; i++) {
        const shooter *one = &s->shooters->all[i];
        /* A cluster may be dissolved; then its lead is still missing. */
        for (int tries = 0; tries < 2 && is_missing(s, i) && !s->out_of_time; tries++) {
            const char *failure = column_store_fetch(s->store, i);
            if (failure || s->out->cancelled) return failure;
            if (s->shooters->all[i].column) column_store_count(s->store, i), --*room;
        }
        if (one->column && column_store_is_full(s->store)) column_store_drop(s->store, i);
    }
    return NULL;
}

static bool is_there(const shooting *s, size_t index) {
    return s->shooters->all[index].is_counted;
}

/* A lamp that lights a corner of a dark room by what passes its edges leads from patch to patch through all of it:
 * *enough is false where what is reached on the way is more than what was there. */
static const char *compute_missing(shooting *s, bool *enough) {
    const char *failure = NULL;
    size_t room = (size_t)((1.0 - ENOUGH) / ENOUGH * (double)count_shooters(s, is_there));
    for (size_t before = room + 1; room < before && !failure && !s->out->cancelled && !s->out_of_time;)
        before = room, failure = compute_missing_once(s, &room);
    *enough = room > 0 || count_shooters(s, is_missing) == 0;
    return failure;
}

/* While light is shot again only a refusal stops it: half of it would be worse than being late. */
static bool while_shooting_again(void *user) {
    return shooting_report(user);
}

/* All that was shot is shot again through rows that are closed: what is then unshot is the residual of the new
 * equations, a percent or so, and is shot as ever. */
static const char *close_rows(shooting *s) {
    bool enough;
    const char *failure = compute_missing(s, &enough);
    if (failure || s->out->cancelled || s->out_of_time || !enough) return failure;
    if (!column_store_close_rows(s->store)) return "out of memory";
    s->store->wait = while_shooting_again;
    s->out->rows_closed = true;
    set_irradiance(s);
    shooters_reset(s->shooters, s->setup->arrived);
    shooting_emit(s);
    for (uint32_t i = 0; i < s->shooters->count; i++) {
        shooter *one = &s->shooters->all[i];
        double B[3] = { one->shot_in_all[0], one->shot_in_all[1], one->shot_in_all[2] };
        if (one->shots == 0) continue;
        failure = column_store_fetch(s->store, i);
        if (failure || s->out->cancelled || !s->shooters->all[i].column) return failure;
        for (int k = 0; k < 3; k++) s->shooters->all[i].shot_in_all[k] = 0.0;
        shooting_distribute(s, i, B);
        shooting_make_room(s, i);
    }
    s->store->wait = while_computing;
    failure = shooting_run(s);
    return failure || s->out->cancelled ? failure : shooting_shoot_dim(s);
}

/* ---- uneven shooters ---- */

/* The methods that others are compared with stay as they are, and whoever is out of time gets what there is. */
static bool may_correct(const shooting *s) {
    const progressive_setup *setup = s->setup;
    bool late = setup->time_limit_s > 0.0 && setup->clock() - setup->start_s > setup->time_limit_s;
    return POLICIES[setup->method].corrects && !setup->even_shooters && !late && !(setup->stop && *setup->stop);
}

/* Ended on the way it is as good as not begun. */
static const char *correct(shooting *s) {
    progressive_result *r = s->out;
    bool ok = shooter_gradient_create(s->store->setup.scene, s->mesh, r->irradiance, r->row_sum, r->crossed, NULL,
                                      &r->gradient) &&
              shooter_gradient_correct(&r->gradient, s->store, r->row_sum, r->crossed, r->irradiance);
    r->corrected = ok && !s->out_of_time && !r->cancelled;
    return ok ? NULL : "out of memory";
}

static bool allocate(shooting *s) {
    const mesh *m = s->mesh;
    const method_policy *policy = &POLICIES[s->setup->method];
    progressive_result *r = s->out;
    allocator *memory = jobs_memory(s->setup->jobs);
    r->irradiance = block_zeroed(memory, 3 * m->sample_count + 1, sizeof *r->irradiance);
    r->row_sum = block_zeroed(memory, m->sample_count + 1, sizeof *r->row_sum);
    r->crossed = block_zeroed(memory, m->patch_count + 1, sizeof *r->crossed);
    s->radiosity = block_new(memory, (3 * mesh_most_samples(m) + 1) * sizeof *s->radiosity);
    if (s->setup->observe) s->observed = block_new(memory, (3 * m->sample_count + 1) * sizeof *s->observed);
    *s->store = (column_store){ .setup = s->setup->columns,
                                .jobs = s->setup->jobs,
                                .shooters = s->shooters,
                                .memory_limit = policy->full_matrix ? UINT64_MAX : s->setup->memory_limit,
                                .clock = s->setup->clock,
                                .wait = while_computing,
                                .wait_user = s,
                                .row_sum = r->row_sum,
                                .row_sum_emitters =
                                    block_zeroed(memory, m->sample_count + 1, sizeof *s->store->row_sum_emitters),
                                .delivered = r->irradiance,
                                .crossed = r->crossed,
                                .lit_only = policy->subdivides };
    s->store->setup.method = policy->columns;
    return column_store_open(s->store) && s->store->row_sum_emitters && r->irradiance && r->row_sum && r->crossed &&
           s->radiosity && (!s->setup->observe || s->observed) &&
           shooters_create(s->store->setup.scene, m, s->setup->arrived, s->shooters);
}

static const char *take_full_matrix(shooting *s, char *message, size_t message_size) {
    const full_matrix_setup matrix = { .columns = &s->store->setup,
                                       .patches = s->setup->patches,
                                       .jobs = s->setup->jobs,
                                       .wait = while_computing,
                                       .wait_user = s };
    size_t n = s->mesh->patch_count;
    column **columns = block_zeroed(jobs_memory(s->setup->jobs), n + 1, sizeof *columns);
    double before = s->setup->clock();
    const char *failure = columns ? full_matrix_compute(&matrix, columns, message, message_size) : "out of memory";
    for (size_t p = 0; columns && p < n; p++)
        if (!column_store_put(s->store, (uint32_t)p, columns[p])) failure = "out of memory";
    s->store->seconds += s->setup->clock() - before;
    block_free(columns);
    return failure;
}

static bool list_shooters(shooting *s) {
    progressive_result *r = s->out;
    r->shooters = block_zeroed(jobs_memory(s->setup->jobs), s->shooters->count + 1, sizeof *r->shooters);
    if (!r->shooters) return false;
    for (size_t i = 0; i < s->shooters->count; i++) {
        const shooter *one = &s->shooters->all[i];
        if (!one->is_counted || !shooter_is_whole(one)) continue;
        r->shooters[r->shooter_count++] = (progressive_shooter){ .patch = one->subpatch.patch,
                                                                 .path = one->subpatch.path,
                                                                 .shots = one->shots,
                                                                 .hemicubes = one->choices.hemicubes,
                                                                 .analytic = one->choices.analytic,
                                                                 .evaluations = one->choices.evaluations,
                                                                 .split = one->choices.split };
    }
    return true;
}

static void take_statistics(shooting *s) {
    const column_statistics *t = &s->store->statistics;
    progressive_result *r = s->out;
    r->hemicubes = t->hemicubes;
    r->analytic = t->analytic;
    r->evaluations = t->evaluations;
    r->split_count = t->split + (uint32_t)(s->shooters->count - s->mesh->patch_count) / 4;
    r->clipped_count = t->clipped;
    r->column_count = t->columns;
    r->column_bytes = s->store->bytes;
    r->closure_min = t->closure_min;
    r->closure_max = t->closure_max;
    r->closure_mean = t->columns ? t->closure_sum / t->columns : 0.0;
    r->factors_s = s->store->seconds;
}

uint64_t progressive_memory(const progressive_setup *setup) {
    return POLICIES[setup->method].full_matrix ? full_matrix_bytes(setup->columns.mesh) : 0;
}

const char *progressive_solve(const progressive_setup *setup, progressive_result *out, char *message,
                              size_t message_size) {
    const method_policy *policy = &POLICIES[setup->method];
    shooting s = { .setup = setup,
                   .out = out,
                   .mesh = setup->columns.mesh,
                   .shooters = &out->kept,
                   .store = &out->store,
                   .subdivides = policy->subdivides,
                   .over_shoots = policy->over_shoots && !setup->plain_order };
    double begin = setup->clock();
    const char *failure = "out of memory";
    memset(out, 0, sizeof *out);
    if (allocate(&s)) {
        set_irradiance(&s);
        shooting_emit(&s);
        failure = policy->full_matrix ? take_full_matrix(&s, message, message_size) : NULL;
        if (!failure) failure = shooting_run(&s);
        if (!failure && may_close_rows(&s)) failure = close_rows(&s);
    }
    if (!failure && !out->cancelled) {
        failure = gather_all(s.shooters, setup->jobs, out->irradiance) ? NULL : "out of memory";
        if (!failure && may_correct(&s)) failure = correct(&s);
    }
    if (!failure && !list_shooters(&s)) failure = "out of memory";
    take_statistics(&s);
    out->solve_s = setup->clock() - begin - out->factors_s;
    if (failure && failure != message) snprintf(message, message_size, "%s", failure);
    column_store_rest(s.store);
    s.store->wait = NULL;
    block_free_all(s.store->row_sum_emitters, s.radiosity, s.observed);
    return failure ? message : NULL;
}

void progressive_forget_shooters(progressive_result *r) {
    column_store_close(&r->store);
    shooters_free(&r->kept);
    shooter_gradient_free(&r->gradient);
    final_gather_free(r->final_gather);
    kept_rows_free(r->kept_rows);
    r->final_gather = NULL, r->kept_rows = NULL;
}

void progressive_forget_samples(progressive_result *r) {
    block_free_all(r->irradiance, r->row_sum, r->half_difference);
    r->irradiance = r->row_sum = r->half_difference = NULL;
}

void progressive_result_free(progressive_result *r) {
    progressive_forget_shooters(r);
    progressive_forget_samples(r);
    block_free_all(r->crossed, r->curve, r->shooters);
    memset(r, 0, sizeof *r);
}
