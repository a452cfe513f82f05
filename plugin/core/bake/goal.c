/* SPDX-License-Identifier: MIT */
#include "bake/goal.h"

/* The next bake is meant to be off by this share of what is asked for: half way down to a fifth less. */
static const double AIM = 0.9;

/* By columns errors fall by such a factor from one quality to the next before two bakes have said by which, and at
 * least and at most whatever they say; and cost grows by at most so many times, as measured on the scenes of
 * tests/accuracy. A bake is not begun when so much of the last one's time is not left. */
static const double FALL = 2.0, FALL_LEAST = 1.4, FALL_MOST = 3.0, COST_OF_A_QUALITY = 6.0;

/* So far the next is from the last, in qualities. */
static const double STEP_LEAST = 0.2, STEP_MOST = 1.5;

/* By rows: of the error, the noise of single samples, which filter and fit smooth to less than half, and what elements
 * are too large for; the rest is for merging triangles. */
static const double NOISE_OF_ERROR = 1.1, UNEVEN_OF_ERROR = 0.8;

/* What elements are too large for falls as this power of their number, before two bakes have said by which, and at
 * least and at most whatever they say; as this one of the noise, in which shadows cannot be told; and as many more rays
 * make up for samples that are more, of which the filter has more to smooth. On living rooms, an office, a bedroom and
 * a map: 0.25 to 0.7, 0.15 to 0.5, and 0.6. */
static const double UNEVEN_EXPONENT = 0.45, UNEVEN_EXPONENT_LEAST = 0.25, UNEVEN_EXPONENT_MOST = 0.8;
static const double SEEN_EXPONENT = 0.4, RAYS_EXPONENT = 0.5;

/* Where neither says what the error comes from all grow by so much at least; and at most. */
static const double FINER_LEAST = 1.3, FINER_MOST = 16.0;

/* The first bake by rows, for an error of so much: elements and rays, in those of draft, and by which powers of a
 * smaller error they grow. A fifth of what the last will take, about. */
static const double FIRST_ERROR = 0.02, FIRST_SIZE = 0.05, FIRST_ELEMENTS_EXPONENT = 0.5, FIRST_RAYS_EXPONENT = 1.0;

/* By columns the first bake is coarser than draft where an error of more than so much is asked for, but no coarser than
 * this. */
static const double ERROR_OF_DRAFT = 0.02, LEVEL_LEAST = 0.1;

/* By time alone: the first bake, in elements of draft; the finest; and by how much each is finer at most, since what
 * starting costs says nothing of elements. */
static const double SIZE_IN_TIME = 0.25, LAST_SIZE = 18.0, FINER_AT_MOST = 3.0;

/* Cost grows as this power of the number of elements: 1.4 to 1.9 between qualities. A bake is made for this share of
 * the time that is left, the rest is for writing; where that is less than so many times the last one's, none begins. */
static const double COST_EXPONENT = 1.8, SHARE_TO_USE = 0.85, WORTH_IT = 1.3;

/* Of what is left, what one bake may take where it takes longer than was thought: it is ended by then. */
static const double SHARE_AT_MOST = 0.97;

/* A time limit of 0 is none. */
static const double LEAST_TIME = 1e-3;

/* Of the time that a bake has, after so much its elements are cut no further before there is light: without light there
 * is nothing to show, and thousands of triangles that all cross each other are cut for minutes. */
static const double SHARE_OF_CUTS = 0.25;

static double time_left(const goal *g) {
    return g->options.time_limit_s - (g->clock() - g->start_s);
}

static void limit_time(const goal *g, double seconds, bake_options *one) {
    one->time_limit_s = fmax(seconds, LEAST_TIME);
    one->cuts_latest = (deadline){ g->clock, g->clock() + SHARE_OF_CUTS * one->time_limit_s };
}

static bool is_stopped(const goal *g) {
    return g->stop && *g->stop;
}

