/* SPDX-License-Identifier: MIT
 * How fine must a bake be to meet its goal? Where an error is asked for and neither quality nor sizes are, the
 * qualities are climbed until the estimated error is below it. Each costs some four times what the one before does, so
 * what the lower ones took counts little. Where seconds are asked for, a coarse bake says how fast the machine is, and
 * the next is as fine as what is left of them allows.
 */
#ifndef HEMIBAKE_CORE_BAKE_GOAL_H
#define HEMIBAKE_CORE_BAKE_GOAL_H

#include "bake/quality.h"

/* Which part of the whole is this one bake? Progress goes from low to high; time counts from start_s. scale: as in
 * quality_resolve. */
typedef struct bake_span {
    double start_s, low, high, scale;
} bake_span;

typedef struct goal {
    bake_options options; /* as asked for */
    double start_s;
    double (*clock)(void);    /* seconds */
    const volatile int *stop; /* not 0: no further bake is begun; may be NULL */
    /* Bakes once and keeps the best that there is. False ends the search; *error: the estimate of the best. */
    bool (*attempt)(void *user, const bake_options *options, const bake_span *span, double *error);
    void *user;
} goal;

void goal_reach(const goal *g);

#endif
