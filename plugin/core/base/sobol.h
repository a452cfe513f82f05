/* SPDX-License-Identifier: MIT
 * Where do rays that belong together go, so that they leave no gaps? Points of the unit square by Sobol's sequence: any
 * 2^m that follow each other from a multiple of 2^m on are a (0,m,2)-net, one in each box of that area, whatever its
 * shape. They are scrambled by Owen's nested permutations, in the form of a hash [Laine11], which keeps that.
 */
#ifndef HEMIBAKE_CORE_BASE_SOBOL_H
#define HEMIBAKE_CORE_BASE_SOBOL_H

#include <stdint.h>

static inline uint32_t sobol_reverse(uint32_t x) {
    x = (x >> 16) | (x << 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/* Each bit is flipped or not by the lower ones and the seed. */
static inline uint32_t sobol_hash(uint32_t x, uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    return x ^ x * 0x8d22f6e6u;
}

/* One coordinate, in [0, 1). */
static inline double sobol_1d(uint32_t index, uint32_t seed) {
    return sobol_reverse(sobol_hash(index, seed)) * 0x1p-32;
}

/* The index whose reverse is the second coordinate: bit j is the sum modulo 2 of the bits k of the index for which the
 * binomial (k over j) is odd, those that have all bits of j. */
static inline uint32_t sobol_second(uint32_t x) {
    x ^= (x >> 1) & 0x55555555u;
    x ^= (x >> 2) & 0x33333333u;
    x ^= (x >> 4) & 0x0f0f0f0fu;
    x ^= (x >> 8) & 0x00ff00ffu;
    return x ^ ((x >> 16) & 0x0000ffffu);
}

static inline void sobol_2d(uint32_t index, uint64_t seed, double out[2]) {
    out[0] = sobol_1d(index, (uint32_t)seed);
    out[1] = sobol_1d(sobol_second(index), (uint32_t)(seed >> 32));
}

/* By what the indices of two of the first `count` points differ, a power of two from 2 on, that share a box of those
 * which have two of them each; boxes are square, or twice as long as wide. The sequence is linear over bits, so it is
 * the same for all, whatever scrambles them. */
static inline uint32_t sobol_neighbour(uint32_t count) {
    int bits = 0;
    while (2u << bits < count) bits++;
    const uint32_t wide = 1u << (bits + 1) / 2, high = 1u << bits / 2;
    uint32_t d = count / 2;
    while (sobol_reverse(d) * 0x1p-32 * wide >= 1.0 || sobol_reverse(sobol_second(d)) * 0x1p-32 * high >= 1.0) d++;
    return d;
}

#endif