/* One bake towards an error. *took: seconds. False ends the search. */
static bool attempt_error(const goal *g, const bake_fineness *fineness, const bake_span *span, double *took,
                          bake_outcome *out) {
    bake_options one = g->options;
    one.quality = (bake_quality)fmax(fineness->level, QUALITY_DRAFT);
    one.fineness = *fineness;
    if (g->options.time_limit_s > 0.0) limit_time(g, time_left(g), &one);
    bool goes_on = g->attempt(g->user, &one, span, out);
    *took = g->clock() - span->start_s;
    return goes_on && !is_stopped(g);
}

/* Would what costs so many times as much as the last be late? */
static bool is_late(const goal *g, double took, double cost) {
    return g->options.time_limit_s > 0.0 && time_left(g) < cost * took;
}

/* before: what the bake before the last was off by, at level_before. */
static double next_level(const goal *g, double error, double level, double before, double level_before) {
    double fall = FALL;
    if (before > 0.0) fall = fmin(fmax(pow(before / error, 1.0 / (level - level_before)), FALL_LEAST), FALL_MOST);
    double step = log(error / (AIM * g->options.error_target)) / log(fall);
    return level + fmin(fmax(step, STEP_LEAST), STEP_MOST);
}

static double at_least_as_many(double factor) {
    return fmin(fmax(factor, 1.0), FINER_MOST);
}

/* A bake by rows, and how fine it was. */
typedef struct row_bake {
    bake_outcome found;
    bake_fineness fineness;
} row_bake;

/* before: the one before the last, if its elements are any. */
static double uneven_exponent(const row_bake *last, const row_bake *before) {
    double finer = before->fineness.elements > 0.0 ? last->fineness.elements / before->fineness.elements : 1.0;
    if (finer < FINER_LEAST) return UNEVEN_EXPONENT;
    double exponent = log(before->found.uneven / last->found.uneven) / log(finer);
    return fmin(fmax(exponent, UNEVEN_EXPONENT_LEAST), UNEVEN_EXPONENT_MOST);
}

/* So many times as many of each the next bake has by rows. */
static bake_fineness finer_rows(const goal *g, const row_bake *last, const row_bake *before) {
    const bake_outcome *found = &last->found;
    const double aim = AIM * g->options.error_target, noise = NOISE_OF_ERROR * aim;
    const double now = hypot(found->ray_noise, found->emitter_noise);
    const double uneven = found->uneven * pow(fmin(noise / now, 1.0), SEEN_EXPONENT) / (UNEVEN_OF_ERROR * aim);
    bake_fineness by = { .elements = at_least_as_many(pow(uneven, 1.0 / uneven_exponent(last, before))),
                         .emitter_rays = at_least_as_many(pow(found->emitter_noise / noise, 2.0)) };
    by.elements = fmin(by.elements, quality_finest().elements / last->fineness.elements);
    by.rays = at_least_as_many(pow(found->ray_noise / noise, 2.0)) * pow(by.elements, RAYS_EXPONENT);
    return by;
}

/* By how many times what grew most did; no number is larger than that of the finest. */
static double grow(bake_fineness *f, const bake_fineness *by) {
    const bake_fineness most = quality_finest(), before = *f;
    f->elements = fmin(f->elements * by->elements, most.elements);
    f->rays = fmin(f->rays * by->rays, most.rays);
    f->emitter_rays = fmin(f->emitter_rays * by->emitter_rays, most.emitter_rays);
    return fmax(fmax(f->elements / before.elements, f->rays / before.rays), f->emitter_rays / before.emitter_rays);
}

/* Has any of them come to its end? */
static bool is_finest(const bake_fineness *f) {
    const bake_fineness most = quality_finest();
    return f->elements >= most.elements || f->rays >= most.rays || f->emitter_rays >= most.emitter_rays;
}

