/* SPDX-License-Identifier: MIT
 * Who hears what goes wrong, and which threads does the work? The context.
 */
#include "desc_size.h"
#include "internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

const char *hemi_result_text(hemi_result result) {
    static const char *const texts[] = {
#define RESULT_TEXT(name, text) text,
        HEMI_RESULTS(RESULT_TEXT)
#undef RESULT_TEXT
    };
    return (unsigned)result < HEMI_RESULT_COUNT ? texts[result] : "unknown result";
}

const char *hemi_version(void) {
    return HEMI_VERSION_STRING;
}

double monotonic_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void context_log(const hemi_context *c, hemi_log_level level, const char *format, ...) {
    char text[512];
    va_list arguments;
    if (!c || !c->log) return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    c->log(c->log_user, level, text);
}

hemi_result hemi_context_create(const hemi_context_desc *given, hemi_context **out) {
    hemi_context_desc desc = { 0 };
    if (!out) return HEMI_ERROR_ARGUMENT;
    *out = NULL;
    const size_t least = DESC_THROUGH(hemi_context_desc, threads);
    if (given && !desc_take(NULL, "context", given, least, &desc, sizeof desc)) return HEMI_ERROR_ARGUMENT;
    hemi_context *c = calloc(1, sizeof *c);
    if (!c) return HEMI_ERROR_MEMORY;
    c->log = desc.log;
    c->log_user = desc.log_user;
    c->threads = desc.threads;
    c->jobs = jobs_create(c->threads);
    if (!c->jobs) {
        free(c);
        return HEMI_ERROR_MEMORY;
    }
    *out = c;
    return HEMI_OK;
}

void hemi_context_destroy(hemi_context *context) {
    if (!context) return;
    jobs_destroy(context->jobs);
    item_pool_destroy(context->pool);
    free(context);
}
