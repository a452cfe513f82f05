/* SPDX-License-Identifier: MIT
 * Which value belongs to this pair of numbers? An open-addressing hash table, for edges and welds.
 */
#ifndef HEMIBAKE_CORE_BASE_PAIR_MAP_H
#define HEMIBAKE_CORE_BASE_PAIR_MAP_H

#include "base/block.h"

#include <stdint.h>

typedef struct pair_map {
    allocator *memory; /* NULL: the C library */
    struct pair_entry *entries;
    size_t capacity, count;
} pair_map;

/* Two numbers in order, so that a pair is the same from either end: returns the lesser. */
static inline uint64_t pair_order(uint32_t a, uint32_t b, uint64_t *high) {
    *high = a > b ? a : b;
    return a > b ? b : a;
}

/* Makes room for so many pairs at once, which is faster than growing to it. False when out of memory. */
bool pair_map_reserve(pair_map *m, size_t count);
/* The place of the pair's value, which is `initial` if the pair is new; NULL when out of memory. Valid until the next
 * call. */
uint32_t *pair_map_at(pair_map *m, uint64_t a, uint64_t b, uint32_t initial);
/* The pair's value, or `missing`; makes none. */
uint32_t pair_map_get(const pair_map *m, uint64_t a, uint64_t b, uint32_t missing);
void pair_map_clear(pair_map *m);
void pair_map_free(pair_map *m);

#endif
