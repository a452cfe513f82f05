/* SPDX-License-Identifier: MIT
 * Is memory from an arena zeroed, aligned, apart, and refused when it cannot be had?
 */
#include "base/arena.h"
#include "check.h"

#include <stdint.h>

static int count_nonzero(const unsigned char *bytes, size_t count) {
    int nonzero = 0;
    for (size_t i = 0; i < count; i++) nonzero += bytes[i] != 0;
    return nonzero;
}

static void memory_is_zero_and_aligned(void) {
    arena a = { 0 };
    /* Both sides of a chunk (256 KiB), of a quarter of one (large requests), and odd sizes. */
    static const size_t sizes[] = { 1, 7, 63, 64, 65, 4096, 65535, 65536, 65537, 262143, 262144, 300000, 3 };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        unsigned char *bytes = arena_alloc(&a, sizes[i], 1);
        CHECK(bytes != NULL);
        if (!bytes) continue;
        CHECK_EQUAL((uintptr_t)bytes % _Alignof(max_align_t), 0);
        CHECK_EQUAL(count_nonzero(bytes, sizes[i]), 0);
        memset(bytes, 0xff, sizes[i]);
    }
    arena_free(&a);
}

static void blocks_do_not_overlap(void) {
    enum { COUNT = 2000 };
    arena a = { 0 };
    static unsigned char *block[COUNT];
    static size_t size[COUNT];
    for (int i = 0; i < COUNT; i++) {
        /* Now and then a large one between the small ones. */
        size[i] = i % 97 == 0 ? 100000 : (size_t)(i * 37 % 500 + 1);
        block[i] = arena_alloc(&a, size[i], 1);
        CHECK(block[i] != NULL);
        if (block[i]) memset(block[i], i % 251, size[i]);
    }
    for (int i = 0; i < COUNT; i++) {
        int wrong = 0;
        for (size_t k = 0; block[i] && k < size[i]; k++) wrong += block[i][k] != i % 251;
        CHECK_EQUAL(wrong, 0);
    }
    arena_free(&a);
}

static void a_product_that_overflows_is_refused(void) {
    arena a = { 0 };
    CHECK(arena_alloc(&a, SIZE_MAX, 2) == NULL);
    CHECK(arena_alloc(&a, SIZE_MAX / 2 + 2, 2) == NULL);
    CHECK(arena_alloc(&a, SIZE_MAX, 1) == NULL);
    CHECK(arena_alloc(&a, SIZE_MAX - 8, 1) == NULL);
    CHECK(arena_alloc(&a, 2, SIZE_MAX) == NULL);
    CHECK(arena_alloc(&a, (size_t)1 << 33, (size_t)1 << 33) == NULL);
    /* And the arena still works. */
    CHECK(arena_alloc(&a, 10, 8) != NULL);
    arena_free(&a);
}

static void a_count_of_zero_is_a_valid_pointer_to_nothing(void) {
    arena a = { 0 };
    void *first = arena_alloc(&a, 0, 8), *second = arena_alloc(&a, 8, 0);
    CHECK(first != NULL);
    CHECK(second != NULL);
    CHECK(first != second);
    arena_free(&a);
}

static void a_freed_arena_is_empty_and_works_again(void) {
    arena a = { 0 };
    arena_free(&a);
    for (int round = 0; round < 3; round++) {
        unsigned char *bytes = arena_alloc(&a, 1000, 1), *large = arena_alloc(&a, 1, 1 << 20);
        CHECK(bytes && large);
        if (bytes) CHECK_EQUAL(count_nonzero(bytes, 1000), 0);
        if (bytes) memset(bytes, 1, 1000);
        arena_free(&a);
        CHECK(a.chunks == NULL);
        CHECK_EQUAL(a.used, 0);
    }
}

int main(void) {
    RUN(memory_is_zero_and_aligned);
    RUN(blocks_do_not_overlap);
    RUN(a_product_that_overflows_is_refused);
    RUN(a_count_of_zero_is_a_valid_pointer_to_nothing);
    RUN(a_freed_arena_is_empty_and_works_again);
    return check_end();
}
