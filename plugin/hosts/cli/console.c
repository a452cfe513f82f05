/* SPDX-License-Identifier: MIT
 * See console.h.
 */
#include "console.h"

#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double REFRESH_S = 0.1;

/* A signal handler has nowhere else to leave a word. */
volatile int console_interrupted;

static void on_interrupt(int number) {
    console_interrupted = 1;
    signal(number, SIG_DFL);
}

void console_catch_interrupt(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_interrupt;
    sigaction(SIGINT, &action, NULL);
}

void console_start(console *c, const options *o) {
    /* Choices count from 1; 0 is unset. */
    c->style = o->progress ? (progress_style)(o->progress - 1) : PROGRESS_AUTO;
    c->quiet = o->quiet;
    c->is_terminal = isatty(STDERR_FILENO);
    c->file = o->inputs[0];
}

void console_end_progress(console *c) {
    if (c->line_open) fprintf(stderr, "\r\033[K");
    c->line_open = false;
}

void console_error(console *c, const char *format, ...) {
    va_list arguments;
    console_end_progress(c);
    fprintf(stderr, "hemibake: %s: ", c->file);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\n");
}

void console_log(void *user, hemi_log_level level, const char *text) {
    console *c = user;
    if (level == HEMI_LOG_ERROR)
        console_error(c, "%s", text);
    else if (!c->quiet)
        console_error(c, "%s%s", level == HEMI_LOG_WARNING ? "warning: " : "", text);
}

bool console_progress(void *user, const hemi_progress *p) {
    console *c = user;
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    double now = (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
    if (c->quiet || (c->style == PROGRESS_AUTO && !c->is_terminal)) return true;
    if (now - c->last_shown_s < (c->style == PROGRESS_AUTO ? REFRESH_S : 10 * REFRESH_S) && p->fraction < 1.0) return true;
    c->last_shown_s = now;
    if (c->style == PROGRESS_JSON) {
        fprintf(stderr, "{\"fraction\":%.4f,\"stage\":\"%s\",\"shots\":%u,\"unshot_fraction\":%.6g}\n", p->fraction,
                p->stage, p->shots, p->unshot_fraction);
    } else if (c->style == PROGRESS_PLAIN) {
        fprintf(stderr, "%3.0f %% %s, %u shots, %.3g %% unshot\n", 100 * p->fraction, p->stage, p->shots,
                100 * p->unshot_fraction);
    } else {
        fprintf(stderr, "\r\033[K%3.0f %% %s, %u shots, %.3g %% unshot", 100 * p->fraction, p->stage, p->shots,
                100 * p->unshot_fraction);
        fflush(stderr);
        c->line_open = true;
    }
    return true;
}
