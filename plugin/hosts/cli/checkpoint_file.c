/* SPDX-License-Identifier: MIT */
#include "checkpoint_file.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

static const char MAGIC[8] = "hbckpt1\n";

enum { TEXT_MAX = 1 << 20, SLOTS_MIN = 1024, PIECE = 1 << 20 };

typedef struct record_head {
    uint64_t key[2], size, checksum;
} record_head;

/* Where a result is; offset 0: nowhere. */
typedef struct slot {
    uint64_t key[2], offset, size;
} slot;

struct checkpoint_file {
    int descriptor;
    uint64_t end, limit;
    const char *failure; /* nothing is added any more */
    pthread_mutex_t mutex;
    slot *slots; /* a hash table by open addressing */
    size_t slot_count, used;
};

/* ---- bytes ---- */

static bool read_at(int descriptor, void *bytes, size_t size, uint64_t offset) {
    for (char *to = bytes; size > 0;) {
        ssize_t got = pread(descriptor, to, size, (off_t)offset);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        to += got, offset += (uint64_t)got, size -= (size_t)got;
    }
    return true;
}

/* All of the parts at the end of the file, by one call where the system lets it. */
static bool append(int descriptor, struct iovec *parts, int count) {
    while (count > 0) {
        ssize_t put = writev(descriptor, parts, count);
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return false;
        for (; count > 0 && (size_t)put >= parts->iov_len; parts++, count--) put -= (ssize_t)parts->iov_len;
        if (count > 0) parts->iov_base = (char *)parts->iov_base + put, parts->iov_len -= (size_t)put;
    }
    return true;
}

static uint64_t checksum_of_head(const record_head *h) {
    return XXH3_64bits_withSeed(h, sizeof *h - sizeof h->checksum, 0);
}

/* ---- the table ---- */

static slot *find_slot(slot *slots, size_t count, const uint64_t key[2]) {
    size_t i = (size_t)XXH3_64bits_withSeed(key, 2 * sizeof *key, 0) & (count - 1);
    while (slots[i].offset > 0 && (slots[i].key[0] != key[0] || slots[i].key[1] != key[1])) i = (i + 1) & (count - 1);
    return &slots[i];
}

/* False when out of memory; what is not in the table is not found, and worked out again. */
static bool remember(checkpoint_file *f, const slot *new) {
    if (2 * (f->used + 1) > f->slot_count) {
        size_t count = f->slot_count ? 2 * f->slot_count : SLOTS_MIN;
        slot *slots = calloc(count, sizeof *slots);
        if (!slots) return false;
        for (size_t i = 0; i < f->slot_count; i++)
            if (f->slots[i].offset > 0) *find_slot(slots, count, f->slots[i].key) = f->slots[i];
        free(f->slots);
        f->slots = slots, f->slot_count = count;
    }
    slot *at = find_slot(f->slots, f->slot_count, new->key);
    f->used += at->offset == 0;
    *at = *new;
    return true;
}

/* ---- opening ---- */

static checkpoint_file *create(int descriptor) {
    checkpoint_file *f = calloc(1, sizeof *f);
    if (!f) return NULL;
    f->descriptor = descriptor, f->limit = UINT64_MAX;
    pthread_mutex_init(&f->mutex, NULL);
    return f;
}

bool checkpoint_file_is_one(int descriptor) {
    char found[sizeof MAGIC];
    return lseek(descriptor, 0, SEEK_END) == 0 ||
           (read_at(descriptor, found, sizeof found, 0) && memcmp(found, MAGIC, sizeof MAGIC) == 0);
}

checkpoint_file *checkpoint_file_begin(int descriptor, const char *text, size_t size) {
    uint64_t length = size, checksum = XXH3_64bits_withSeed(text, size, length);
    struct iovec parts[] = { { (void *)(uintptr_t)MAGIC, sizeof MAGIC },
                             { &length, sizeof length },
                             { (void *)(uintptr_t)text, size },
                             { &checksum, sizeof checksum } };
    if (ftruncate(descriptor, 0) != 0 || lseek(descriptor, 0, SEEK_SET) != 0) return NULL;
    if (!append(descriptor, parts, 4)) return NULL;
    checkpoint_file *f = create(descriptor);
    if (f) f->end = sizeof MAGIC + sizeof length + size + sizeof checksum;
    return f;
}

/* What the file says that it is of; NULL: reason. */
static char *read_text(int descriptor, uint64_t file_size, size_t *size, char *reason) {
    char found[sizeof MAGIC];
    uint64_t length = 0, checksum = 0, at = sizeof found;
    if (!read_at(descriptor, found, sizeof found, 0) || memcmp(found, MAGIC, sizeof MAGIC) != 0) {
        snprintf(reason, CHECKPOINT_REASON_SIZE, "is no checkpoint of hemibake");
        return NULL;
    }
    bool ok = read_at(descriptor, &length, sizeof length, at) && length <= TEXT_MAX && length <= file_size;
    char *text = ok ? malloc((size_t)length + 1) : NULL;
    at += sizeof length;
    if (text && read_at(descriptor, text, (size_t)length, at) &&
        read_at(descriptor, &checksum, sizeof checksum, at + length) &&
        checksum == XXH3_64bits_withSeed(text, (size_t)length, length)) {
        *size = (size_t)length;
        return text;
    }
    free(text);
    snprintf(reason, CHECKPOINT_REASON_SIZE, "is damaged at its beginning; leave out --resume to begin anew");
    return NULL;
}

typedef enum record_state { RECORD_WHOLE, RECORD_TORN, RECORD_DAMAGED, RECORD_NO_MEMORY } record_state;

