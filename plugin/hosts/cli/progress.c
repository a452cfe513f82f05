/* SPDX-License-Identifier: MIT */
#include "progress.h"

#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

/* Not more often than that, and not more seldom where the work says nothing. */
static const double LEAST_S[] = { [PROGRESS_AUTO] = 0.1, [PROGRESS_PLAIN] = 1.0, [PROGRESS_JSON] = 0.1 };
static const double MOST_S[] = { [PROGRESS_AUTO] = 0.25, [PROGRESS_PLAIN] = 1.0, [PROGRESS_JSON] = 0.4 };

enum { BAR = 12, LINE_SIZE = 256, COLUMNS_DEFAULT = 80, TICK_MS = 50 };

/* In the order in which they come; adapting and climbing to a finer quality go through some again. */
static const char *const STAGES[] = { "read", "mesh", "light", "factors", "refine", "reconstruct", "colour", "write" };
enum { STAGE_COUNT = sizeof STAGES / sizeof *STAGES };

double progress_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int step_of(const char *stage) {
    for (int i = 0; i < STAGE_COUNT; i++)
        if (strcmp(STAGES[i], stage) == 0) return i + 1;
    return 0;
}

/* ---- what is shown ----------------------------------------------------------------------------------------------- */

__attribute__((format(printf, 3, 4))) static void append(char *line, size_t size, const char *format, ...) {
    size_t at = strlen(line);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line + at, size - at, format, arguments);
    va_end(arguments);
}

static void describe(const hemi_progress *n, int bar, bool has_shots, char line[LINE_SIZE]) {
    line[0] = '\0';
    append(line, LINE_SIZE, "%3.0f %% ", 100 * n->fraction);
    if (bar > 0) {
        int full = (int)(bar * n->fraction);
        append(line, LINE_SIZE, "[%.*s%.*s] ", full, "############", bar - full, "------------");
    }
    append(line, LINE_SIZE, "%d/%d %s", step_of(n->stage), STAGE_COUNT, n->stage);
    if (n->shots > 0 && has_shots) append(line, LINE_SIZE, ", %u shots", n->shots);
    if (n->shots > 0)
        append(line, LINE_SIZE, ", %.3g %% unshot", 100 * n->unshot_fraction);
    else if (n->unshot_fraction < 1.0) /* nothing shoots by rows */
        append(line, LINE_SIZE, ", residual %.2f %%", 100 * n->unshot_fraction);
    double error = 100 * n->error_estimate;
    if (error >= 0.0) append(line, LINE_SIZE, ", error %.*f %%", error < 1.0 ? 2 : error < 10.0 ? 1 : 0, error);
    append(line, LINE_SIZE, ", %.1f s", n->elapsed_s);
    if (n->left_s >= 0.0) append(line, LINE_SIZE, ", %.0f s left", ceil(n->left_s));
}

/* A line that does not fit would leave its beginning behind when it is written over: what says least is left out, and
 * the end cut off only where no more is to be left out. */
static void show_on_terminal(const hemi_progress *n) {
    char line[LINE_SIZE];
    struct winsize size;
    int columns = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : COLUMNS_DEFAULT;
    static const int bars[] = { BAR, BAR, BAR / 2, 0 };
    for (size_t left_out = 0; left_out < sizeof bars / sizeof *bars; left_out++) {
        describe(n, bars[left_out], left_out == 0, line);
        if (strlen(line) < (size_t)columns) break;
    }
    fprintf(stderr, "\r\033[K%.*s", columns - 1, line);
    fflush(stderr);
}

static void print_known(const char *name, double value) {
    if (value >= 0.0)
        fprintf(stderr, ",\"%s\":%.6g", name, value);
    else
        fprintf(stderr, ",\"%s\":null", name);
}

static void show_as_json(const hemi_progress *n) {
    flockfile(stderr);
    fprintf(stderr,
            "{\"fraction\":%.4f,\"stage\":\"%s\",\"step\":%d,\"steps\":%d,\"shots\":%u,\"unshot_fraction\":%.6g",
            n->fraction, n->stage, step_of(n->stage), STAGE_COUNT, n->shots, n->unshot_fraction);
    print_known("error_estimate", n->error_estimate);
    print_known("elapsed_s", n->elapsed_s);
    print_known("left_s", n->left_s);
    fputs("}\n", stderr);
    funlockfile(stderr);
}

