/* SPDX-License-Identifier: MIT
 * Where do numbers come from that look random and are the same on every run? splitmix64 (Steele, Lea & Flood 2014): a
 * well-mixed function of its argument alone.
 */
#ifndef HEMIBAKE_CORE_BASE_SPLITMIX_H
#define HEMIBAKE_CORE_BASE_SPLITMIX_H

#include <stdint.h>

static inline uint64_t splitmix(uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/* In [0, 1), of 53 bits. */
static inline double splitmix_unit(uint64_t x) {
    return (double)(splitmix(x) >> 11) * 0x1p-53;
}

#endif
