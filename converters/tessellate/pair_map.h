/* SPDX-License-Identifier: MIT
 * Which value belongs to this pair of numbers? An open-addressing hash table, for edges and welds.
 */
#ifndef HEMIBAKE_TESSELLATE_PAIR_MAP_H
#define HEMIBAKE_TESSELLATE_PAIR_MAP_H

#include <hemibake/allocator.h>

typedef struct pair_map {
    const hemi_allocator *memory; /* NULL: the C library */
    struct pair_entry *entries;
    size_t capacity, count;
} pair_map;

/* The place of the pair's value, made with the value `fresh` if it is new; NULL when out of memory. Valid until the
 * next call. */
uint32_t *pair_map_at(pair_map *m, uint64_t a, uint64_t b, uint32_t fresh);
/* The pair's value, or `missing`; makes none. */
uint32_t pair_map_get(const pair_map *m, uint64_t a, uint64_t b, uint32_t missing);
void pair_map_clear(pair_map *m);
void pair_map_free(pair_map *m);

#endif
