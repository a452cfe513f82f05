/* SPDX-License-Identifier: MIT
 * See progressive.h.
 */
#include "solver/progressive.h"

#include "base/block.h"
#include "base/tolerance.h"
#include "solver/column_store.h"
#include "solver/estimate.h"
#include "solver/full_matrix.h"
#include "solver/gather.h"
#include "solver/subdivision.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a method may do with a shooter. */
typedef struct policy {
    column_method columns;
    bool full_matrix; /* all columns at once, from rows */
    bool subdivides;  /* cuts shooters by the criteria of [Cohen88] */
    bool over_shoots; /* [Feda92] */
    bool closes_rows; /* row_closure.h */
    bool corrects;    /* shooter_gradient.h */
} policy;

static const policy POLICIES[] = {
    [SOLVER_HYBRID] = { .columns = COLUMN_HYBRID, .over_shoots = true, .closes_rows = true, .corrects = true },
    [SOLVER_ANALYTIC] = { .columns = COLUMN_ANALYTIC, .over_shoots = true, .closes_rows = true, .corrects = true },
    [SOLVER_PR] = { .columns = COLUMN_PIXELS, .subdivides = true },
    [SOLVER_FM] = { .columns = COLUMN_PIXELS, .full_matrix = true, .over_shoots = true },
};

/* Shooters whose powers differ by less than this share take their turns by number, not by rounding: corners of a room
 * that are alike must not be told apart by its scale. */
static const double SAME_POWER = 1e-6;

/* Of all shooters; what is missing of them is computed for the sake of closing rows. */
static const double NEARLY_ALL = 0.9;

typedef struct progressive {
    const progressive_setup *setup;
    progressive_result *out;
    policy policy;
    column_setup columns;
    shooters shooters;
    column_store store;
    row_closure rows;
    double *radiosity;       /* of the samples of one patch */
    double *observed;        /* irradiance for setup->observe */
    double unshot_magnitude; /* |unshot|, W */
    double reflected;        /* W */
    double mean_rho;
    double factor_error_sum, factor_error_weight;
    double fraction; /* of the work, as reported; never falls */
    bool out_of_time;
} progressive;

/* ---- before and while ----------------------------------------------------------------------------------------------
 */

static size_t longest_run(const mesh *m) {
    size_t longest = 1;
    for (size_t p = 0; p < m->patch_count; p++)
        if (m->patches[p].sample_count > longest) longest = m->patches[p].sample_count;
    return longest;
}

static void emit(progressive *s) {
    double rho = 0.0, area = 0.0;
    s->out->books = (energy_books){ 0 };
    s->out->light_count = 0;
    s->reflected = 0.0;
    for (size_t p = 0; p < s->columns.mesh->patch_count; p++) {
        const patch *one = &s->columns.mesh->patches[p];
        const material *m = &one->material;
        double power[3];
        shooters_direct(&s->shooters, (uint32_t)p, s->setup->arrived, power);
        for (int k = 0; k < 3; k++) {
            power[k] *= one->area;
            s->out->books.emitted += m->M[k] * one->area;
            s->reflected += m->rho[k] * power[k];
        }
        energy_book_direct(&s->out->books, power, m->rho);
        s->out->light_count += material_emits(m);
        rho += one->area * (m->rho[0] + m->rho[1] + m->rho[2]) / 3.0;
        area += one->area;
    }
    s->mean_rho = rho / area;
    s->out->books.unshot = s->unshot_magnitude = s->out->books.emitted - s->out->books.absorbed;
}

/* What samples have before anything is shot. */
static void set_irradiance(const progressive *s) {
    size_t size = 3 * s->columns.mesh->sample_count * sizeof *s->out->irradiance;
    if (s->setup->arrived)
        memcpy(s->out->irradiance, s->setup->arrived, size);
    else
        memset(s->out->irradiance, 0, size);
}

