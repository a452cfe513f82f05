/* SPDX-License-Identifier: MIT */
#include "base/block.h"

#include <stdalign.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD = alignof(max_align_t) };

_Static_assert(sizeof(allocator *) <= HEAD, "the head of a block holds a pointer");

static allocator *host_allocator(allocator *from) {
    return from && from->alloc ? from : NULL;
}

/* Notes whose the block is; without one, that it was refused. */
static void *give(allocator *from, void *base) {
    allocator *owner = host_allocator(from);
    if (base) {
        memcpy(base, &owner, sizeof owner);
        return (unsigned char *)base + HEAD;
    }
    if (from) atomic_store(&from->exhausted, true);
    return NULL;
}

void *block_new(allocator *from, size_t bytes) {
    allocator *host = host_allocator(from);
    if (block_unwanted(from)) return NULL;
    if (bytes > SIZE_MAX - HEAD) return give(from, NULL);
    return give(from, host ? host->alloc(host->user, bytes + HEAD) : malloc(bytes + HEAD));
}

/* The C library knows which pages are zero already. */
void *block_zeroed(allocator *from, size_t count, size_t size) {
    if (block_unwanted(from)) return NULL;
    if (size && count > (SIZE_MAX - HEAD) / size) return give(from, NULL);
    if (!host_allocator(from)) return give(from, calloc(1, count * size + HEAD));
    void *block = block_new(from, count * size);
    return block ? memset(block, 0, count * size) : NULL;
}

static void *base_of(void *block, allocator **owner) {
    unsigned char *base = (unsigned char *)block - HEAD;
    memcpy(owner, base, sizeof *owner);
    return base;
}

void *block_resize(allocator *from, void *block, size_t bytes) {
    allocator *owner;
    if (!block) return block_new(from, bytes);
    if (block_unwanted(from)) return NULL;
    if (bytes > SIZE_MAX - HEAD) return give(from, NULL);
    void *base = base_of(block, &owner);
    return give(from, owner ? owner->realloc(owner->user, base, bytes + HEAD) : realloc(base, bytes + HEAD));
}

void block_free(void *block) {
    allocator *owner;
    if (!block) return;
    void *base = base_of(block, &owner);
    if (owner)
        owner->free(owner->user, base);
    else
        free(base);
}

void block_free_list(void *const *blocks, size_t count) {
    for (size_t i = 0; i < count; i++) block_free(blocks[i]);
}

bool block_reserve(allocator *from, void **array, size_t *capacity, size_t count, size_t size) {
    if (count <= *capacity) return true;
    void *grown = block_resize(from, *array, count * size);
    if (!grown) return false;
    *array = grown;
    *capacity = count;
    return true;
}

bool block_grow(allocator *from, void **array, size_t *capacity, size_t count, size_t size) {
    return count < *capacity || block_reserve(from, array, capacity, *capacity ? 2 * *capacity : 16, size);
}
