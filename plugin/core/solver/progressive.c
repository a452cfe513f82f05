/* SPDX-License-Identifier: MIT
 * See progressive.h.
 *
 * Same bits for any number of threads: which columns are computed together depends on the state of the solution alone,
 * each column depends on its patch alone, and every sum runs in index order.
 */
#include "solver/progressive.h"

#include "solver/estimate.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 32, GATHER_PATCHES = 16, MESSAGE_SIZE = 128 };

typedef struct candidate {
    uint32_t patch;
    double unshot, potential; /* W, m2 */
} candidate;

typedef struct progressive {
    const progressive_setup *setup;
    const mesh *mesh;
    progressive_result *out;
    column_worker **workers;
    char (*worker_message)[MESSAGE_SIZE];
    column **columns;
    double *unshot; /* unshot[3*p+c], W/m2 */
    double *shot;   /* shot[3*p+c]: all that patch p has shot and that its kept column must still deliver */
    bool *was_shot;
    bool *has_reached; /* patch p's column has been added to reach: once, however often it is made anew */
    double *area_rho;  /* A_p times the largest rho of the bands: what a patch can be asked to shoot again */
    double reflected;  /* W */
    double closure_sum, factor_error_sum, factor_error_weight;
    uint32_t batch[BATCH];
    candidate *candidates;
    bool out_of_time;
} progressive;

static const material *material_of(const progressive *s, size_t patch_index) {
    const scene *all = s->setup->columns.scene;
    return &all->materials[all->surfaces[s->mesh->patches[patch_index].surface].material];
}

static double unshot_power(const progressive *s, size_t p) {
    return (s->unshot[3 * p] + s->unshot[3 * p + 1] + s->unshot[3 * p + 2]) * s->mesh->patches[p].area;
}

static bool allocate(progressive *s) {
    size_t n = s->mesh->patch_count, samples = s->mesh->sample_count;
    unsigned workers = jobs_worker_count(s->setup->jobs);
    s->workers = calloc(workers, sizeof *s->workers);
    s->worker_message = calloc(workers, sizeof *s->worker_message);
    s->columns = calloc(n, sizeof *s->columns);
    s->unshot = calloc(3 * n, sizeof *s->unshot);
    s->shot = calloc(3 * n, sizeof *s->shot);
    s->area_rho = calloc(n, sizeof *s->area_rho);
    s->was_shot = calloc(n + 1, sizeof *s->was_shot);
    s->has_reached = calloc(n + 1, sizeof *s->has_reached);
    s->candidates = calloc(n, sizeof *s->candidates);
    s->out->irradiance = calloc(3 * samples + 1, sizeof *s->out->irradiance);
    s->out->reach = calloc(samples + 1, sizeof *s->out->reach);
    s->out->crossed = calloc(n + 1, sizeof *s->out->crossed);
    return s->out->crossed && s->workers && s->worker_message && s->columns && s->unshot && s->shot && s->area_rho &&
           s->was_shot && s->has_reached && s->candidates && s->out->irradiance && s->out->reach;
}

static void emit(progressive *s) {
    for (size_t p = 0; p < s->mesh->patch_count; p++) {
        const material *m = material_of(s, p);
        for (int c = 0; c < 3; c++) s->unshot[3 * p + c] = m->M[c];
        s->area_rho[p] = s->mesh->patches[p].area * fmax(m->rho[0], fmax(m->rho[1], m->rho[2]));
        s->out->books.emitted += unshot_power(s, p);
        s->out->light_count += unshot_power(s, p) > 0.0;
    }
    s->out->books.unshot = s->out->books.emitted;
}

/* ---- columns -------------------------------------------------------------------------------------------------------
 */

static void compute_item(void *user, size_t item, unsigned worker) {
    progressive *s = user;
    if (!s->workers[worker])
        s->workers[worker] = column_worker_create(&s->setup->columns, s->worker_message[worker], MESSAGE_SIZE);
    if (s->workers[worker]) s->columns[s->batch[item]] = column_compute(s->workers[worker], s->batch[item]);
}

/* GL contexts belong to the threads that made them, so each worker lets go of its own. */
static void destroy_worker(void *user, size_t item, unsigned worker) {
    progressive *s = user;
    (void)item;
    column_worker_destroy(s->workers[worker]);
    s->workers[worker] = NULL;
}

