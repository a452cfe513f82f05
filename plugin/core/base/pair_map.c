/* SPDX-License-Identifier: MIT */
#include "base/pair_map.h"

#include <string.h>

enum { LEAST = 256 }; /* entries, of which half are taken at most */

struct pair_entry {
    uint64_t a, b;
    uint32_t value;
    bool used;
};

static uint64_t hash(uint64_t a, uint64_t b) {
    uint64_t x = a * 0x9e3779b97f4a7c15u ^ (b + 0x7f4a7c15u) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 30)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

static struct pair_entry *find(struct pair_entry *entries, size_t capacity, uint64_t a, uint64_t b) {
    size_t i = (size_t)hash(a, b) & (capacity - 1);
    while (entries[i].used && (entries[i].a != a || entries[i].b != b)) i = (i + 1) & (capacity - 1);
    return &entries[i];
}

static bool grow(pair_map *m, size_t capacity) {
    struct pair_entry *entries = block_zeroed(m->memory, capacity, sizeof *entries);
    if (!entries) return false;
    for (size_t i = 0; i < m->capacity; i++)
        if (m->entries[i].used) *find(entries, capacity, m->entries[i].a, m->entries[i].b) = m->entries[i];
    block_free(m->entries);
    m->entries = entries;
    m->capacity = capacity;
    return true;
}

bool pair_map_reserve(pair_map *m, size_t count) {
    size_t capacity = LEAST;
    if (count > SIZE_MAX / 8) return false;
    while (capacity < 2 * count) capacity *= 2;
    return capacity <= m->capacity || grow(m, capacity);
}

uint32_t *pair_map_at(pair_map *m, uint64_t a, uint64_t b, uint32_t initial) {
    struct pair_entry *e = m->capacity ? find(m->entries, m->capacity, a, b) : NULL;
    if (e && e->used) return &e->value;
    if (2 * m->count >= m->capacity) {
        if (!grow(m, m->capacity ? 2 * m->capacity : LEAST)) return NULL;
        e = find(m->entries, m->capacity, a, b);
    }
    *e = (struct pair_entry){ a, b, initial, true };
    m->count++;
    return &e->value;
}

uint32_t pair_map_get(const pair_map *m, uint64_t a, uint64_t b, uint32_t missing) {
    const struct pair_entry *e = m->capacity ? find(m->entries, m->capacity, a, b) : NULL;
    return e && e->used ? e->value : missing;
}

void pair_map_clear(pair_map *m) {
    if (m->entries) memset(m->entries, 0, m->capacity * sizeof *m->entries);
    m->count = 0;
}

void pair_map_free(pair_map *m) {
    block_free(m->entries);
    *m = (pair_map){ .memory = m->memory };
}
