/* SPDX-License-Identifier: MIT
 * How fine must a bake be to meet its goal? Where an error is asked for and neither quality nor sizes are, columns
 * climb the qualities until the estimated error is below it. Each costs some four times what the one before does, so
 * what the lower ones took counts little. Rows, which any size suits, begin far coarser than draft, and each bake says
 * how fine the next must be. Where seconds are asked for, a coarse bake says how fast the machine is, and the next is
 * as fine as what is left of them allows.
 */
#ifndef HEMIBAKE_CORE_BAKE_GOAL_H
#define HEMIBAKE_CORE_BAKE_GOAL_H

#include "bake/quality.h"

/* Which part of the whole is this one bake? Progress goes from low to high; time counts from start_s. scale: as in
 * quality_resolve, of columns too or of rows alone. */
typedef struct bake_span {
    double start_s, low, high, scale;
    bool of_rows_alone;
} bake_span;

static inline double bake_span_scale(const bake_span *s, solver_method method) {
    return s->of_rows_alone && method != SOLVER_ROWS ? 0.0 : s->scale;
}

/* What is known of the best bake so far. */
typedef struct bake_outcome {
    double error; /* its estimate */
    bool by_rows;
} bake_outcome;

typedef struct goal {
    bake_options options; /* as asked for */
    double start_s;
    double (*clock)(void);    /* seconds */
    const volatile int *stop; /* not 0: no further bake is begun; may be NULL */
    /* Bakes once and keeps the best that there is. False ends the search. */
    bool (*attempt)(void *user, const bake_options *options, const bake_span *span, bake_outcome *best);
    void *user;
} goal;

void goal_reach(const goal *g);

#endif