static bool report_progress(progressive *s) {
    double t = s->setup->clock() - s->setup->start_s;
    if (s->setup->time_limit_s > 0.0 && t > s->setup->time_limit_s) s->out_of_time = true;
    if (s->setup->stop && *s->setup->stop) s->out_of_time = true;
    if (!s->setup->progress) return true;
    /* Unshot power falls about geometrically, so progress is counted in its logarithm. */
    double left = s->unshot_magnitude / s->out->books.emitted;
    double fraction = left > 0.0 ? fmin(log(left) / log(s->setup->unshot_target), 1.0) : 1.0;
    s->fraction = fmax(s->fraction, fraction);
    if (!s->setup->progress(s->setup->progress_user, s->fraction, s->out->shots, fmin(left, 1.0)))
        s->out->cancelled = true;
    return !s->out->cancelled;
}

/* False ends a batch of columns early: those that are missing then are not needed any more. */
static bool while_computing(void *user) {
    progressive *s = user;
    return report_progress(s) && !s->out_of_time;
}

static bool add_curve_point(progressive *s) {
    progressive_result *r = s->out;
    if ((r->curve_count & (r->curve_count - 1)) == 0) {
        progressive_point *grown = block_resize(jobs_memory(s->setup->jobs), r->curve,
                                                (r->curve_count ? 2 * r->curve_count : 1) * sizeof *grown);
        if (!grown) return false;
        r->curve = grown;
    }
    r->unshot_fraction = s->unshot_magnitude / r->books.emitted;
    r->unshot_error = estimate_unshot_error(s->unshot_magnitude, s->reflected, s->mean_rho);
    r->factor_error = s->factor_error_weight > 0.0 ? sqrt(s->factor_error_sum / s->factor_error_weight) : 0.0;
    progressive_point point = { .t_s = s->setup->clock() - s->setup->start_s,
                                .unshot_fraction = r->unshot_fraction,
                                .unshot_error = r->unshot_error,
                                .shots = r->shots,
                                .analytic = s->store.statistics.analytic,
                                .evaluations = s->store.statistics.evaluations };
    r->curve[r->curve_count++] = point;
    if (s->observed) {
        memcpy(s->observed, r->irradiance, 3 * s->columns.mesh->sample_count * sizeof *s->observed);
        gather_all(&s->shooters, s->setup->jobs, s->observed);
        s->setup->observe(s->setup->observe_user, &point, s->observed);
    }
    return true;
}

/* ---- the three steps of a shot -------------------------------------------------------------------------------------
 */

/* The shooter with the most unshot power; sums all on the way. */
static uint32_t find_shooter(progressive *s) {
    uint32_t best = 0;
    double most = 0.0, sum = 0.0;
    for (size_t i = 0; i < s->shooters.count; i++) {
        double power = shooter_unshot_power(&s->shooters.all[i]);
        sum += power;
        if (power > most * (1.0 + SAME_POWER)) most = power, best = (uint32_t)i;
    }
    s->unshot_magnitude = sum;
    return best;
}

/* Cuts a shooter before its first shot if it is too large for its light. 1: it was cut; 0: not; -1: out of memory. */
static int subdivide(progressive *s, uint32_t index) {
    shooter *one = &s->shooters.all[index];
    if (!s->policy.subdivides || one->shots > 0 || !subdivision_is_possible(&s->shooters, index)) return 0;
    const patch *p = &s->columns.mesh->patches[one->piece.patch];
    const material *m = shooter_material(&s->shooters, index);
    gather_patch(&s->shooters, one->piece.patch, s->out->irradiance, s->radiosity);
    for (size_t k = 0; k < 3 * (size_t)p->sample_count; k++)
        s->radiosity[k] = m->M[k % 3] + m->rho[k % 3] * s->radiosity[k];
    bool too_large = subdivision_by_gradient(&s->shooters, index, s->radiosity) ||
                     (one->column && subdivision_by_factor(one->column));
    if (!too_large) return 0;
    if (one->column) column_store_drop(&s->store, index);
    return shooters_split(&s->shooters, index, s->radiosity) ? 1 : -1;
}

