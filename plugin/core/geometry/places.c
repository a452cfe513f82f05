/* SPDX-License-Identifier: MIT
 * See places.h. A hash table with open addressing, at most half full; a slot holds the first vertex of its place.
 */
#include "geometry/places.h"

#include "base/splitmix.h"
#include "geometry/vec3.h"

#include <string.h>

static const uint32_t EMPTY = UINT32_MAX;

/* Of either kind, as doubles. */
typedef struct positions {
    const double *doubles;
    const float *floats;
} positions;

/* The bits of a position in which -0 is 0. */
static void bits_of(const positions *p, size_t v, uint64_t bits[3]) {
    double x[3];
    if (p->doubles)
        vec3_copy(x, p->doubles + 3 * v);
    else
        vec3_from_floats(x, p->floats + 3 * v);
    for (int k = 0; k < 3; k++) x[k] += 0.0;
    memcpy(bits, x, sizeof x);
}

size_t places_slot_count(size_t count) {
    size_t slots = 2;
    while (slots < 2 * count) slots *= 2;
    return slots;
}

static uint32_t find(const positions *p, size_t count, uint32_t *slots, uint32_t *place) {
    size_t mask = places_slot_count(count) - 1;
    uint32_t places = 0;
    for (size_t i = 0; i <= mask; i++) slots[i] = EMPTY;
    for (size_t v = 0; v < count; v++) {
        uint64_t own[3], other[3];
        bits_of(p, v, own);
        size_t i = (size_t)splitmix(splitmix(splitmix(own[0]) ^ own[1]) ^ own[2]) & mask;
        for (; slots[i] != EMPTY; i = (i + 1) & mask) {
            bits_of(p, slots[i], other);
            if (memcmp(own, other, sizeof own) == 0) break;
        }
        place[v] = slots[i] == EMPTY ? places++ : place[slots[i]];
        if (slots[i] == EMPTY) slots[i] = (uint32_t)v;
    }
    return places;
}

uint32_t places_find(const double *values, size_t count, uint32_t *slots, uint32_t *place) {
    return find(&(positions){ .doubles = values }, count, slots, place);
}

uint32_t places_find_floats(const float *values, size_t count, uint32_t *slots, uint32_t *place) {
    return find(&(positions){ .floats = values }, count, slots, place);
}

uint32_t *places_new(allocator *memory, const double *values, size_t count, uint32_t *place_count) {
    uint32_t *slots = block_new(memory, places_slot_count(count) * sizeof *slots);
    uint32_t *place = slots ? block_new(memory, (count + 1) * sizeof *place) : NULL;
    if (place) *place_count = places_find(values, count, slots, place);
    block_free(slots);
    return place;
}
