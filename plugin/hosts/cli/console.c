/* SPDX-License-Identifier: MIT */
#include "console.h"

#include "printable.h"
#include "signals.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void console_start(console *c, const options *o) {
    c->quiet = o->quiet;
    c->file = o->inputs[0];
    progress_start(&c->progress, o);
}

int console_error(console *c, const char *format, ...) {
    char text[2048];
    va_list arguments;
    progress_pause(&c->progress);
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    signals_error_begins();
    print_failure(c->file, text);
    signals_error_is_said();
    return EXIT_BAD_INPUT;
}

int console_unwritten(console *c, const char *path, const char *reason) {
    c->file = path;
    console_error(c, "cannot be written: %s", reason);
    return EXIT_OUTPUT;
}

void console_note(console *c, const char *format, ...) {
    va_list arguments;
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
    progress_stop(&c->progress);
    success = success && !c->quiet;
    for (size_t i = 0; success && i < c->note_count; i++) console_error(c, "%s", c->notes[i]);
    if (success && c->notes_dropped) console_error(c, "and %zu more such lines; the report has them", c->notes_dropped);
    free(c->notes);
    c->notes = NULL;
    c->note_count = c->notes_dropped = 0;
}

static void hear(void *user, hemi_log_level level, const char *text) {
    console *c = user;
    if (level == HEMI_LOG_ERROR && memory_limit_refused(c->memory))
        console_error(c, "it takes more than the %.0f MiB of --memory; allow more, or ask for a lower quality",
                      (double)memory_limit_bytes(c->memory) / (1 << 20));
    else if (level == HEMI_LOG_ERROR && c->pictures > 0)
        console_error(c, "%s (of --memory pictures have %.0f MiB)", text, (double)c->pictures / (1 << 20));
    else if (level == HEMI_LOG_ERROR)
        console_error(c, "%s", text);
    else
        console_note(c, "%s%s", level == HEMI_LOG_WARNING ? "warning: " : "", text);
}

int console_limit_memory(console *c, int64_t bytes) {
    if (bytes <= 0) return EXIT_DONE;
    c->memory = memory_limit_create((uint64_t)bytes);
    return c->memory ? EXIT_DONE : console_error(c, "out of memory");
}

uint64_t console_memory_left(void *console_) {
    const console *c = console_;
    return c->memory ? memory_limit_left(c->memory) : UINT64_MAX;
}

int64_t console_memory_of_bake(console *c, uint64_t pictures, int64_t asked) {
    if (!c->memory || asked <= 0) return asked;
    memory_limit_count(c->memory);
    c->pictures = pictures;
    return (uint64_t)asked > pictures ? asked - (int64_t)pictures : 1;
}

int console_context(console *c, uint32_t threads, hemi_context **out) {
    hemi_context_desc desc = { .struct_size = sizeof desc, .threads = threads, .log = hear, .log_user = c };
    if (c->memory) desc.allocator = memory_limit_allocator(c->memory);
    return hemi_context_create(&desc, out) == HEMI_OK ? EXIT_DONE
                                                      : console_error(c, "no memory or no threads to work with");
}