/* What the shooter will get back of the light that the others have unshot now: rho sum_j F_ij unshot_j, W/m2. */
static void overshoot(const progressive *s, uint32_t index, double over[3]) {
    const shooter *from = &s->shooters.all[index];
    const double *rho = shooter_material(&s->shooters, index)->rho;
    for (int k = 0; k < 3; k++) over[k] = 0.0;
    for (size_t i = 0; i < from->column->run_count; i++) {
        const column_run *run = &from->column->runs[i];
        double unshot[3], F = run->factor * s->columns.mesh->patches[run->patch].area / from->piece.area;
        shooters_patch_unshot(&s->shooters, run->patch, unshot);
        for (int k = 0; k < 3; k++) over[k] += rho[k] * F * unshot[k];
    }
    /* Who owes light pays first. */
    for (int k = 0; k < 3; k++)
        if (from->unshot[k] <= 0.0) over[k] = 0.0;
}

/* Every patch gains rho F B; what it does not reflect is absorbed. */
static void distribute(progressive *s, uint32_t index, const double B[3]) {
    shooter *from = &s->shooters.all[index];
    const column *c = from->column;
    double power[3], absorbed[3] = { 0, 0, 0 }, received = 0.0, area = from->piece.area;
    for (int k = 0; k < 3; k++) {
        power[k] = B[k] * area;
        from->unshot[k] -= B[k];
        from->shot[k] += B[k];
        from->shot_in_all[k] += B[k];
        s->out->books.unshot -= power[k];
    }
    for (size_t i = 0; i < c->run_count; i++) {
        const column_run *run = &c->runs[i];
        const material *m = shooter_material(&s->shooters, run->patch);
        double gain[3], share = s->columns.mesh->patches[run->patch].area * run->factor / area;
        received += share;
        shooters_receive(&s->shooters, c, run, B, gain);
        for (int k = 0; k < 3; k++) {
            s->out->books.unshot += gain[k];
            s->reflected += gain[k];
            absorbed[k] += (1.0 - m->rho[k]) * share;
        }
    }
    energy_book_shot(&s->out->books, c, power, absorbed, received);
    if (c->closure.front > 0.0) {
        double off = c->total / c->closure.front - 1.0, weight = fabs(power[0]) + fabs(power[1]) + fabs(power[2]);
        s->factor_error_sum += weight * off * off;
        s->factor_error_weight += weight;
    }
    from->shots++;
    s->out->shots++;
}

static void shoot(progressive *s, uint32_t index) {
    const shooter *from = &s->shooters.all[index];
    double B[3], over[3] = { 0, 0, 0 };
    if (s->policy.over_shoots && !s->setup->plain_order) overshoot(s, index, over);
    for (int k = 0; k < 3; k++) B[k] = from->unshot[k] + over[k];
    distribute(s, index, B);
}

/* Past the memory limit a column delivers to the samples at once and is let go. */
static void make_room(progressive *s, uint32_t index) {
    if (!column_store_is_full(&s->store)) return;
    gather_deliver(&s->shooters, index, s->out->irradiance);
    column_store_drop(&s->store, index);
}

/* ---- the loop ------------------------------------------------------------------------------------------------------
 */

static bool is_done(progressive *s) {
    progressive_result *r = s->out;
    r->converged = s->unshot_magnitude <= s->setup->unshot_target * r->books.emitted;
    if (!r->converged && s->setup->error_target > 0.0)
        r->converged =
            estimate_unshot_error(s->unshot_magnitude, s->reflected, s->mean_rho) < 0.25 * s->setup->error_target;
    return r->converged || r->cancelled || s->out_of_time;
}

