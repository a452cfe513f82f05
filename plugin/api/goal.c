/* SPDX-License-Identifier: MIT
 * How fine must a bake be to meet its goal? Where an error is asked for and neither quality nor sizes are, the
 * qualities are climbed until the estimated error is below it. Each costs some ten times what the one before does, so
 * what the lower ones took hardly counts.
 */
#include "desc_size.h"
#include "internal.h"

#include <math.h>

/* Elements from one quality to the next, times the cost of each, as measured on the scenes of tests/accuracy. A rung is
 * not begun when so much of the last one's time is not left. */
static const double COST_OF_A_RUNG = 6.0;

static bool climbs(const hemi_bake_desc *d) {
    return d->error_target > 0.0 && d->quality == HEMI_QUALITY_DEFAULT && d->element_size == 0.0 &&
           d->patch_size == 0.0;
}

static bool is_finished(const hemi_bake_desc *d) {
    return d->finish && *d->finish;
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
        hemi_result result = bake_once(in, &rung, &(bake_span){ begin, low, low + 0.25 }, &next);
        if (result != HEMI_OK) return result;
        keep_better(best, next);
        double took = monotonic_seconds() - begin, left = desc->time_limit_s - (monotonic_seconds() - start_s);
        bool no_time = desc->time_limit_s > 0.0 && left < COST_OF_A_RUNG * took;
        if ((*best)->statistics.error_estimate <= desc->error_target || no_time || is_finished(desc)) break;
    }
    return HEMI_OK;
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
    hemi_result result = climbs(&desc) ? climb(in, &desc, start_s, &solution)
                                       : bake_once(in, &desc, &(bake_span){ start_s, 0.0, 1.0 }, &solution);
    result = context_end(in->context, result);
    if (result == HEMI_OK) {
        solution->statistics.total_s = monotonic_seconds() - start_s;
        *out = solution;
    } else {
        hemi_solution_destroy(solution);
    }
    return result;
}