static void show(progress_display *p, double now_s) {
    char line[LINE_SIZE];
    hemi_progress n = p->now;
    double passed = now_s - p->start_s;
    if (n.left_s >= 0.0) n.left_s = fmax(n.left_s - fmax(passed - n.elapsed_s, 0.0), 0.0);
    n.elapsed_s = passed;
    p->shown_s = now_s;
    if (p->style == PROGRESS_JSON) {
        show_as_json(&n);
    } else if (p->style == PROGRESS_PLAIN) {
        describe(&n, 0, true, line);
        fprintf(stderr, "%s\n", line);
    } else {
        show_on_terminal(&n);
        p->line_open = true;
    }
}

/* ---- the thread -------------------------------------------------------------------------------------------------- */

static void *tick(void *user) {
    progress_display *p = user;
    pthread_mutex_lock(&p->mutex);
    while (!p->quit) {
        struct timespec until;
        double now = progress_seconds();
        if (!p->is_idle && now - p->shown_s >= MOST_S[p->style]) show(p, now);
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += TICK_MS * 1000000L;
        if (until.tv_nsec >= 1000000000L) until.tv_sec++, until.tv_nsec -= 1000000000L;
        pthread_cond_timedwait(&p->wake, &p->mutex, &until);
    }
    pthread_mutex_unlock(&p->mutex);
    return NULL;
}

/* Signals are for the thread that works: a read or write that it waits in is to end. */
static void start_thread(progress_display *p) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    p->has_thread = pthread_create(&p->thread, NULL, tick, p) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void progress_start(progress_display *p, const options *o) {
    /* Choices count from 1; 0 is unset. */
    p->style = o->progress ? (progress_style)(o->progress - 1) : PROGRESS_AUTO;
    p->is_shown = !o->quiet && !o->hides_progress && (p->style != PROGRESS_AUTO || isatty(STDERR_FILENO));
    p->is_idle = true;
    p->start_s = p->shown_s = progress_seconds(); /* what fails at once fails in one line */
    pthread_mutex_init(&p->mutex, NULL);
    pthread_cond_init(&p->wake, NULL);
}

void progress_stop(progress_display *p) {
    progress_pause(p);
    if (p->has_thread) {
        pthread_mutex_lock(&p->mutex);
        p->quit = true;
        pthread_cond_signal(&p->wake);
        pthread_mutex_unlock(&p->mutex);
        pthread_join(p->thread, NULL);
    }
    p->has_thread = p->is_shown = false;
}

/* ---- what is new ------------------------------------------------------------------------------------------------- */

void progress_stage(progress_display *p, const char *stage) {
    if (!p->is_shown) return;
    pthread_mutex_lock(&p->mutex);
    bool is_first = !p->now.stage;
    p->now.stage = stage;
    if (is_first) p->now.unshot_fraction = p->now.error_estimate = 1.0, p->now.left_s = -1.0;
    p->is_idle = false;
    pthread_mutex_unlock(&p->mutex);
    if (!p->has_thread) start_thread(p);
}

void progress_update(progress_display *p, const hemi_progress *now) {
    if (!p->is_shown) return;
    pthread_mutex_lock(&p->mutex);
    double begun_s = progress_seconds();
    p->now = *now;
    p->now.elapsed_s = begun_s - p->start_s;
    p->is_idle = false;
    if (begun_s - p->shown_s >= LEAST_S[p->style] || now->fraction >= 1.0) show(p, begun_s);
    pthread_mutex_unlock(&p->mutex);
}

void progress_pause(progress_display *p) {
    if (!p->is_shown) return;
    pthread_mutex_lock(&p->mutex);
    if (p->line_open) {
        fprintf(stderr, "\r\033[K");
        fflush(stderr);
    }
    p->line_open = false;
    p->is_idle = true;
    pthread_mutex_unlock(&p->mutex);
}
