/* SPDX-License-Identifier: MIT
 * See chunk_file.h.
 */
#include "base/chunk_file.h"

#include <string.h>

/* The whole library in this file, so that who links hemibake links no more than before. */
#define XXH_INLINE_ALL
#include <xxhash.h>

enum { MAGIC_SIZE = 8, TAG_SIZE = 4, FIRST_BYTES = 1 << 20 };

static const uint32_t BYTE_ORDER_MARK = 0x01020304;

static const char END[] = "end ";

typedef struct chunk_head {
    char tag[TAG_SIZE];
    uint32_t zero;
    uint64_t size;
} chunk_head;

uint64_t chunk_digest(const void *bytes, size_t size, uint64_t seed) {
    return XXH3_64bits_withSeed(bytes, size, seed);
}

static uint64_t checksum_of(const chunk_head *head, const void *bytes, uint64_t before) {
    return chunk_digest(bytes, (size_t)head->size, chunk_digest(head, sizeof *head, before));
}

/* ---- writing ---- */

static void put(chunk_writer *w, const void *bytes, size_t size) {
    if (!w->failed && size > 0 && !w->write(w->user, bytes, size)) w->failed = true;
}

void chunk_write_begin(chunk_writer *w, const char *magic, uint32_t version) {
    const uint32_t numbers[2] = { version, BYTE_ORDER_MARK };
    w->failed = false;
    w->checksum = chunk_digest(magic, MAGIC_SIZE, version);
    put(w, magic, MAGIC_SIZE);
    put(w, numbers, sizeof numbers);
}

void chunk_write(chunk_writer *w, const char *tag, const void *bytes, size_t size) {
    chunk_head head = { .size = size };
    memcpy(head.tag, tag, TAG_SIZE);
    w->checksum = checksum_of(&head, bytes, w->checksum);
    put(w, &head, sizeof head);
    put(w, bytes, size);
    put(w, &w->checksum, sizeof w->checksum);
}

bool chunk_write_end(chunk_writer *w) {
    chunk_write(w, END, "", 0);
    return !w->failed;
}

/* ---- reading ---- */

static bool fail(chunk_reader *r, chunk_fault fault) {
    if (r->fault == CHUNK_FINE) r->fault = fault;
    return false;
}

static bool get(chunk_reader *r, void *bytes, size_t size) {
    return (r->fault == CHUNK_FINE && r->read(r->user, bytes, size) == size) || fail(r, CHUNK_TRUNCATED);
}

bool chunk_read_begin(chunk_reader *r, const char *magic, uint32_t version) {
    char found[MAGIC_SIZE];
    uint32_t numbers[2];
    r->fault = CHUNK_FINE;
    r->checksum = chunk_digest(magic, MAGIC_SIZE, version);
    if (r->read(r->user, found, MAGIC_SIZE) != MAGIC_SIZE || memcmp(found, magic, MAGIC_SIZE) != 0)
        return fail(r, CHUNK_OTHER_KIND);
    if (!get(r, numbers, sizeof numbers)) return false;
    if (numbers[1] != BYTE_ORDER_MARK) return fail(r, CHUNK_OTHER_KIND);
    r->version = numbers[0];
    return r->version == version || fail(r, CHUNK_OTHER_VERSION);
}

/* A chunk with the tag begins here. */
static bool read_head(chunk_reader *r, const char *tag, chunk_head *head) {
    if (!get(r, head, sizeof *head)) return false;
    return (memcmp(head->tag, tag, TAG_SIZE) == 0 && head->zero == 0) || fail(r, CHUNK_UNEXPECTED);
}

static bool check(chunk_reader *r, const chunk_head *head, const void *bytes) {
    uint64_t found, expected = checksum_of(head, bytes, r->checksum);
    if (!get(r, &found, sizeof found)) return false;
    r->checksum = expected;
    return found == expected || fail(r, CHUNK_DAMAGED);
}

bool chunk_read_into(chunk_reader *r, const char *tag, void *bytes, size_t size) {
    chunk_head head;
    if (!read_head(r, tag, &head)) return false;
    if (head.size != size) return fail(r, CHUNK_UNEXPECTED);
    return get(r, bytes, size) && check(r, &head, bytes);
}

/* size bytes in a block that grows as they arrive; NULL where there are not so many, or no memory. */
static unsigned char *read_growing(chunk_reader *r, uint64_t size) {
    size_t room = size < FIRST_BYTES ? (size_t)size : FIRST_BYTES, used = 0;
    unsigned char *bytes = block_new(r->memory, room + 1);
    while (bytes && get(r, bytes + used, room - used) && room < size) {
        used = room;
        room = room > size / 2 ? (size_t)size : 2 * room;
        unsigned char *larger = block_resize(r->memory, bytes, room + 1);
        if (!larger) fail(r, CHUNK_NO_MEMORY);
        if (larger) bytes = larger;
    }
    if (!bytes) fail(r, CHUNK_NO_MEMORY);
    if (r->fault == CHUNK_FINE) return bytes;
    block_free(bytes);
    return NULL;
}

bool chunk_read_block(chunk_reader *r, const char *tag, size_t unit, void **block, size_t *count) {
    chunk_head head;
    *block = NULL, *count = 0;
    if (!read_head(r, tag, &head)) return false;
    if (head.size > SIZE_MAX / 2 || head.size % unit != 0) return fail(r, CHUNK_UNEXPECTED);
    unsigned char *bytes = read_growing(r, head.size);
    if (!bytes || !check(r, &head, bytes)) return block_free(bytes), false;
    *block = bytes, *count = (size_t)head.size / unit;
    return true;
}

bool chunk_read_end(chunk_reader *r) {
    char more;
    if (!chunk_read_into(r, END, &more, 0)) return false;
    return r->read(r->user, &more, 1) == 0 || fail(r, CHUNK_DAMAGED);
}

const char *chunk_fault_text(chunk_fault fault) {
    static const char *const texts[] = { [CHUNK_FINE] = "is whole",
                                         [CHUNK_OTHER_KIND] = "is not of this kind, or from a machine of another kind",
                                         [CHUNK_OTHER_VERSION] = "was written by another version",
                                         [CHUNK_TRUNCATED] = "ends too early",
                                         [CHUNK_DAMAGED] = "is damaged",
                                         [CHUNK_UNEXPECTED] = "holds something else than is expected",
                                         [CHUNK_NO_MEMORY] = "does not fit into memory" };
    return texts[fault];
}

/* ---- memory ---- */

bool chunk_memory_write(void *user, const void *bytes, size_t size) {
    chunk_memory *m = user;
    if (size > SIZE_MAX / 2 - m->used) return false;
    size_t needed = m->used + size;
    if (needed > m->size &&
        !block_reserve(m->memory, (void **)&m->bytes, &m->size, needed < 2 * m->size ? 2 * m->size : needed, 1))
        return false;
    if (size > 0) memcpy(m->bytes + m->used, bytes, size);
    m->used += size;
    return true;
}

size_t chunk_memory_read(void *user, void *bytes, size_t size) {
    chunk_memory *m = user;
    size_t left = m->size - m->used, taken = size < left ? size : left;
    if (taken > 0) memcpy(bytes, m->bytes + m->used, taken);
    m->used += taken;
    return taken;
}