/* The column of a shooter that is about to shoot; cuts it first where it must be. *cut: look for another shooter. */
static const char *prepare(progressive *s, uint32_t index, bool *cut) {
    int before = subdivide(s, index);
    size_t count = mesh_shooter_count(s->columns.mesh);
    const char *failure = before == 0 ? column_store_fetch(&s->store, index) : NULL;
    if (failure || s->out->cancelled) return failure;
    bool dissolved = mesh_shooter_count(s->columns.mesh) > count;
    int after = before == 0 && s->shooters.all[index].column ? subdivide(s, index) : 0;
    *cut = before != 0 || after != 0 || dissolved;
    return before < 0 || after < 0 ? "out of memory" : NULL;
}

static const char *shoot_until_done(progressive *s) {
    uint32_t next_point = s->out->shots;
    for (;;) {
        uint32_t index = find_shooter(s);
        if (s->out->shots >= next_point) {
            next_point = s->out->shots + s->out->shots / 4 + 1;
            if (!add_curve_point(s)) return "out of memory";
        }
        if (is_done(s)) break;
        bool cut = false;
        const char *failure = prepare(s, index, &cut);
        if (failure || s->out->cancelled) return failure;
        if (cut) continue;
        if (!s->shooters.all[index].column) {
            report_progress(s);
            if (s->out_of_time) break;
            return "a form-factor column is missing";
        }
        shoot(s, index);
        make_room(s, index);
        if (s->out->shots % 64 == 0 && !report_progress(s)) return NULL;
    }
    return add_curve_point(s) ? NULL : "out of memory";
}

/* ---- closing rows --------------------------------------------------------------------------------------------------
 */

static bool is_missing(const progressive *s, size_t index) {
    const shooter *one = &s->shooters.all[index];
    return shooter_is_whole(one) && !one->was_computed && shooter_leads(&s->shooters, index);
}

static size_t count_missing(const progressive *s) {
    size_t missing = 0;
    for (size_t i = 0; i < s->shooters.count; i++) missing += is_missing(s, i);
    return missing;
}

/* Nothing that was shot has met the sky, and nearly all columns are there. */
static bool may_close_rows(const progressive *s) {
    const energy_books *b = &s->out->books;
    return s->policy.closes_rows && !s->setup->open_rows && !s->out->cancelled && !s->out_of_time &&
           b->escaped <= TOLERANCE_CLOSED * b->emitted &&
           (double)count_missing(s) <= (1.0 - NEARLY_ALL) * (double)mesh_shooter_count(s->columns.mesh);
}

static const char *compute_missing(progressive *s) {
    for (uint32_t i = 0; i < s->shooters.count && !s->out_of_time; i++) {
        const shooter *one = &s->shooters.all[i];
        /* A cluster may be dissolved; then its lead is still missing. */
        for (int tries = 0; tries < 2 && is_missing(s, i) && !s->out_of_time; tries++) {
            const char *failure = column_store_fetch(&s->store, i);
            if (failure || s->out->cancelled) return failure;
        }
        if (one->column && column_store_is_full(&s->store)) column_store_drop(&s->store, i);
    }
    return NULL;
}

static void close_item(void *user, size_t item, unsigned worker) {
    progressive *s = user;
    shooter *one = &s->shooters.all[item];
    (void)worker;
    if (one->column) row_closure_apply(&s->rows, &s->columns, one->piece.patch, one->column);
}

/* While light is shot again only a refusal stops it: half of it would be worse than being late. */
static bool while_shooting_again(void *user) {
    return report_progress(user);
}

/* All that was shot is shot again through rows that are closed: what is then unshot is the residual of the new
 * equations, a percent or so, and is shot as ever. */
static const char *close_rows(progressive *s) {
    const char *failure = compute_missing(s);
    if (failure || s->out->cancelled || s->out_of_time) return failure;
    if (!row_closure_find(s->columns.mesh, s->out->row_sum, s->store.row_sum_emitters, &s->rows))
        return "out of memory";
    jobs_run(s->setup->jobs, s->shooters.count, close_item, NULL, s);
    s->store.rows = &s->rows;
    s->store.wait = while_shooting_again;
    s->out->rows_closed = true;
    set_irradiance(s);
    shooters_reset(&s->shooters, s->setup->arrived);
    emit(s);
    for (uint32_t i = 0; i < s->shooters.count; i++) {
        shooter *one = &s->shooters.all[i];
        double B[3] = { one->shot_in_all[0], one->shot_in_all[1], one->shot_in_all[2] };
        if (one->shots == 0) continue;
        failure = column_store_fetch(&s->store, i);
        if (failure || s->out->cancelled || !s->shooters.all[i].column) return failure;
        for (int k = 0; k < 3; k++) s->shooters.all[i].shot_in_all[k] = 0.0;
        distribute(s, i, B);
        make_room(s, i);
    }
    s->store.wait = while_computing;
    return shoot_until_done(s);
}

