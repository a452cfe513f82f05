/* SPDX-License-Identifier: MIT
 * See console.h.
 */
#include "console.h"

#include "printable.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double REFRESH_S = 0.1;

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
    char text[2048];
    va_list arguments;
    console_end_progress(c);
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fputs("hemibake: ", stderr);
    print_printable(stderr, c->file);
    fputs(": ", stderr);
    print_printable(stderr, text);
    fputc('\n', stderr);
}

void console_note(console *c, const char *format, ...) {
    va_list arguments;
    if (c->quiet) return;
    if (!c->notes) c->notes = calloc(CONSOLE_NOTES_MAX, sizeof *c->notes);
    if (!c->notes || c->note_count == CONSOLE_NOTES_MAX) {
        c->notes_dropped++;
        return;
    }
    va_start(arguments, format);
    vsnprintf(c->notes[c->note_count++], CONSOLE_LINE_SIZE, format, arguments);
    va_end(arguments);
}

void console_finish(console *c, bool success) {
    console_end_progress(c);
    for (size_t i = 0; success && i < c->note_count; i++) console_error(c, "%s", c->notes[i]);
    if (success && c->notes_dropped) console_error(c, "and %zu more such lines; the report has them", c->notes_dropped);
    free(c->notes);
    c->notes = NULL;
    c->note_count = c->notes_dropped = 0;
}

void console_log(void *user, hemi_log_level level, const char *text) {
    console *c = user;
    if (level == HEMI_LOG_ERROR)
        console_error(c, "%s", text);
    else
        console_note(c, "%s%s", level == HEMI_LOG_WARNING ? "warning: " : "", text);
}

bool console_progress(void *user, const hemi_progress *p) {
    console *c = user;
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    double now = (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
    if (c->quiet || (c->style == PROGRESS_AUTO && !c->is_terminal)) return true;
    if (now - c->last_shown_s < (c->style == PROGRESS_PLAIN ? 10 * REFRESH_S : REFRESH_S) && p->fraction < 1.0)
        return true;
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
