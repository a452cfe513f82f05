/* SPDX-License-Identifier: MIT */
#include "base/kept_results.h"

#include <string.h>

/* W/m2 and such; more than any light, and far from where sums of floats have no number. */
static const double NUMBER_MOST = 1e30;

kept_pass kept_pass_begin(kept_results *in, allocator *memory) {
    if (!in || !in->find || !in->add) return (kept_pass){ NULL, memory, 0 };
    return (kept_pass){ in, memory, ++in->passes };
}

static size_t size_of(const kept_part *parts, size_t count) {
    size_t size = 0;
    for (size_t i = 0; i < count; i++) size += parts[i].size;
    return size;
}

unsigned char *kept_take_block(const kept_pass *p, uint64_t item, size_t *size) {
    const uint64_t key[2] = { p->number, item };
    uint64_t found = p->in ? p->in->find(p->in->user, key, NULL, 0) : 0;
    if (found == 0 || found > SIZE_MAX / 2) return NULL;
    unsigned char *bytes = block_new(p->memory, (size_t)found);
    *size = (size_t)found;
    if (bytes && p->in->find(p->in->user, key, bytes, found) == found) return bytes;
    block_free(bytes);
    return NULL;
}

bool kept_are_numbers(const double *all, size_t count, double least) {
    bool ok = true;
    for (size_t i = 0; i < count; i++) ok &= all[i] >= least && all[i] <= NUMBER_MOST;
    return ok;
}

/* Bytes that parts fit, in a block. */
static unsigned char *take_fitting(const kept_pass *p, uint64_t item, const kept_part *parts, size_t count) {
    size_t size = 0;
    unsigned char *bytes = kept_take_block(p, item, &size);
    if (bytes && size == size_of(parts, count)) return bytes;
    block_free(bytes);
    return NULL;
}

static void fill(const kept_part *parts, size_t count, const unsigned char *bytes) {
    for (size_t i = 0; i < count; bytes += parts[i++].size)
        if (parts[i].size > 0) memcpy(parts[i].bytes, bytes, parts[i].size);
}

bool kept_take(const kept_pass *p, uint64_t item, const kept_part *parts, size_t count) {
    unsigned char *bytes = take_fitting(p, item, parts, count);
    if (bytes) fill(parts, count, bytes);
    block_free(bytes);
    return bytes != NULL;
}

bool kept_take_numbers(const kept_pass *p, uint64_t item, const kept_part *parts, size_t count, size_t positive_count) {
    unsigned char *bytes = take_fitting(p, item, parts, count);
    size_t positive = size_of(parts, positive_count) / sizeof(double), all = size_of(parts, count) / sizeof(double);
    const double *numbers = (const double *)(const void *)bytes; /* a block is aligned for any type */
    bool ok = bytes && kept_are_numbers(numbers, positive, 0.0) &&
              kept_are_numbers(numbers + positive, all - positive, -NUMBER_MOST);
    if (ok) fill(parts, count, bytes);
    block_free(bytes);
    return ok;
}

void kept_give(const kept_pass *p, uint64_t item, const kept_part *parts, size_t count) {
    if (!p->in || (p->in->stop && *p->in->stop)) return;
    const uint64_t key[2] = { p->number, item };
    size_t size = size_of(parts, count), at = 0;
    unsigned char *bytes = block_new(p->memory, size + 1);
    if (!bytes) return; /* out of memory: what ends the bake is asked for elsewhere */
    for (size_t i = 0; i < count; at += parts[i++].size)
        if (parts[i].size > 0) memcpy(bytes + at, parts[i].bytes, parts[i].size);
    p->in->add(p->in->user, key, bytes, size);
    block_free(bytes);
}