static bool report_progress(progressive *s) {
    double t = s->setup->clock() - s->setup->start_s;
    if (s->setup->time_limit_s > 0.0 && t > s->setup->time_limit_s) s->out_of_time = true;
    if (s->setup->finish && *s->setup->finish) s->out_of_time = true;
    if (!s->setup->progress) return true;
    /* Unshot power falls about geometrically, so progress is counted in its logarithm. */
    double left = s->out->books.unshot / s->out->books.emitted;
    double fraction = left > 0.0 ? log(left) / log(s->setup->unshot_target) : 1.0;
    fraction = fraction < 0.0 ? 0.0 : fraction > 1.0 ? 1.0 : fraction;
    if (!s->setup->progress(s->setup->progress_user, fraction, s->out->shots, left)) s->out->cancelled = true;
    return !s->out->cancelled;
}

/* False ends the batch early: the columns that are missing then are not needed any more. */
static bool while_computing(void *user) {
    progressive *s = user;
    return report_progress(s) && !s->out_of_time;
}

static int compare_candidates(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    if (x->unshot != y->unshot) return x->unshot < y->unshot ? 1 : -1;
    if (x->potential != y->potential) return x->potential < y->potential ? 1 : -1;
    return (x->patch > y->patch) - (x->patch < y->patch);
}

/* The patches without a column that will want one soonest: those with the most unshot power, then those that can
 * reflect most. */
static size_t choose_batch(progressive *s, size_t limit) {
    size_t count = 0;
    for (size_t p = 0; p < s->mesh->patch_count; p++) {
        if (s->columns[p] || (unshot_power(s, p) <= 0.0 && s->area_rho[p] <= 0.0)) continue;
        s->candidates[count++] = (candidate){ (uint32_t)p, unshot_power(s, p), s->area_rho[p] };
    }
    qsort(s->candidates, count, sizeof *s->candidates, compare_candidates);
    if (count > limit) count = limit;
    for (size_t i = 0; i < count; i++) s->batch[i] = s->candidates[i].patch;
    return count;
}

static void note_column(progressive *s, const column *c) {
    progressive_result *r = s->out;
    r->hemicubes += c->hemicubes;
    r->analytic += c->analytic;
    r->evaluations += c->evaluations;
    r->split_count += c->split;
    r->clipped_count += c->scale < 1.0;
    r->column_bytes += column_bytes(c);
    if (c->closure.front <= 0.0) return;
    double closure = c->total / c->closure.front;
    r->closure_min = r->column_count ? fmin(r->closure_min, closure) : closure;
    r->closure_max = r->column_count ? fmax(r->closure_max, closure) : closure;
    r->column_count++;
    s->closure_sum += closure;
}

/* NULL on success. */
static const char *compute_columns(progressive *s) {
    bool past_limit = s->out->column_bytes > s->setup->memory_limit;
    size_t count = choose_batch(s, past_limit ? 1 : BATCH);
    double before = s->setup->clock();
    jobs_run(s->setup->jobs, count, compute_item, while_computing, s);
    s->out->factors_s += s->setup->clock() - before;
    if (s->out->cancelled) return NULL;
    for (size_t i = 0; i < count; i++) {
        if (s->columns[s->batch[i]]) {
            note_column(s, s->columns[s->batch[i]]);
            continue;
        }
        if (s->out_of_time) continue;
        for (unsigned w = 0; w < jobs_worker_count(s->setup->jobs); w++)
            if (s->worker_message[w][0]) return s->worker_message[w];
        return "out of memory while computing form factors";
    }
    return NULL;
}

/* ---- the three steps of a shot
 * --------------------------------------------------------------------------------------- */

static uint32_t find_shooter(const progressive *s) {
    uint32_t best = 0;
    double most = -1.0;
    for (size_t p = 0; p < s->mesh->patch_count; p++) {
        double power = unshot_power(s, p);
        if (power > most) most = power, best = (uint32_t)p;
    }
    return best;
}