static record_state check_record(checkpoint_file *f, const record_head *h, uint64_t file_size, uint64_t offset) {
    uint64_t checksum;
    if (h->checksum != checksum_of_head(h)) return RECORD_DAMAGED;
    if (h->size > file_size - offset || file_size - offset - h->size < sizeof checksum) return RECORD_TORN;
    unsigned char *bytes = malloc((size_t)h->size + 1);
    if (!bytes) return RECORD_NO_MEMORY;
    bool is_read = read_at(f->descriptor, bytes, (size_t)h->size, offset) &&
                   read_at(f->descriptor, &checksum, sizeof checksum, offset + h->size);
    bool is_whole = is_read && checksum == XXH3_64bits_withSeed(bytes, (size_t)h->size, h->checksum);
    free(bytes);
    return is_whole ? RECORD_WHOLE : RECORD_DAMAGED;
}

/* The records of a file up to its end, or to one that was not written to its end. */
static record_state read_records(checkpoint_file *f, uint64_t file_size) {
    record_head h;
    for (;;) {
        if (file_size - f->end < sizeof h) return file_size == f->end ? RECORD_WHOLE : RECORD_TORN;
        if (!read_at(f->descriptor, &h, sizeof h, f->end)) return RECORD_DAMAGED;
        record_state state = check_record(f, &h, file_size, f->end + sizeof h);
        if (state != RECORD_WHOLE) return state;
        if (!remember(f, &(slot){ { h.key[0], h.key[1] }, f->end + sizeof h, h.size })) return RECORD_NO_MEMORY;
        f->end += sizeof h + h.size + sizeof h.checksum;
    }
}

checkpoint_file *checkpoint_file_read(int descriptor, char **text, size_t *size, char reason[CHECKPOINT_REASON_SIZE]) {
    off_t file_size = lseek(descriptor, 0, SEEK_END);
    *text = file_size < 0 ? NULL : read_text(descriptor, (uint64_t)file_size, size, reason);
    if (!*text) return NULL;
    checkpoint_file *f = create(descriptor);
    record_state state = RECORD_NO_MEMORY;
    if (f) {
        f->end = sizeof MAGIC + sizeof(uint64_t) + *size + sizeof(uint64_t);
        state = read_records(f, (uint64_t)file_size);
    }
    if (state == RECORD_DAMAGED)
        snprintf(reason, CHECKPOINT_REASON_SIZE, "is damaged at byte %llu; leave out --resume to begin anew",
                 (unsigned long long)f->end);
    else if (state == RECORD_NO_MEMORY)
        snprintf(reason, CHECKPOINT_REASON_SIZE, "out of memory while it is read");
    else if (ftruncate(descriptor, (off_t)f->end) == 0 && lseek(descriptor, (off_t)f->end, SEEK_SET) >= 0)
        return f;
    else
        snprintf(reason, CHECKPOINT_REASON_SIZE, "cannot be gone on with: %s", strerror(errno));
    if (f) f->descriptor = -1; /* still the caller's */
    checkpoint_file_close(f);
    return NULL;
}

void checkpoint_file_limit(checkpoint_file *f, uint64_t bytes) {
    f->limit = bytes;
}

const char *checkpoint_file_failure(const checkpoint_file *f) {
    return f->failure;
}

void checkpoint_file_close(checkpoint_file *f) {
    if (!f) return;
    pthread_mutex_destroy(&f->mutex);
    if (f->descriptor >= 0) close(f->descriptor);
    free(f->slots);
    free(f);
}

/* ---- results ---- */

uint64_t checkpoint_file_find(void *user, const uint64_t key[2], void *bytes, uint64_t room) {
    checkpoint_file *f = user;
    slot at = { .size = 0 };
    pthread_mutex_lock(&f->mutex);
    if (f->slot_count > 0) at = *find_slot(f->slots, f->slot_count, key);
    pthread_mutex_unlock(&f->mutex);
    if (at.offset == 0) return 0;
    return at.size > room || read_at(f->descriptor, bytes, (size_t)at.size, at.offset) ? at.size : 0;
}

/* What could not be added leaves nothing behind. */
static void add_locked(checkpoint_file *f, record_head *h, const void *bytes) {
    uint64_t checksum = XXH3_64bits_withSeed(bytes, (size_t)h->size, h->checksum),
             whole = sizeof *h + h->size + sizeof checksum;
    struct iovec parts[] = { { h, sizeof *h },
                             { (void *)(uintptr_t)bytes, (size_t)h->size },
                             { &checksum, sizeof checksum } };
    if (f->slot_count > 0 && find_slot(f->slots, f->slot_count, h->key)->offset > 0) return;
    if (f->limit < whole || f->end > f->limit - whole)
        f->failure = "it is as large as --memory allows";
    else if (append(f->descriptor, parts, 3)) {
        remember(f, &(slot){ { h->key[0], h->key[1] }, f->end + sizeof *h, h->size });
        f->end += whole;
    } else {
        f->failure = strerror(errno);
        if (ftruncate(f->descriptor, (off_t)f->end) != 0) f->end = 0; /* what is torn is dropped when it is read */
    }
}

void checkpoint_file_add(void *user, const uint64_t key[2], const void *bytes, uint64_t size) {
    checkpoint_file *f = user;
    record_head h = { { key[0], key[1] }, size, 0 };
    h.checksum = checksum_of_head(&h);
    pthread_mutex_lock(&f->mutex);
    if (!f->failure) add_locked(f, &h, bytes);
    pthread_mutex_unlock(&f->mutex);
}
