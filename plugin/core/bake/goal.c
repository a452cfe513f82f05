/* SPDX-License-Identifier: MIT */
#include "bake/goal.h"

/* Cost from one quality to the next, as measured on the scenes of tests/accuracy, 2.5 to 5.5. A quality is not begun
 * when so much of the last one's time is not left. */
static const double COST_OF_A_QUALITY = 6.0;

/* The estimate is 0.7 to 1.4 times the error on the scenes of tests/accuracy; below this share of the goal it is met to
 * within a fifth or so. */
static const double SURE = 0.8;

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

static void raise_quality(const goal *g) {
    bool is_timed = g->options.time_limit_s > 0.0;
    for (bake_quality quality = QUALITY_DRAFT; quality <= QUALITY_REFERENCE; quality++) {
        bake_options one = g->options;
        double begin = g->clock(), low = 0.25 * (quality - QUALITY_DRAFT), error;
        one.quality = quality;
        if (is_timed) one.time_limit_s = fmax(time_left(g), LEAST_TIME);
        if (!g->attempt(g->user, &one, &(bake_span){ .start_s = begin, .low = low, .high = low + 0.25 }, &error))
            return;
        double took = g->clock() - begin;
        bool no_time = is_timed && time_left(g) < COST_OF_A_QUALITY * took;
        if (error <= SURE * g->options.error_target || no_time || is_stopped(g)) return;
    }
}

/* Each bake says what the next may cost. */
static void fill_time(const goal *g) {
    double size = FIRST_SIZE, low = 0.0;
    for (;;) {
        bake_options one = g->options;
        double begin = g->clock(), scale, error;
        one.quality = quality_of_size(size, &scale);
        one.time_limit_s = fmax(SHARE_AT_MOST * time_left(g), LEAST_TIME);
        if (!g->attempt(g->user, &one, &(bake_span){ begin, low, 0.5 * (1.0 + low), scale }, &error)) return;
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
    double error;
    if (is_free && o->error_target > 0.0)
        raise_quality(g);
    else if (is_free && o->time_limit_s > 0.0)
        fill_time(g);
    else
        g->attempt(g->user, o, &(bake_span){ .start_s = g->start_s, .high = 1.0 }, &error);
}