/* Every patch gains rho F B; what it does not reflect is absorbed. Returns nothing, books everything. */
static void distribute(progressive *s, uint32_t shooter, const column *c) {
    double B[3], power[3], absorbed[3] = { 0, 0, 0 }, received = 0.0;
    double area = s->mesh->patches[shooter].area;
    for (int k = 0; k < 3; k++) {
        B[k] = s->unshot[3 * (size_t)shooter + k];
        power[k] = B[k] * area;
        s->shot[3 * (size_t)shooter + k] += B[k];
        s->unshot[3 * (size_t)shooter + k] = 0.0;
        s->out->books.unshot -= power[k];
    }
    for (size_t i = 0; i < c->run_count; i++) {
        const column_run *run = &c->runs[i];
        const material *m = material_of(s, run->patch);
        double share = s->mesh->patches[run->patch].area * run->factor / area;
        received += share;
        for (int k = 0; k < 3; k++) {
            double gain = m->rho[k] * run->factor * B[k];
            s->unshot[3 * (size_t)run->patch + k] += gain;
            s->out->books.unshot += gain * s->mesh->patches[run->patch].area;
            s->reflected += gain * s->mesh->patches[run->patch].area;
            absorbed[k] += (1.0 - m->rho[k]) * share;
        }
    }
    energy_book_shot(&s->out->books, c, power, absorbed, received);
    if (c->closure.front > 0.0) {
        double off = c->total / c->closure.front - 1.0, weight = power[0] + power[1] + power[2];
        s->factor_error_sum += weight * off * off;
        s->factor_error_weight += weight;
    }
    s->out->shots++;
}

/* ---- samples
 * --------------------------------------------------------------------------------------------------------- */

static void deliver_run(progressive *s, const column *c, const column_run *run, const double B[3],
                        double reach_weight) {
    const patch *receiver = &s->mesh->patches[run->patch];
    double *E = s->out->irradiance + 3 * (size_t)receiver->first_sample;
    double *reach = s->out->reach + receiver->first_sample;
    for (uint32_t k = 0; k < receiver->sample_count; k++) {
        double F = c->factors[run->first + k];
        E[3 * k] += F * B[0];
        E[3 * k + 1] += F * B[1];
        E[3 * k + 2] += F * B[2];
        reach[k] += reach_weight * F;
    }
}

