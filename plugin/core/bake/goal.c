/* SPDX-License-Identifier: MIT */
#include "bake/goal.h"

/* Cost from one quality to the next, as measured on the scenes of tests/accuracy, 2.5 to 5.5. A quality is not begun
 * when so much of the last one's time is not left. */
static const double COST_OF_A_QUALITY = 6.0;

/* The estimate is 0.7 to 1.4 times the error on the scenes of tests/accuracy; below this share of the goal it is met to
 * within a fifth or so. */
static const double SURE = 0.8;

/* By rows: the first bake, in elements of draft, and the finest, which is reference. The next is meant to be off by
 * this share of what is asked for, and is so many times as fine at most and at least. */
static const double FIRST_SIZE_OF_ROWS = 0.05, LAST_SIZE_OF_ROWS = 18.75, AIM = 0.9;
static const double FINER_MOST = 8.0, FINER_LEAST = 1.3;

/* Their error falls as this power of the size, before two bakes have said how, and whatever they say at least and at
 * most: 0.3 to 0.6 on the shared scenes. */
static const double ERROR_EXPONENT = 0.5, ERROR_EXPONENT_LEAST = 0.25, ERROR_EXPONENT_MOST = 0.8;

/* By time alone: the first bake, in elements of draft; the finest; and by how much each is finer at most, since what
 * starting costs says nothing of elements. */
static const double FIRST_SIZE = 0.25, LAST_SIZE = 18.0, FINER_AT_MOST = 3.0;

/* Cost grows as this power of the number of elements: 1.4 to 1.9 between qualities. A bake is made for this share of
 * the time that is left, the rest is for writing; where that is less than so many times the last one's, none begins. */
static const double COST_EXPONENT = 1.8, SHARE_TO_USE = 0.85, WORTH_IT = 1.3;

/* Of what is left, what one bake may take where it takes longer than was thought: it is ended by then. */
static const double SHARE_AT_MOST = 0.97;

/* A time limit of 0 is none. */
static const double LEAST_TIME = 1e-3;

static double time_left(const goal *g) {
    return g->options.time_limit_s - (g->clock() - g->start_s);
}

static bool is_stopped(const goal *g) {
    return g->stop && *g->stop;
}

/* One bake towards an error. *took: seconds. False ends the search. */
static bool attempt_error(const goal *g, bake_quality quality, const bake_span *span, double *took,
                          bake_outcome *best) {
    bake_options one = g->options;
    one.quality = quality;
    if (g->options.time_limit_s > 0.0) one.time_limit_s = fmax(time_left(g), LEAST_TIME);
    bool goes_on = g->attempt(g->user, &one, span, best);
    *took = g->clock() - span->start_s;
    return goes_on && !is_stopped(g);
}

/* Would what costs so many times as much as the last be late? */
static bool is_late(const goal *g, double took, double cost) {
    return g->options.time_limit_s > 0.0 && time_left(g) < cost * took;
}

/* How many times as fine the next bake is by rows; before: of the one before the last, of size_before. */
static double finer_by(const goal *g, double error, double size, double before, double size_before) {
    double exponent = ERROR_EXPONENT;
    if (before > 0.0)
        exponent = fmin(fmax(log(before / error) / log(size / size_before), ERROR_EXPONENT_LEAST), ERROR_EXPONENT_MOST);
    double finer = pow(error / (AIM * g->options.error_target), 1.0 / exponent);
    return fmin(fmin(fmax(finer, FINER_LEAST), FINER_MOST), LAST_SIZE_OF_ROWS / size);
}

/* Columns have their draft first, and then the next qualities. */
static void reach_error(const goal *g) {
    double size = FIRST_SIZE_OF_ROWS, size_before = 0.0, before = 0.0, low = 0.0, took, scale;
    bake_quality quality = quality_of_size(size, &scale);
    for (;;) {
        const bake_span span = { g->clock(), low, low + 0.25 * (1.0 - low), scale, .of_rows_alone = true };
        bake_outcome best = { 0 };
        if (!attempt_error(g, quality, &span, &took, &best)) return;
        low = span.high;
        if (best.error <= (best.by_rows ? 1.0 : SURE) * g->options.error_target) return;
        if (best.by_rows) {
            double finer = finer_by(g, best.error, size, before, size_before);
            if (size >= LAST_SIZE_OF_ROWS || is_late(g, took, finer)) return;
            before = best.error, size_before = size;
            size = finer * size < LAST_SIZE_OF_ROWS ? finer * size : LAST_SIZE_OF_ROWS;
            quality = quality_of_size(size, &scale);
        } else {
            if (quality == QUALITY_REFERENCE || is_late(g, took, COST_OF_A_QUALITY)) return;
            quality++, scale = 0.0;
        }
    }
}

/* Each bake says what the next may cost. */
static void fill_time(const goal *g) {
    double size = FIRST_SIZE, low = 0.0;
    for (;;) {
        bake_options one = g->options;
        bake_outcome best;
        double begin = g->clock(), scale;
        one.quality = quality_of_size(size, &scale);
        one.time_limit_s = fmax(SHARE_AT_MOST * time_left(g), LEAST_TIME);
        if (!g->attempt(g->user, &one, &(bake_span){ begin, low, 0.5 * (1.0 + low), scale, false }, &best)) return;
        low = 0.5 * (1.0 + low);
        double took = g->clock() - begin, left = time_left(g);
        if (left < WORTH_IT * took || size >= LAST_SIZE || is_stopped(g)) return;
        size *= fmin(pow(SHARE_TO_USE * left / took, 1.0 / COST_EXPONENT), FINER_AT_MOST);
        size = fmin(size, LAST_SIZE);
    }
}

void goal_reach(const goal *g) {
    const bake_options *o = &g->options;
    bool is_free = o->quality == QUALITY_DEFAULT && o->element_size == 0.0 && o->patch_size == 0.0;
    bake_outcome best;
    if (is_free && o->error_target > 0.0)
        reach_error(g);
    else if (is_free && o->time_limit_s > 0.0)
        fill_time(g);
    else
        g->attempt(g->user, o, &(bake_span){ .start_s = g->start_s, .high = 1.0 }, &best);
}
