/* SPDX-License-Identifier: MIT
 * How fine must a bake be to meet its goal? Where an error is asked for and neither quality nor sizes are, the
 * qualities are climbed until the estimated error is below it. Each costs some four times what the one before does, so
 * what the lower ones took counts little. Where seconds are asked for, a coarse bake says how fast the machine is, and
 * the next is as fine as what is left of them allows.
 */
#include "desc_size.h"
#include "internal.h"

#include <math.h>

/* Cost from one quality to the next, as measured on the scenes of tests/accuracy, 2.5 to 5.5. A rung is not begun when
 * so much of the last one's time is not left. */
static const double COST_OF_A_RUNG = 6.0;

/* The estimate is 0.7 to 1.4 times the error on the scenes of tests/accuracy; below this share of the goal it is met to
 * within a fifth or so. */
static const double SURE = 0.8;

/* By time alone: the first bake, in elements of draft; the finest; and by how much each is finer at most, since what
 * starting costs says nothing of elements. */
static const double FIRST_SIZE = 0.25, LAST_SIZE = 18.0, FINER_AT_MOST = 3.0;

/* Cost grows as this power of the number of elements: 1.4 to 1.9 between qualities. A bake is made for this share of
 * the time that is left, the rest is for writing; where that is less than so many times the last one's, none is begun.
 */
static const double COST_EXPONENT = 1.8, SHARE_TO_USE = 0.85, WORTH_IT = 1.3;

static bool is_free(const hemi_bake_desc *d) {
    return d->quality == HEMI_QUALITY_DEFAULT && d->element_size == 0.0 && d->patch_size == 0.0;
}

static bool is_finished(const hemi_bake_desc *d) {
    return d->stop && *d->stop;
}

/* Keeps the better of two solutions. */
static void keep_better(hemi_solution **best, hemi_solution *next) {
    hemi_solution *worse = next;
    if (!*best || next->statistics.error_estimate < (*best)->statistics.error_estimate) worse = *best, *best = next;
    hemi_solution_destroy(worse);
}

static hemi_result climb(hemi_scene *in, const hemi_bake_desc *desc, double start_s, hemi_solution **best) {
    for (int quality = HEMI_QUALITY_DRAFT; quality <= HEMI_QUALITY_REFERENCE; quality++) {
        hemi_bake_desc rung = *desc;
        hemi_solution *next = NULL;
        double begin = monotonic_seconds(), low = 0.25 * (quality - HEMI_QUALITY_DRAFT);
        rung.quality = (hemi_quality)quality;
        if (desc->time_limit_s > 0.0) rung.time_limit_s = fmax(desc->time_limit_s - (begin - start_s), 1e-3);
        hemi_result result =
            bake_once(in, &rung, &(bake_span){ .start_s = begin, .low = low, .high = low + 0.25 }, &next);
        if (result != HEMI_OK) return result;
        keep_better(best, next);
        double took = monotonic_seconds() - begin, left = desc->time_limit_s - (monotonic_seconds() - start_s);
        bool no_time = desc->time_limit_s > 0.0 && left < COST_OF_A_RUNG * took;
        if ((*best)->statistics.error_estimate <= SURE * desc->error_target || no_time || is_finished(desc)) break;
    }
    return HEMI_OK;
}

/* The finest that fits: each bake says what the next may cost. */
static hemi_result fill_time(hemi_scene *in, const hemi_bake_desc *desc, double start_s, hemi_solution **best) {
    double size = FIRST_SIZE, low = 0.0;
    for (;;) {
        hemi_bake_desc rung = *desc;
        hemi_solution *next = NULL;
        double begin = monotonic_seconds(), scale;
        rung.quality = quality_of_size(size, &scale);
        /* After the last shot elements are refined and fitted. */
        rung.time_limit_s = fmax(SHARE_TO_USE * (desc->time_limit_s - (begin - start_s)), 1e-3);
        hemi_result result = bake_once(in, &rung, &(bake_span){ begin, low, 0.5 * (1.0 + low), scale }, &next);
        if (result != HEMI_OK) return result;
        keep_better(best, next);
        low = 0.5 * (1.0 + low);
        double took = monotonic_seconds() - begin, left = desc->time_limit_s - (monotonic_seconds() - start_s);
        if (left < WORTH_IT * took || size >= LAST_SIZE || is_finished(desc)) break;
        size *= fmin(pow(SHARE_TO_USE * left / took, 1.0 / COST_EXPONENT), FINER_AT_MOST);
        size = fmin(size, LAST_SIZE);
    }
    /* Whoever watches sees the end. */
    hemi_progress done = { 1.0, "reconstruct", (*best)->statistics.shots, (*best)->statistics.unshot_fraction };
    return desc->progress && !desc->progress(desc->progress_user, &done) ? HEMI_CANCELLED : HEMI_OK;
}

static hemi_result reach_goal(hemi_scene *in, const hemi_bake_desc *desc, double start_s, hemi_solution **out) {
    if (is_free(desc) && desc->error_target > 0.0) return climb(in, desc, start_s, out);
    if (is_free(desc) && desc->time_limit_s > 0.0) return fill_time(in, desc, start_s, out);
    return bake_once(in, desc, &(bake_span){ .start_s = start_s, .high = 1.0 }, out);
}

hemi_result hemi_bake(hemi_scene *in, const hemi_bake_desc *given, hemi_solution **out) {
    const size_t least = DESC_THROUGH(hemi_bake_desc, quality);
    double start_s = monotonic_seconds();
    hemi_bake_desc desc = { .struct_size = sizeof desc };
    hemi_solution *solution = NULL;
    if (!in || !out) return HEMI_ERROR_ARGUMENT;
    *out = NULL;
    if (given && !desc_take(in->context, "bake", given, least, &desc, sizeof desc)) return HEMI_ERROR_ARGUMENT;
    const char *fault = bake_desc_fault(&desc);
    if (fault) return context_fail(in->context, HEMI_ERROR_ARGUMENT, "bake: %s", fault);
    context_begin(in->context);
    hemi_result result = context_end(in->context, reach_goal(in, &desc, start_s, &solution));
    if (result == HEMI_OK) {
        solution->statistics.total_s = monotonic_seconds() - start_s;
        *out = solution;
    } else {
        hemi_solution_destroy(solution);
    }
    return result;
}
