/* SPDX-License-Identifier: MIT
 * How does one take memory from a hemi_allocator? Its rule in code, for those who are handed one: NULL, and one without
 * functions, is the C library.
 */
#ifndef HEMIBAKE_ALLOCATOR_H
#define HEMIBAKE_ALLOCATOR_H

#include <hemibake/hemibake.h>

#include <stdlib.h>
#include <string.h>

static inline bool hemi_allocator_is_set(const hemi_allocator *a) {
    return a && a->alloc;
}

/* NULL when there is no memory left; no bytes are asked for as one. */
static inline void *hemi_allocate(const hemi_allocator *a, size_t bytes) {
    bytes += bytes == 0;
    return hemi_allocator_is_set(a) ? a->alloc(a->user, bytes) : malloc(bytes);
}

static inline void *hemi_allocate_zeroed(const hemi_allocator *a, size_t count, size_t size) {
    if (!hemi_allocator_is_set(a)) return calloc(count + (count == 0), size);
    if (size && count > SIZE_MAX / size) return NULL;
    void *block = hemi_allocate(a, count * size);
    return block ? memset(block, 0, count * size) : NULL;
}

/* When there is no memory left it gives NULL, and the block stays as it is. */
static inline void *hemi_reallocate(const hemi_allocator *a, void *block, size_t bytes) {
    bytes += bytes == 0;
    if (!block) return hemi_allocate(a, bytes);
    return hemi_allocator_is_set(a) ? a->realloc(a->user, block, bytes) : realloc(block, bytes);
}

static inline void hemi_deallocate(const hemi_allocator *a, void *block) {
    if (!hemi_allocator_is_set(a))
        free(block);
    else if (block)
        a->free(a->user, block);
}

#endif
