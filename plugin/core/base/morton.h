/* SPDX-License-Identifier: MIT
 * In which order are neighbours in space neighbours in a list? Along Morton's curve, which fills it.
 */
#ifndef HEMIBAKE_CORE_BASE_MORTON_H
#define HEMIBAKE_CORE_BASE_MORTON_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Of a code; what is above is the caller's. */
enum { MORTON_BITS = 60 };

typedef struct morton_place {
    uint64_t code;
    uint32_t index;
} morton_place;

/* The lowest 20 bits of x, two places apart. */
static inline uint64_t morton_spread(uint64_t x) {
    x &= 0xfffff;
    x = (x | x << 32) & 0x1f00000000ffffu;
    x = (x | x << 16) & 0x1f0000ff0000ffu;
    x = (x | x << 8) & 0x100f00f00f00f00fu;
    x = (x | x << 4) & 0x10c30c30c30c30c3u;
    return (x | x << 2) & 0x1249249249249249u;
}

/* Of a place in a cube around a centre; 60 bits. */
static inline uint64_t morton_code(const double place[3], const double center[3], double half) {
    uint64_t code = 0;
    for (int k = 0; k < 3; k++) {
        double at = 0.5 + 0.49 * (place[k] - center[k]) / half;
        code |= morton_spread((uint64_t)(fmin(fmax(at, 0.0), 1.0) * 0xfffff)) << k;
    }
    return code;
}

static inline int morton_compare(const void *a, const void *b) {
    const morton_place *p = (const morton_place *)a, *q = (const morton_place *)b;
    if (p->code != q->code) return p->code < q->code ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

static inline void morton_sort(morton_place *places, size_t count) {
    if (count > 0) qsort(places, count, sizeof *places, morton_compare);
}

#endif
