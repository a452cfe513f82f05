/* SPDX-License-Identifier: MIT
 * How far is it? One line on a terminal, written over; lines in a log; or JSON lines for a host. A thread of its own
 * shows that the work goes on, at least every half second, whatever the work is busy with:
 *
 *      42 % [#####-------] 4/8 factors, 1669 shots, 0.31 % unshot, error 5.1 %, 12 s, 15 s left
 */
#ifndef HEMIBAKE_CLI_PROGRESS_H
#define HEMIBAKE_CLI_PROGRESS_H

#include "options.h"

#include <pthread.h>

typedef struct progress_display {
    progress_style style;
    bool is_shown;  /* at all */
    bool line_open; /* a line waits to be overwritten */
    bool is_idle;   /* between stages */
    bool quit, has_thread;
    double start_s, shown_s;
    hemi_progress now; /* stage: one of the static names */
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t wake;
} progress_display;

double progress_seconds(void); /* of a clock that only runs on */

void progress_start(progress_display *p, const options *o);
void progress_stop(progress_display *p);

/* "read", those of hemi_progress, "colour", "write". */
void progress_stage(progress_display *p, const char *stage);
void progress_update(progress_display *p, const hemi_progress *now);

/* Clears the line; the next stage opens one again. */
void progress_pause(progress_display *p);

#endif
