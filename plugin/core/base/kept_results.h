/* SPDX-License-Identifier: MIT
 * Which results need not be worked out again? Those that an earlier bake of the same scene by the same options has
 * left with whoever keeps them: a host that writes a checkpoint. A bake goes on from there by doing all of it again,
 * but for what it finds: the solution has the same bytes, whenever the earlier bake was ended, since each result
 * depends on the scene, the options and the results before it alone.
 *
 * A pass is work that falls into items. Passes are counted as they begin, which is in the same order in every bake of
 * the same; so a pass is begun between jobs, never in one. Whoever is stopped skips passes: nothing is kept from then
 * on.
 *
 * What is found may be anybody's bytes: whoever takes it checks what it is used for, and works it out where it is no
 * such thing.
 */
#ifndef HEMIBAKE_CORE_BASE_KEPT_RESULTS_H
#define HEMIBAKE_CORE_BASE_KEPT_RESULTS_H

#include "base/block.h"

#include <stdint.h>

typedef struct kept_results {
    /* How many bytes are kept by this key, 0: none; copied if there is room for all. From any thread. */
    uint64_t (*find)(void *user, const uint64_t key[2], void *bytes, uint64_t room);
    void (*add)(void *user, const uint64_t key[2], const void *bytes, uint64_t size);
    void *user;
    const volatile int *stop; /* not 0: a bake that is stopped; may be NULL */
    uint64_t passes;          /* begun so far */
} kept_results;

typedef struct kept_pass {
    kept_results *in; /* NULL: nobody keeps anything */
    allocator *memory;
    uint64_t number;
} kept_pass;

/* in may be NULL, or without functions: nobody keeps anything then. */
kept_pass kept_pass_begin(kept_results *in, allocator *memory);

/* Bytes of a result, one part after the other. */
typedef struct kept_part {
    void *bytes;
    size_t size;
} kept_part;

/* Fills the parts of an item with what is kept; false if nothing is, or not so many bytes: they are as before then. In
 * a job. */
bool kept_take(const kept_pass *p, uint64_t item, const kept_part *parts, size_t count);
/* The same of parts that are doubles, where all are numbers that light can be, but for their sign: only those of the
 * first parts, so many, are not negative. */
bool kept_take_numbers(const kept_pass *p, uint64_t item, const kept_part *parts, size_t count, size_t positive_count);
/* Are all numbers that light can be, from `least` on? */
bool kept_are_numbers(const double *all, size_t count, double least);
void kept_give(const kept_pass *p, uint64_t item, const kept_part *parts, size_t count);

/* What is kept of an item, in a block, whatever its size; NULL: nothing. */
unsigned char *kept_take_block(const kept_pass *p, uint64_t item, size_t *size);

#endif
