/* SPDX-License-Identifier: MIT */
#include "memory_limit.h"

#include <stdalign.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Before each block stands its size. */
enum { HEAD = alignof(max_align_t) };

/* Libraries below take some beside, and predictions are not exact: what is refused lies in the tenth that they may be
 * off by. */
static const double SLACK = 1.05;

struct memory_limit {
    uint64_t bytes, before; /* before: that the process had */
    _Atomic uint64_t used;
    atomic_bool refused;
};

/* Of the process; 0 where the system does not say. */
static uint64_t resident_bytes(void) {
    unsigned long long all = 0, resident = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (!f) return 0;
    bool ok = fscanf(f, "%llu %llu", &all, &resident) == 2;
    fclose(f);
    return ok ? resident * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

memory_limit *memory_limit_create(uint64_t bytes) {
    memory_limit *m = calloc(1, sizeof *m);
    if (m) m->bytes = bytes, m->before = resident_bytes();
    return m;
}

void memory_limit_destroy(memory_limit *m) {
    free(m);
}

/* False: so many more are too many. */
static bool take(memory_limit *m, uint64_t bytes) {
    uint64_t used = atomic_fetch_add(&m->used, bytes) + bytes;
    if ((double)(m->before + used) <= SLACK * (double)m->bytes) return true;
    atomic_fetch_sub(&m->used, bytes);
    atomic_store(&m->refused, true);
    return false;
}

static uint64_t size_of(const unsigned char *base) {
    uint64_t size;
    memcpy(&size, base, sizeof size);
    return size;
}

static void *give(unsigned char *base, uint64_t size) {
    memcpy(base, &size, sizeof size);
    return base + HEAD;
}

static void *limited_alloc(void *user, size_t bytes) {
    memory_limit *m = user;
    if (bytes > SIZE_MAX - HEAD || !take(m, bytes)) return NULL;
    unsigned char *base = malloc(bytes + HEAD);
    if (base) return give(base, bytes);
    atomic_fetch_sub(&m->used, bytes);
    return NULL;
}

static void limited_free(void *user, void *block) {
    memory_limit *m = user;
    if (!block) return;
    unsigned char *base = (unsigned char *)block - HEAD;
    atomic_fetch_sub(&m->used, size_of(base));
    free(base);
}

static void *limited_realloc(void *user, void *block, size_t bytes) {
    memory_limit *m = user;
    if (!block) return limited_alloc(user, bytes);
    unsigned char *base = (unsigned char *)block - HEAD;
    uint64_t before = size_of(base), more = bytes > before ? bytes - before : 0;
    if (bytes > SIZE_MAX - HEAD || !take(m, more)) return NULL;
    unsigned char *moved = realloc(base, bytes + HEAD);
    atomic_fetch_sub(&m->used, !moved ? more : bytes < before ? before - bytes : 0);
    return moved ? give(moved, bytes) : NULL;
}

hemi_allocator memory_limit_allocator(memory_limit *m) {
    return (hemi_allocator){ limited_alloc, limited_realloc, limited_free, m };
}

void memory_limit_count(memory_limit *m) {
    uint64_t resident = resident_bytes(), used = atomic_load(&m->used);
    if (resident > used && resident - used > m->before) m->before = resident - used;
}

uint64_t memory_limit_left(const memory_limit *m) {
    double left = SLACK * (double)m->bytes - (double)resident_bytes();
    return left > 0.0 ? (uint64_t)left : 0;
}

bool memory_limit_refused(const memory_limit *m) {
    return m && atomic_load(&m->refused);
}

uint64_t memory_limit_bytes(const memory_limit *m) {
    return m->bytes;
}