static size_t first_run_from(const column *c, uint32_t patch_index) {
    size_t low = 0, high = c->run_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (c->runs[middle].patch < patch_index)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Gathers a few receiving patches from all kept columns, in column order. */
static void gather_item(void *user, size_t item, unsigned worker) {
    progressive *s = user;
    uint32_t first = (uint32_t)item * GATHER_PATCHES, end = first + GATHER_PATCHES;
    (void)worker;
    for (size_t i = 0; i < s->mesh->patch_count; i++) {
        const column *c = s->columns[i];
        if (!c || !s->was_shot[i]) continue;
        for (size_t r = first_run_from(c, first); r < c->run_count && c->runs[r].patch < end; r++)
            deliver_run(s, c, &c->runs[r], s->shot + 3 * i, s->has_reached[i] ? 0.0 : 1.0);
    }
}

/* A column past the memory limit delivers at once and is let go. */
static void deliver_and_drop(progressive *s, uint32_t shooter) {
    column *c = s->columns[shooter];
    for (size_t i = 0; i < c->run_count; i++)
        deliver_run(s, c, &c->runs[i], s->shot + 3 * (size_t)shooter, s->has_reached[shooter] ? 0.0 : 1.0);
    s->has_reached[shooter] = true;
    for (int k = 0; k < 3; k++) s->shot[3 * (size_t)shooter + k] = 0.0;
    s->out->column_bytes -= column_bytes(c);
    column_destroy(c);
    s->columns[shooter] = NULL;
}

/* ---- the loop
 * -------------------------------------------------------------------------------------------------------- */

static double mean_rho(const progressive *s) {
    double sum = 0.0, area = 0.0;
    for (size_t p = 0; p < s->mesh->patch_count; p++) {
        const material *m = material_of(s, p);
        sum += s->mesh->patches[p].area * (m->rho[0] + m->rho[1] + m->rho[2]) / 3.0;
        area += s->mesh->patches[p].area;
    }
    return sum / area;
}

static bool add_curve_point(progressive *s, double rho) {
    progressive_result *r = s->out;
    if ((r->curve_count & (r->curve_count - 1)) == 0) {
        progressive_point *grown = realloc(r->curve, (r->curve_count ? 2 * r->curve_count : 1) * sizeof *grown);
        if (!grown) return false;
        r->curve = grown;
    }
    r->unshot_fraction = r->books.unshot > 0.0 ? r->books.unshot / r->books.emitted : 0.0;
    r->unshot_error = estimate_unshot_error(r->books.unshot, s->reflected, rho);
    r->factor_error = s->factor_error_weight > 0.0 ? sqrt(s->factor_error_sum / s->factor_error_weight) : 0.0;
    error_parts parts = { r->unshot_error, r->factor_error, s->setup->error_floor };
    r->curve[r->curve_count++] = (progressive_point){ .t_s = s->setup->clock() - s->setup->start_s,
                                                      .unshot_fraction = r->unshot_fraction,
                                                      .error_estimate = estimate_total(&parts),
                                                      .shots = r->shots };
    return true;
}

static bool is_done(progressive *s, double rho) {
    progressive_result *r = s->out;
    r->converged = r->books.unshot <= s->setup->unshot_target * r->books.emitted;
    if (!r->converged && s->setup->error_target > 0.0)
        r->converged = estimate_unshot_error(r->books.unshot, s->reflected, rho) < 0.25 * s->setup->error_target;
    return r->converged || r->cancelled || s->out_of_time;
}

static const char *shoot_until_done(progressive *s) {
    double rho = mean_rho(s);
    uint32_t next_point = 1;
    if (!add_curve_point(s, rho)) return "out of memory";
    while (!is_done(s, rho)) {
        uint32_t shooter = find_shooter(s);
        if (!s->columns[shooter]) {
            const char *failure = compute_columns(s);
            if (failure || s->out->cancelled) return failure;
            if (!report_progress(s)) return NULL;
            if (s->out_of_time) break;
            if (!s->columns[shooter]) return "a form-factor column is missing";
        }
        s->was_shot[shooter] = true;
        s->out->crossed[shooter] = s->columns[shooter]->crossed;
        distribute(s, shooter, s->columns[shooter]);
        if (s->out->column_bytes > s->setup->memory_limit) deliver_and_drop(s, shooter);
        if (s->out->shots >= next_point) {
            next_point = s->out->shots + s->out->shots / 4 + 1;
            if (!add_curve_point(s, rho)) return "out of memory";
        }
        if (s->out->shots % 64 == 0 && !report_progress(s)) return NULL;
    }
    return add_curve_point(s, rho) ? NULL : "out of memory";
}

static void finish(progressive *s) {
    size_t groups = (s->mesh->patch_count + GATHER_PATCHES - 1) / GATHER_PATCHES;
    if (!s->out->cancelled) jobs_run(s->setup->jobs, groups, gather_item, NULL, s);
    if (s->out->column_count) s->out->closure_mean = s->closure_sum / s->out->column_count;
    if (s->out->books.unshot < 0.0) s->out->books.unshot = 0.0;
}

static void release(progressive *s) {
    if (s->workers) jobs_run_on_each_worker(s->setup->jobs, destroy_worker, s);
    for (size_t p = 0; s->columns && p < s->mesh->patch_count; p++) column_destroy(s->columns[p]);
    free(s->workers);
    free(s->worker_message);
    free(s->columns);
    free(s->unshot);
    free(s->shot);
    free(s->area_rho);
    free(s->was_shot);
    free(s->has_reached);
    free(s->candidates);
}

const char *progressive_solve(const progressive_setup *setup, progressive_result *out, char *message,
                              size_t message_size) {
    progressive s = { .setup = setup, .mesh = setup->columns.mesh, .out = out };
    double begin = setup->clock();
    memset(out, 0, sizeof *out);
    const char *failure = "out of memory";
    if (allocate(&s)) {
        emit(&s);
        failure = shoot_until_done(&s);
    }
    if (!failure) finish(&s);
    out->solve_s = setup->clock() - begin - out->factors_s;
    if (failure) snprintf(message, message_size, "%s", failure);
    release(&s);
    return failure ? message : NULL;
}

void progressive_result_free(progressive_result *r) {
    free(r->irradiance);
    free(r->reach);
    free(r->crossed);
    free(r->curve);
    memset(r, 0, sizeof *r);
}