/* ---- uneven shooters -----------------------------------------------------------------------------------------------
 */

/* The methods that others are compared with stay as they are, and whoever is out of time gets what there is. */
static bool may_correct(const progressive *s) {
    const progressive_setup *setup = s->setup;
    bool late = setup->time_limit_s > 0.0 && setup->clock() - setup->start_s > setup->time_limit_s;
    return s->policy.corrects && !setup->even_shooters && !late && !(setup->stop && *setup->stop);
}

static const char *correct(progressive *s) {
    progressive_result *r = s->out;
    r->corrected =
        shooter_gradient_create(s->columns.scene, s->columns.mesh, r->irradiance, r->row_sum, r->crossed,
                                &r->gradient) &&
        shooter_gradient_correct(&r->gradient, &s->columns, r->rows_closed ? &s->rows : NULL, &s->shooters,
                                 s->setup->jobs, r->irradiance);
    return r->corrected ? NULL : "out of memory";
}

/* ---- all of it -----------------------------------------------------------------------------------------------------
 */

static bool allocate(progressive *s) {
    const mesh *m = s->columns.mesh;
    progressive_result *r = s->out;
    allocator *memory = jobs_memory(s->setup->jobs);
    r->irradiance = block_zeroed(memory, 3 * m->sample_count + 1, sizeof *r->irradiance);
    r->row_sum = block_zeroed(memory, m->sample_count + 1, sizeof *r->row_sum);
    r->crossed = block_zeroed(memory, m->patch_count + 1, sizeof *r->crossed);
    s->radiosity = block_new(memory, 3 * longest_run(m) * sizeof *s->radiosity);
    if (s->setup->observe) s->observed = block_new(memory, (3 * m->sample_count + 1) * sizeof *s->observed);
    s->store = (column_store){ .setup = &s->columns,
                               .jobs = s->setup->jobs,
                               .shooters = &s->shooters,
                               .memory_limit = s->policy.full_matrix ? UINT64_MAX : s->setup->memory_limit,
                               .clock = s->setup->clock,
                               .wait = while_computing,
                               .wait_user = s,
                               .row_sum = r->row_sum,
                               .row_sum_emitters =
                                   block_zeroed(memory, m->sample_count + 1, sizeof *s->store.row_sum_emitters),
                               .delivered = r->irradiance,
                               .crossed = r->crossed,
                               .lit_only = s->policy.subdivides };
    return column_store_open(&s->store) && s->store.row_sum_emitters && r->irradiance && r->row_sum && r->crossed &&
           s->radiosity && (!s->setup->observe || s->observed) &&
           shooters_create(s->columns.scene, m, s->setup->arrived, &s->shooters);
}

static const char *take_full_matrix(progressive *s, char *message, size_t message_size) {
    const full_matrix_setup matrix = { .columns = &s->columns,
                                       .patches = s->setup->patches,
                                       .jobs = s->setup->jobs,
                                       .wait = while_computing,
                                       .wait_user = s };
    size_t n = s->columns.mesh->patch_count;
    column **columns = block_zeroed(jobs_memory(s->setup->jobs), n + 1, sizeof *columns);
    double before = s->setup->clock();
    const char *failure = columns ? full_matrix_compute(&matrix, columns, message, message_size) : "out of memory";
    for (size_t p = 0; columns && p < n; p++) column_store_put(&s->store, (uint32_t)p, columns[p]);
    s->store.seconds += s->setup->clock() - before;
    block_free(columns);
    return failure;
}

