/* SPDX-License-Identifier: MIT
 * Who else works on the same bake, and how does what each of them finds come to all? Processes, on one machine or on
 * many, that were given the same input and options and do all of the same in the same order, but for items that each
 * does some of: what these give is exchanged, byte for byte, so that all go on alike. How bytes go from one process to
 * another is the host's.
 */
#ifndef HEMIBAKE_CORE_BASE_RANKS_H
#define HEMIBAKE_CORE_BASE_RANKS_H

#include "base/block.h"

#include <stdint.h>

typedef struct ranks {
    uint32_t rank, count; /* of this process, from 0, and of them all */
    /* begin[r] to begin[r+1] of the bytes are of process r; afterwards all of them are the same everywhere. All
     * processes call it as often, of as many bytes. False: the others cannot be reached. */
    bool (*exchange)(void *user, void *bytes, const uint64_t *begin);
    void *user;
    bool lost; /* the others were not reached once */
} ranks;

/* Bytes of an item, and whose they are. */
typedef struct rank_part {
    uint32_t rank;
    uint64_t offset, size;
} rank_part;

/* part(user, i): of item i in bytes. Each process has set its own; afterwards each has all. False: out of memory, or
 * lost. */
bool ranks_exchange(ranks *r, allocator *memory, size_t count, rank_part (*part)(const void *user, size_t i),
                    const void *user, void *bytes);

#endif
