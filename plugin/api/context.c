/* SPDX-License-Identifier: MIT
 * Who hears what goes wrong, and which threads does the work? The context.
 */
#include "desc_size.h"
#include "internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

/* What workers have to say, until the thread that called comes by: a host is called on no other. A line for which there
 * is no memory is lost; so it is where it matters most, but the result stays. */
static void add_pending(hemi_context *c, hemi_log_level level, const char *text) {
    pending_line *line = block_new(NULL, sizeof *line), **end;
    if (!line) return;
    line->next = NULL;
    line->level = level;
    snprintf(line->text, sizeof line->text, "%s", text);
    pthread_mutex_lock(&c->pending_mutex);
    for (end = &c->pending; *end; end = &(*end)->next) {
    }
    *end = line;
    pthread_mutex_unlock(&c->pending_mutex);
}

void context_log(const hemi_context *c, hemi_log_level level, const char *format, ...) {
    char text[CONTEXT_LINE_SIZE];
    va_list arguments;
    if (!c || !c->log) return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!c->is_working || pthread_equal(pthread_self(), c->caller))
        c->log(c->log_user, level, text);
    else
        add_pending((hemi_context *)c, level, text);
}

void context_say_pending(hemi_context *c) {
    pending_line *first;
    pthread_mutex_lock(&c->pending_mutex);
    first = c->pending;
    c->pending = NULL;
    pthread_mutex_unlock(&c->pending_mutex);
    while (first) {
        pending_line *next = first->next;
        if (c->log) c->log(c->log_user, first->level, first->text);
        block_free(first);
        first = next;
    }
}

void context_begin(hemi_context *c) {
    atomic_store(&c->memory.exhausted, false);
    atomic_store(&c->memory.unwanted, false);
    c->caller = pthread_self();
    c->is_working = true;
}

hemi_result context_end(hemi_context *c, hemi_result result) {
    context_say_pending(c);
    c->is_working = false;
    if (result != HEMI_ERROR_MEMORY && !atomic_load(&c->memory.exhausted)) return result;
    return context_fail(c, HEMI_ERROR_MEMORY, "out of memory");
}

hemi_result context_core_failure(const hemi_context *c, const char *failure) {
    /* A context that was being made while the scene was filled may have been refused memory before the call began. */
    if (atomic_load(&c->memory.exhausted) || strcmp(failure, "out of memory") == 0) return HEMI_ERROR_MEMORY;
    return context_fail(c, HEMI_ERROR_BACKEND, "%s", failure);
}

static void *blocks_alloc(void *user, size_t bytes) {
    return block_new(user, bytes);
}

static void *blocks_realloc(void *user, void *block, size_t bytes) {
    return block_resize(user, block, bytes);
}

static void blocks_free(void *user, void *block) {
    (void)user;
    block_free(block);
}

/* What is created and freed with the allocator that is in it. */
static hemi_context *context_new(const hemi_context_desc *desc) {
    const hemi_allocator *host = &desc->allocator;
    allocator memory = { .alloc = host->alloc, .realloc = host->realloc, .free = host->free, .user = host->user };
    hemi_context *c = host->alloc ? host->alloc(host->user, sizeof *c) : malloc(sizeof *c);
    if (!c) return NULL;
    *c = (hemi_context){ .memory = memory, .log = desc->log, .log_user = desc->log_user, .threads = desc->threads };
    pthread_mutex_init(&c->pending_mutex, NULL);
    c->blocks = (hemi_allocator){ blocks_alloc, blocks_realloc, blocks_free, &c->memory };
    return c;
}

static void context_free(hemi_context *c) {
    const allocator memory = c->memory;
    pthread_mutex_destroy(&c->pending_mutex);
    if (memory.free)
        memory.free(memory.user, c);
    else
        free(c);
}

hemi_result hemi_context_create(const hemi_context_desc *given, hemi_context **out) {
    hemi_context_desc desc = { 0 };
    if (!out) return HEMI_ERROR_ARGUMENT;
    *out = NULL;
    const size_t least = DESC_THROUGH(hemi_context_desc, threads);
    if (given && !desc_take(NULL, "context", given, least, &desc, sizeof desc)) return HEMI_ERROR_ARGUMENT;
    const hemi_allocator *host = &desc.allocator;
    if (!host->alloc != !host->realloc || !host->alloc != !host->free) {
        const hemi_context asked = { .log = desc.log, .log_user = desc.log_user };
        return context_fail(&asked, HEMI_ERROR_ARGUMENT, "context: the allocator has one of its functions and not all");
    }
    hemi_context *c = context_new(&desc);
    if (!c) return HEMI_ERROR_MEMORY;
    c->jobs = jobs_create_from(&c->memory, c->threads);
    if (!c->jobs) {
        context_free(c);
        return HEMI_ERROR_MEMORY;
    }
    *out = c;
    return HEMI_OK;
}

void hemi_context_destroy(hemi_context *context) {
    if (!context) return;
    jobs_destroy(context->jobs);
    item_pool_destroy(context->pool);
    context_free(context);
}
