/* SPDX-License-Identifier: MIT
 * What does a person or a build log see? One line an error on stderr, and progress while it lasts (progress.h).
 */
#ifndef HEMIBAKE_CLI_CONSOLE_H
#define HEMIBAKE_CLI_CONSOLE_H

#include "memory_limit.h"
#include "options.h"
#include "progress.h"

enum { CONSOLE_LINE_SIZE = 512, CONSOLE_NOTES_MAX = 64 };

typedef struct console {
    const char *file; /* named in front of messages */
    bool quiet;
    progress_display progress;
    char (*notes)[CONSOLE_LINE_SIZE]; /* kept until the work has succeeded: an error is one line */
    size_t note_count, notes_dropped;
    memory_limit *memory; /* of the contexts that follow; NULL: any */
    uint64_t pictures;    /* bytes of that which pictures have */
} console;

void console_start(console *c, const options *o);

/* "hemibake: FILE: text"; returns EXIT_BAD_INPUT, as most that end with it do. */
int console_error(console *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Says that an output cannot be written, and why; returns EXIT_OUTPUT. */
int console_unwritten(console *c, const char *path, const char *reason);

/* A line that is shown only if the command succeeds: warnings, what was passed over. Under --quiet the report has it
 * alone. */
void console_note(console *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Prints the notes, or forgets them, and releases what the console holds. */
void console_finish(console *c, bool success);

/* From here on contexts take no more than would bring the process to so many bytes; 0: as much as they like. */
int console_limit_memory(console *c, int64_t bytes);

/* What is still left of them, to be asked of a console; UINT64_MAX: any. */
uint64_t console_memory_left(void *console);

/* Pictures have been read, and have so many bytes: what is left for the bake, of as much as was asked for. */
int64_t console_memory_of_bake(console *c, uint64_t pictures, int64_t asked);

/* A context whose log this console is. EXIT_DONE or an exit status with its line printed. */
int console_context(console *c, uint32_t threads, hemi_context **out);

#endif
