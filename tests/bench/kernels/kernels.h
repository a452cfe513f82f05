/* SPDX-License-Identifier: MIT
 * What do the programs under kernels/ share? A clock, a source of random numbers, and a way to print. Each kernel is
 * measured beside the simplest correct loop that does the same, and false is returned where the two disagree.
 */
#ifndef HEMIBAKE_TESTS_BENCH_KERNELS_H
#define HEMIBAKE_TESTS_BENCH_KERNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

bool kernel_hemicubes(void);
bool kernel_items(void);
bool kernel_closed_forms(void);
bool kernel_formats(void);

double kernel_seconds(void);

/* In [0, 1); splitmix64. */
double kernel_random(uint64_t *state);

/* The best seconds of one call of work, of so many runs: what else the machine does only ever slows one down. Short
 * work is repeated within a run until it takes a hundredth of a second. */
double kernel_best(void (*work)(void *user), void *user, int runs);

#ifdef __cplusplus
}
#endif

#endif