/* Makes the next bake by rows finer; by how many times it costs more, or 1: none would help. */
static double make_finer(const goal *g, const row_bake *last, const row_bake *before, bake_fineness *next) {
    const bake_fineness by = finer_rows(g, last, before);
    double finer = grow(next, &by);
    if (finer > FINER_LEAST) return finer;
    if (is_finest(&last->fineness)) return 1.0;
    double all = at_least_as_many(fmax(pow(last->found.error / (AIM * g->options.error_target), 2.0), FINER_LEAST));
    *next = last->fineness;
    return grow(next, &(bake_fineness){ .elements = all, .rays = all, .emitter_rays = all });
}

static bake_fineness first_fineness(double error) {
    double smaller = fmax(FIRST_ERROR / error, 1.0), above = fmax(log(error / ERROR_OF_DRAFT) / log(FALL), 0.0);
    return (bake_fineness){ .elements = FIRST_SIZE * pow(smaller, FIRST_ELEMENTS_EXPONENT),
                            .rays = FIRST_SIZE * pow(smaller, FIRST_RAYS_EXPONENT),
                            .emitter_rays = 1.0,
                            .level = fmax(QUALITY_DRAFT - above, LEVEL_LEAST) };
}

static void reach_error(const goal *g) {
    const double most = quality_finest().level;
    double level_before = 0.0, before = 0.0, low = 0.0, took, cost;
    bake_fineness fineness = first_fineness(g->options.error_target);
    row_bake rows_before = { 0 };
    for (;;) {
        const bake_span span = { g->clock(), low, low + 0.25 * (1.0 - low), 0.0 };
        bake_outcome last = { 0 };
        if (!attempt_error(g, &fineness, &span, &took, &last)) return;
        low = span.high;
        if (last.error <= g->options.error_target) return;
        if (last.by_rows) {
            fineness.elements = fmax(fineness.elements, last.elements);
            const row_bake now = { last, fineness };
            cost = make_finer(g, &now, &rows_before, &fineness);
            rows_before = now;
            if (cost == 1.0) return;
        } else {
            double level = fineness.level;
            if (level >= most) return;
            fineness.level = fmin(next_level(g, last.error, level, before, level_before), most);
            cost = pow(COST_OF_A_QUALITY, fineness.level - level);
            before = last.error, level_before = level;
        }
        if (is_late(g, took, cost)) return;
    }
}

/* Each bake says what the next may cost. */
static void fill_time(const goal *g) {
    double size = SIZE_IN_TIME, low = 0.0;
    for (;;) {
        bake_options one = g->options;
        bake_outcome best;
        double begin = g->clock(), scale;
        one.quality = quality_of_size(size, &scale);
        limit_time(g, SHARE_AT_MOST * time_left(g), &one);
        if (!g->attempt(g->user, &one, &(bake_span){ begin, low, 0.5 * (1.0 + low), scale }, &best)) return;
        low = 0.5 * (1.0 + low);
        double took = g->clock() - begin, left = time_left(g);
        if (left < WORTH_IT * took || size >= LAST_SIZE || is_stopped(g)) return;
        size *= fmin(pow(SHARE_TO_USE * left / took, 1.0 / COST_EXPONENT), FINER_AT_MOST);
        size = fmin(size, LAST_SIZE);
    }
}

void goal_reach(const goal *g) {
    bake_options once = g->options;
    const bake_options *o = &g->options;
    bool is_free = o->quality == QUALITY_DEFAULT && o->element_size == 0.0 && o->patch_size == 0.0;
    bake_outcome best;
    if (is_free && o->error_target > 0.0)
        reach_error(g);
    else if (is_free && o->time_limit_s > 0.0)
        fill_time(g);
    else {
        if (o->time_limit_s > 0.0) limit_time(g, o->time_limit_s, &once);
        g->attempt(g->user, &once, &(bake_span){ .start_s = g->start_s, .high = 1.0 }, &best);
    }
}