static bool list_shooters(progressive *s) {
    progressive_result *r = s->out;
    r->shooters = block_zeroed(jobs_memory(s->setup->jobs), s->shooters.count + 1, sizeof *r->shooters);
    if (!r->shooters) return false;
    for (size_t i = 0; i < s->shooters.count; i++) {
        const shooter *one = &s->shooters.all[i];
        if (!one->was_computed || !shooter_is_whole(one)) continue;
        r->shooters[r->shooter_count++] = (progressive_shooter){ .patch = one->piece.patch,
                                                                 .path = one->piece.path,
                                                                 .shots = one->shots,
                                                                 .hemicubes = one->choices.hemicubes,
                                                                 .analytic = one->choices.analytic,
                                                                 .evaluations = one->choices.evaluations,
                                                                 .split = one->choices.split };
    }
    return true;
}

static void take_statistics(progressive *s) {
    const column_statistics *t = &s->store.statistics;
    progressive_result *r = s->out;
    r->hemicubes = t->hemicubes;
    r->analytic = t->analytic;
    r->evaluations = t->evaluations;
    r->split_count = t->split + (uint32_t)(s->shooters.count - s->columns.mesh->patch_count) / 4;
    r->clipped_count = t->clipped;
    r->column_count = t->columns;
    r->column_bytes = s->store.bytes;
    r->closure_min = t->closure_min;
    r->closure_max = t->closure_max;
    r->closure_mean = t->columns ? t->closure_sum / t->columns : 0.0;
    r->factors_s = s->store.seconds;
}

static void release(progressive *s) {
    column_store_close(&s->store);
    s->out->kept = s->shooters;
    s->out->rows = s->rows;
    block_free(s->store.row_sum_emitters);
    block_free(s->radiosity);
    block_free(s->observed);
}

uint64_t progressive_memory(const progressive_setup *setup) {
    return POLICIES[setup->method].full_matrix ? full_matrix_bytes(setup->columns.mesh) : 0;
}

const char *progressive_solve(const progressive_setup *setup, progressive_result *out, char *message,
                              size_t message_size) {
    progressive s = { .setup = setup, .out = out, .policy = POLICIES[setup->method], .columns = setup->columns };
    double begin = setup->clock();
    const char *failure = "out of memory";
    memset(out, 0, sizeof *out);
    s.columns.method = s.policy.columns;
    if (allocate(&s)) {
        set_irradiance(&s);
        emit(&s);
        failure = s.policy.full_matrix ? take_full_matrix(&s, message, message_size) : NULL;
        if (!failure) failure = shoot_until_done(&s);
        if (!failure && may_close_rows(&s)) failure = close_rows(&s);
    }
    if (!failure && !out->cancelled) {
        gather_all(&s.shooters, setup->jobs, out->irradiance);
        if (may_correct(&s)) failure = correct(&s);
    }
    if (!failure && !list_shooters(&s)) failure = "out of memory";
    take_statistics(&s);
    out->solve_s = setup->clock() - begin - out->factors_s;
    /* Before the workers go, which hold it. */
    if (failure && failure != message) snprintf(message, message_size, "%s", failure);
    release(&s);
    return failure ? message : NULL;
}

void progressive_forget_shooters(progressive_result *r) {
    shooters_free(&r->kept);
    row_closure_free(&r->rows);
    shooter_gradient_free(&r->gradient);
    memset(&r->kept, 0, sizeof r->kept);
}

void progressive_forget_samples(progressive_result *r) {
    block_free(r->irradiance);
    block_free(r->row_sum);
    r->irradiance = r->row_sum = NULL;
}

void progressive_result_free(progressive_result *r) {
    progressive_forget_shooters(r);
    progressive_forget_samples(r);
    block_free(r->crossed);
    block_free(r->curve);
    block_free(r->shooters);
    memset(r, 0, sizeof *r);
}
