/* SPDX-License-Identifier: MIT
 * See arena.h. Small requests share chunks; a large one gets a chunk of its own behind the newest.
 */
#include "base/arena.h"

#include <stdint.h>

enum { CHUNK_BYTES = 1 << 18, ALIGNMENT = 64, ROOM = 256 /* more than a chunk needs beside what is asked for */ };

struct arena_chunk {
    struct arena_chunk *next;
    size_t capacity;
    unsigned char *bytes; /* the first aligned one behind this */
};

static struct arena_chunk *chunk_new(arena *a, size_t capacity) {
    struct arena_chunk *chunk = block_zeroed(a->memory, capacity + sizeof *chunk + ALIGNMENT, 1);
    if (!chunk) return NULL;
    uintptr_t behind = (uintptr_t)(chunk + 1);
    chunk->bytes = (unsigned char *)(chunk + 1) + (ALIGNMENT - behind % ALIGNMENT) % ALIGNMENT;
    chunk->capacity = capacity;
    return chunk;
}

/* Behind the newest chunk, so that the newest keeps serving small requests. */
static void *alloc_large(arena *a, size_t bytes) {
    struct arena_chunk *chunk = chunk_new(a, bytes);
    if (!chunk) return NULL;
    if (a->chunks) {
        chunk->next = a->chunks->next;
        a->chunks->next = chunk;
    } else {
        chunk->next = NULL;
        a->chunks = chunk;
        a->used = bytes;
    }
    return chunk->bytes;
}

void *arena_alloc(arena *a, size_t count, size_t size) {
    if (size && count > (SIZE_MAX - ROOM) / size) return NULL;
    size_t bytes = (count * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (bytes == 0) bytes = ALIGNMENT;
    if (bytes > CHUNK_BYTES / 4) return alloc_large(a, bytes);
    if (!a->chunks || a->chunks->capacity - a->used < bytes) {
        struct arena_chunk *chunk = chunk_new(a, CHUNK_BYTES);
        if (!chunk) return NULL;
        chunk->next = a->chunks;
        a->chunks = chunk;
        a->used = 0;
    }
    void *out = a->chunks->bytes + a->used;
    a->used += bytes;
    return out;
}

void arena_free(arena *a) {
    while (a->chunks) {
        struct arena_chunk *next = a->chunks->next;
        block_free(a->chunks);
        a->chunks = next;
    }
    a->used = 0;
}
