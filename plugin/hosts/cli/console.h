/* SPDX-License-Identifier: MIT
 * What does a person or a build log see? One line an error on stderr, progress while it lasts, and a flag for Ctrl-C.
 */
#ifndef HEMIBAKE_CLI_CONSOLE_H
#define HEMIBAKE_CLI_CONSOLE_H

#include "options.h"

typedef struct console {
    const char *file; /* named in front of messages */
    progress_style style;
    bool quiet, is_terminal;
    bool line_open; /* a progress line waits to be overwritten */
    double last_shown_s;
} console;

void console_start(console *c, const options *o);

/* "hemibake: FILE: text" */
void console_error(console *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* For hemi_context_desc; user is the console. */
void console_log(void *user, hemi_log_level level, const char *text);

/* For hemi_bake_desc; user is the console. Never cancels. */
bool console_progress(void *user, const hemi_progress *progress);

/* Clears a progress line that is open. */
void console_end_progress(console *c);

/* Not 0 after the first Ctrl-C; a second one ends the process. */
extern volatile int console_interrupted;
void console_catch_interrupt(void);

#endif
