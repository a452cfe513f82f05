/* SPDX-License-Identifier: MIT
 * Which points are a path's random numbers? The first dimensions of Sobol's sequence, scrambled after Owen by a hash
 * and with a shuffled order, so that as many independent sets of four dimensions can be had as there are seeds [Burley,
 * JCGT 9(4), 2020]: the first 2^k points of each fill the cube evenly, and their mean is without bias.
 */
#ifndef HEMIBAKE_ORACLE_SOBOL_H
#define HEMIBAKE_ORACLE_SOBOL_H

#include <stdint.h>

enum { SOBOL_DIMENSIONS = 4 };

/* Directions of [Joe & Kuo 2008], as columns of a matrix over the bits of the index. */
typedef struct sobol {
    uint32_t direction[SOBOL_DIMENSIONS][32];
} sobol;

/* One dimension from its primitive polynomial (degree, coefficients) and first directions. */
static inline void sobol_set_dimension(uint32_t direction[32], int degree, uint32_t coefficients, const uint32_t *m) {
    for (int i = 0; i < 32; i++) {
        if (i < degree) {
            direction[i] = m[i] << (31 - i);
            continue;
        }
        direction[i] = direction[i - degree] ^ (direction[i - degree] >> degree);
        for (int k = 1; k < degree; k++)
            if (coefficients >> (degree - 1 - k) & 1) direction[i] ^= direction[i - k];
    }
}

static inline sobol sobol_create(void) {
    static const uint32_t m[3][3] = { { 1, 0, 0 }, { 1, 3, 0 }, { 1, 3, 1 } };
    static const uint32_t coefficients[3] = { 0, 1, 1 };
    sobol p;
    for (int i = 0; i < 32; i++) p.direction[0][i] = 1u << (31 - i);
    for (int d = 0; d < 3; d++) sobol_set_dimension(p.direction[d + 1], d + 1, coefficients[d], m[d]);
    return p;
}

static inline uint32_t sobol_reverse(uint32_t x) {
    x = (x >> 16) | (x << 16);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

/* Turns the subtrees of a binary fraction over at random: each bit by a hash of those above it. */
static inline uint32_t sobol_scramble(uint32_t x, uint32_t seed) {
    x = sobol_reverse(x) + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return sobol_reverse(x);
}

/* Point number index of the set that a seed names, in [0, 1)^4. */
static inline void sobol_get(const sobol *p, uint32_t index, uint64_t seed, double u[SOBOL_DIMENSIONS]) {
    static const uint32_t salt[SOBOL_DIMENSIONS] = { 0x9e3779b9u, 0x85ebca6bu, 0xc2b2ae35u, 0x27d4eb2fu };
    uint32_t x[SOBOL_DIMENSIONS] = { 0, 0, 0, 0 };
    index = sobol_scramble(index, (uint32_t)seed);
    for (int bit = 0; index; bit++, index >>= 1)
        if (index & 1)
            for (int d = 0; d < SOBOL_DIMENSIONS; d++) x[d] ^= p->direction[d][bit];
    for (int d = 0; d < SOBOL_DIMENSIONS; d++) u[d] = sobol_scramble(x[d], (uint32_t)(seed >> 32) ^ salt[d]) * 0x1p-32;
}

#endif
