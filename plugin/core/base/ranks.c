/* SPDX-License-Identifier: MIT
 * See ranks.h.
 */
#include "base/ranks.h"

#include <string.h>

typedef struct exchange {
    size_t count;
    rank_part (*part)(const void *user, size_t i);
    const void *user;
    unsigned char *bytes, *packed;
    uint64_t *begin, *next; /* of each process in packed, and of the item that comes next of it */
} exchange;

/* Where the bytes of each process begin. */
static void find_begins(const exchange *x, uint32_t rank_count) {
    for (size_t i = 0; i < x->count; i++) {
        rank_part one = x->part(x->user, i);
        x->begin[one.rank + 1] += one.size;
    }
    for (uint32_t r = 0; r < rank_count; r++) x->begin[r + 1] += x->begin[r];
}

/* Copies the items of one process into the packed bytes, or what all have of the others out of them. */
static void copy(const exchange *x, const ranks *r, bool packs) {
    memcpy(x->next, x->begin, r->count * sizeof *x->next);
    for (size_t i = 0; i < x->count; i++) {
        rank_part one = x->part(x->user, i);
        unsigned char *packed = x->packed + x->next[one.rank], *place = x->bytes + one.offset;
        x->next[one.rank] += one.size;
        if ((one.rank == r->rank) == packs) memcpy(packs ? packed : place, packs ? place : packed, one.size);
    }
}

bool ranks_exchange(ranks *r, allocator *memory, size_t count, rank_part (*part)(const void *user, size_t i),
                    const void *user, void *bytes) {
    exchange x = { count, part, user, bytes, .begin = block_zeroed(memory, (size_t)r->count + 1, sizeof *x.begin) };
    x.next = block_new(memory, (size_t)r->count * sizeof *x.next);
    if (x.begin) find_begins(&x, r->count);
    if (x.begin) x.packed = block_new(memory, x.begin[r->count] + 1);
    bool ok = x.next && x.packed;
    if (ok) copy(&x, r, true);
    if (ok && !r->exchange(r->user, x.packed, x.begin)) r->lost = true, ok = false;
    if (ok) copy(&x, r, false);
    block_free_all(x.begin, x.next, x.packed);
    return ok;
}
