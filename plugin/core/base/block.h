/* SPDX-License-Identifier: MIT
 * Where does memory come from, and where does it go back to? Every block knows the allocator it came from, so whoever
 * frees it need not:
 *
 *     what the allocator gave    +-----------+------------------------
 *                                | allocator | what the caller gets ...
 *                                +-----------+------------------------
 *
 * Allocators are handed down in what functions work on (a scene, a mesh, the jobs). One that is NULL, or has no
 * functions, is the C library's.
 */
#ifndef HEMIBAKE_CORE_BASE_BLOCK_H
#define HEMIBAKE_CORE_BASE_BLOCK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/* All three functions or none; as malloc, realloc and free; called from any thread, also at the same time. */
typedef struct allocator {
    void *(*alloc)(void *user, size_t bytes);
    void *(*realloc)(void *user, void *block, size_t bytes);
    void (*free)(void *user, void *block);
    void *user;
    atomic_bool exhausted; /* something was asked for and not given, whatever became of it */
    atomic_bool unwanted;  /* nobody waits any more for what is being made: nothing is given, so it ends as it would for
                              want of memory, which every stage can. Not exhausted */
} allocator;

/* For loops that ask for no memory while they run. from may be NULL. */
static inline bool block_unwanted(const allocator *from) {
    return from && atomic_load_explicit(&from->unwanted, memory_order_relaxed);
}

/* Aligned for any type; NULL when there is no memory left. The second is zeroed. */
void *block_new(allocator *from, size_t bytes);
void *block_zeroed(allocator *from, size_t count, size_t size);

/* The block, or NULL, with room for bytes, maybe elsewhere; when there is no memory left it stays as it is. */
void *block_resize(allocator *from, void *block, size_t bytes);

void block_free(void *block); /* NULL is fine */

/* Frees several at once. */
#define block_free_all(...) block_free_list(BLOCKS(__VA_ARGS__), sizeof BLOCKS(__VA_ARGS__) / sizeof(void *))
#define BLOCKS(...)         ((void *[]){ __VA_ARGS__ })
void block_free_list(void *const *blocks, size_t count);

/* Makes room in an array for count, and for one more than count, twice what there was. False when out of memory. */
bool block_reserve(allocator *from, void **array, size_t *capacity, size_t count, size_t size);
bool block_grow(allocator *from, void **array, size_t *capacity, size_t count, size_t size);

#endif
