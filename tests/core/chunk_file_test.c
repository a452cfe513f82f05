/* SPDX-License-Identifier: MIT
 * Do arrays come back from a chunk file as they went, and is every damage to it noticed?
 */
#include "base/chunk_file.h"
#include "check.h"

#include <stdlib.h>

static const char MAGIC[] = "hemitest";
enum { VERSION = 3, COUNT = 1000 };

static chunk_memory written(void) {
    static uint32_t numbers[COUNT];
    chunk_memory m = { 0 };
    chunk_writer w = { .write = chunk_memory_write, .user = &m };
    for (uint32_t i = 0; i < COUNT; i++) numbers[i] = i * i;
    chunk_write_begin(&w, MAGIC, VERSION);
    chunk_write(&w, "size", &(double){ 0.25 }, sizeof(double));
    chunk_write(&w, "none", NULL, 0);
    chunk_write(&w, "list", numbers, sizeof numbers);
    CHECK(chunk_write_end(&w));
    m.size = m.used, m.used = 0;
    return m;
}

/* Reads what was written; a fault, or none. *sum: of the numbers. */
static chunk_fault read_all(const unsigned char *bytes, size_t size, uint64_t *sum) {
    chunk_memory m = { .bytes = (unsigned char *)bytes, .size = size };
    chunk_reader r = { .read = chunk_memory_read, .user = &m };
    double one = 0.0;
    void *none = NULL, *list = NULL;
    size_t no = 0, count = 0;
    bool ok = chunk_read_begin(&r, MAGIC, VERSION) && chunk_read_into(&r, "size", &one, sizeof one) &&
              chunk_read_block(&r, "none", 8, &none, &no) &&
              chunk_read_block(&r, "list", sizeof(uint32_t), &list, &count) && chunk_read_end(&r);
    CHECK(ok == (r.fault == CHUNK_FINE));
    *sum = 0;
    for (size_t i = 0; i < count; i++) *sum += ((uint32_t *)list)[i];
    if (ok) CHECK(one == 0.25 && none && no == 0 && count == COUNT);
    block_free_all(none, list);
    return r.fault;
}

static void arrays_come_back(void) {
    chunk_memory m = written();
    uint64_t sum;
    CHECK_EQUAL(read_all(m.bytes, m.size, &sum), CHUNK_FINE);
    CHECK_EQUAL(sum, (uint64_t)(COUNT - 1) * COUNT * (2 * COUNT - 1) / 6);
    block_free(m.bytes);
}

static void every_beginning_is_refused(void) {
    chunk_memory m = written();
    uint64_t sum;
    size_t taken = 0;
    for (size_t size = 0; size < m.size; size++) taken += read_all(m.bytes, size, &sum) == CHUNK_FINE;
    CHECK_EQUAL(taken, 0);
    CHECK_EQUAL(read_all(m.bytes, m.size - 1, &sum), CHUNK_TRUNCATED);
    block_free(m.bytes);
}

static void every_flipped_bit_is_refused(void) {
    chunk_memory m = written();
    uint64_t sum;
    size_t taken = 0;
    for (size_t i = 0; i < 8 * m.size; i++) {
        m.bytes[i / 8] ^= (unsigned char)(1u << i % 8);
        taken += read_all(m.bytes, m.size, &sum) == CHUNK_FINE;
        m.bytes[i / 8] ^= (unsigned char)(1u << i % 8);
    }
    CHECK_EQUAL(taken, 0);
    m.bytes[m.size / 2] ^= 1;
    CHECK_EQUAL(read_all(m.bytes, m.size, &sum), CHUNK_DAMAGED);
    block_free(m.bytes);
}

static void more_after_the_end_is_refused(void) {
    chunk_memory m = written();
    uint64_t sum;
    unsigned char *longer = malloc(m.size + 1);
    memcpy(longer, m.bytes, m.size);
    longer[m.size] = 0;
    CHECK_EQUAL(read_all(longer, m.size + 1, &sum), CHUNK_DAMAGED);
    free(longer);
    block_free(m.bytes);
}

