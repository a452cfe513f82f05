/* SPDX-License-Identifier: MIT
 * How fine must a bake be to meet its goal? Where an error is asked for and neither quality nor sizes are, bakes follow
 * each other until one is estimated to be off by no more than that. What the last one was off by, and whether rays were
 * few or elements large, says how many of which the next has, so that it is off by little less: columns are between two
 * qualities or coarser than draft, and rows begin far coarser than draft. What led to the last one costs little beside
 * it. No clock decides on any of this. Where seconds are asked for, a coarse bake says how fast the machine is, and the
 * next is as fine as what is left of them allows.
 */
#ifndef HEMIBAKE_CORE_BAKE_GOAL_H
#define HEMIBAKE_CORE_BAKE_GOAL_H

#include "bake/quality.h"

/* Which part of the whole is this one bake? Progress goes from low to high; time counts from start_s. scale: as in
 * quality_resolve. */
typedef struct bake_span {
    double start_s, low, high, scale;
} bake_span;

/* What is known of the best bake so far, and of the last. */
typedef struct bake_outcome {
    double error;                            /* the best's estimate */
    bool by_rows;                            /* or by columns */
    double ray_noise, emitter_noise, uneven; /* of the last, by rows: rows_result's and vertex_colors' */
    double elements;                         /* of the last, by rows: at least the bake_fineness's */
} bake_outcome;

typedef struct goal {
    bake_options options; /* as asked for */
    double start_s;
    double (*clock)(void);    /* seconds */
    const volatile int *stop; /* not 0: no further bake is begun; may be NULL */
    /* Bakes once and keeps the best that there is. False ends the search. */
    bool (*attempt)(void *user, const bake_options *options, const bake_span *span, bake_outcome *out);
    void *user;
} goal;

void goal_reach(const goal *g);

#endif
