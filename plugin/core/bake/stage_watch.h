/* SPDX-License-Identifier: MIT
 * Who watches a bake, and until when may each stage take? Progress goes up to whoever asked for it, and what stops the
 * stage, a limit of time or somebody's wish, comes down.
 */
#ifndef HEMIBAKE_CORE_BAKE_STAGE_WATCH_H
#define HEMIBAKE_CORE_BAKE_STAGE_WATCH_H

#include "bake/bake.h"
#include "solver/rows.h"

typedef enum bake_stage { STAGE_MESH, STAGE_LIGHT, STAGE_FACTORS, STAGE_REFINE, STAGE_FIT, STAGE_DECIMATE } bake_stage;

typedef struct stage_watch {
    const bake_setup *setup;
    bake_result *out; /* whose cancelled is set */
    bake_stage stage;
    double done;          /* of the whole; does not fall */
    double unshot, noise; /* noise: by rows; 1 until something is known of it */
    uint32_t shots;
    double mesh_s;    /* of the bake, before light is looked for */
    double latest;    /* when the stage is to end, by the clock; 0: no limit */
    atomic_bool over; /* the stage is to end with what it has */
} stage_watch;

/* False where the stage is over before it has begun. */
bool stage_watch_begin(stage_watch *w, bake_stage stage);

/* fraction: of the stage. False cancels. The second is the same for user = a stage_watch. */
bool stage_watch_report(stage_watch *w, double fraction);
bool stage_watch_progress(void *user, double fraction);

/* The same for a solver's; user is a stage_watch. The last: what is known once it is done. */
bool stage_watch_shooting(void *user, double fraction, uint32_t shots, double unshot);
bool stage_watch_rows(void *user, const rows_progress *so_far);
void stage_watch_solved(stage_watch *w);

/* For stages that ask for no more than whether to go on; they stay at the fraction that they begin with. */
watcher stage_watch_watcher(stage_watch *w);

/* Seconds left of a whole of which this fraction has taken so long, where work goes evenly; a limit, s, of the whole is
 * the longest it can take, 0: none. Below 0: too little is known. */
double stage_watch_left(double fraction, double elapsed_s, double limit_s);

#endif