static void another_kind_and_another_version_are_told_apart(void) {
    chunk_memory m = written();
    chunk_reader r = { .read = chunk_memory_read, .user = &m };
    CHECK(!chunk_read_begin(&r, "hemirows", VERSION));
    CHECK_EQUAL(r.fault, CHUNK_OTHER_KIND);
    m.used = 0;
    CHECK(!chunk_read_begin(&r, MAGIC, VERSION + 1));
    CHECK_EQUAL(r.fault, CHUNK_OTHER_VERSION);
    CHECK_EQUAL(r.version, VERSION);
    block_free(m.bytes);
}

/* Allocators count what was asked for at once. */
static size_t largest;

static void *count_alloc(void *user, size_t bytes) {
    (void)user;
    if (bytes > largest) largest = bytes;
    return malloc(bytes);
}

static void *count_realloc(void *user, void *block, size_t bytes) {
    (void)user;
    if (bytes > largest) largest = bytes;
    return realloc(block, bytes);
}

static void count_free(void *user, void *block) {
    (void)user;
    free(block);
}

static void a_size_that_lies_costs_no_memory(void) {
    static const uint64_t sizes[] = { UINT64_C(1) << 40, UINT64_MAX, UINT64_MAX - 7, SIZE_MAX / 2 };
    chunk_memory m = written();
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        allocator counted = { .alloc = count_alloc, .realloc = count_realloc, .free = count_free };
        chunk_memory lying = { .bytes = m.bytes, .size = m.size };
        chunk_reader r = { .read = chunk_memory_read, .user = &lying, .memory = &counted };
        void *block;
        size_t count;
        memcpy(m.bytes + 16 + 8, &sizes[i], sizeof sizes[i]);
        largest = 0;
        CHECK(chunk_read_begin(&r, MAGIC, VERSION));
        CHECK(!chunk_read_block(&r, "size", 1, &block, &count));
        CHECK(block == NULL && count == 0);
        CHECK(largest < (size_t)2 << 20);
    }
    block_free(m.bytes);
}

static void a_large_array_arrives_in_parts(void) {
    enum { MANY = (5 << 20) + 3 };
    unsigned char *large = malloc(MANY);
    chunk_memory m = { 0 };
    chunk_writer w = { .write = chunk_memory_write, .user = &m };
    for (size_t i = 0; i < MANY; i++) large[i] = (unsigned char)(i * 2654435761u >> 24);
    chunk_write_begin(&w, MAGIC, VERSION);
    chunk_write(&w, "many", large, MANY);
    CHECK(chunk_write_end(&w));
    m.size = m.used, m.used = 0;
    chunk_reader r = { .read = chunk_memory_read, .user = &m };
    void *block = NULL;
    size_t count = 0;
    CHECK(chunk_read_begin(&r, MAGIC, VERSION) && chunk_read_block(&r, "many", 1, &block, &count));
    CHECK(chunk_read_end(&r));
    CHECK_EQUAL(count, MANY);
    CHECK(block && memcmp(block, large, MANY) == 0);
    block_free_all(block, m.bytes);
    free(large);
}

static bool full(void *user, const void *bytes, size_t size) {
    size_t *room = user;
    (void)bytes;
    if (size > *room) return false;
    *room -= size;
    return true;
}

static void a_full_disk_is_said(void) {
    size_t refused = 0, bytes = 0;
    for (size_t room = 0; room < 120; room++) {
        size_t left = room;
        chunk_writer w = { .write = full, .user = &left };
        chunk_write_begin(&w, MAGIC, VERSION);
        chunk_write(&w, "size", &bytes, sizeof bytes);
        refused += !chunk_write_end(&w);
    }
    CHECK_EQUAL(refused, 16 + 16 + 8 + 8 + 16 + 8); /* one for each byte there is too little of */
}

int main(void) {
    RUN(arrays_come_back);
    RUN(every_beginning_is_refused);
    RUN(every_flipped_bit_is_refused);
    RUN(more_after_the_end_is_refused);
    RUN(another_kind_and_another_version_are_told_apart);
    RUN(a_size_that_lies_costs_no_memory);
    RUN(a_large_array_arrives_in_parts);
    RUN(a_full_disk_is_said);
    return check_end();
}
