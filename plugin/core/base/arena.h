/* SPDX-License-Identifier: MIT
 * Who owns the memory of a bake? One arena, freed once.
 *
 * Not safe to use from several threads at a time.
 */
#ifndef HEMIBAKE_CORE_BASE_ARENA_H
#define HEMIBAKE_CORE_BASE_ARENA_H

#include "base/block.h"

typedef struct arena {
    allocator *memory; /* NULL: the C library */
    struct arena_chunk *chunks;
    size_t used; /* bytes of the newest chunk */
} arena;

/* count * size zeroed bytes, aligned for any type; NULL when out of memory or when the product overflows. A count of 0
 * gives a valid pointer to nothing. */
void *arena_alloc(arena *a, size_t count, size_t size);

/* Frees everything; the arena is then empty and usable again. */
void arena_free(arena *a);

#endif
