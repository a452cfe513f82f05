/* SPDX-License-Identifier: MIT */
#include "file_read.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { LINK_SIZE = 64, FIRST_ROOM = 1 << 16, TICK_MS = 20, STAT_BLOCK = 512 };

/* How long a FIFO is given to find a writer: a shell starts both ends at about the same time. */
static const double WRITER_S = 2.0;

/* A file of this size of which less than this share is stored is a hole: an interrupted copy, or a trap for memory. */
static const uint64_t HOLE_SIZE = UINT64_C(1) << 26;
static const uint64_t HOLE_SHARE = 8;

static hemi_result fail(hemi_result result, char *message, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, FILE_MESSAGE_SIZE, format, arguments);
    va_end(arguments);
    return result;
}

/* ---- opening ----------------------------------------------------------------------------------------------------- */

static bool is_below(const char *path, const char *folder) {
    size_t length = strlen(folder);
    if (length > 0 && folder[length - 1] == '/') length--; /* the root of all */
    return strncmp(path, folder, length) == 0 && (path[length] == '/' || !path[length]);
}

/* Where what is open lies, as the kernel knows it. */
static bool is_open_within(int descriptor, const char *root) {
    char link[LINK_SIZE], path[PATH_MAX], *folder = realpath(root, NULL);
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    ssize_t length = folder ? readlink(link, path, sizeof path - 1) : -1;
    if (length > 0) path[length] = 0;
    bool within = length > 0 && is_below(path, folder);
    free(folder);
    return within;
}

/* What is found is looked at before it is opened: a device may act on that. *found is to be closed; -1: nothing. */
static hemi_result find(const char *path, const char *root, int *found, struct stat *status, char *message) {
    *found = open(path, O_PATH | O_CLOEXEC);
    if (*found < 0) return fail(HEMI_ERROR_FILE, message, "cannot be opened: %s; check the path", strerror(errno));
    if (fstat(*found, status) != 0) return fail(HEMI_ERROR_FILE, message, "cannot be opened: %s", strerror(errno));
    if (root && !is_open_within(*found, root))
        return fail(HEMI_ERROR_FILE, message, "it lies outside of the folder that --root allows");
    if (S_ISDIR(status->st_mode))
        return fail(HEMI_ERROR_FILE, message, "cannot be opened: it is a folder; check the path");
    if (!S_ISREG(status->st_mode) && !S_ISFIFO(status->st_mode))
        return fail(HEMI_ERROR_FILE, message, "cannot be opened: it is neither a file nor a FIFO");
    return HEMI_OK;
}

bool file_is_plain(const char *path, const char *root, char message[FILE_MESSAGE_SIZE]) {
    struct stat status;
    int found;
    message[0] = 0;
    hemi_result result = find(path, root, &found, &status, message);
    if (result == HEMI_OK && !S_ISREG(status.st_mode))
        result = fail(HEMI_ERROR_FILE, message, "it is a FIFO, which cannot be read here; give a file");
    if (found >= 0) close(found);
    return result == HEMI_OK;
}

static hemi_result open_checked(const char *path, const char *root, int *out, struct stat *status, char *message) {
    char link[LINK_SIZE];
    int found;
    hemi_result result = find(path, root, &found, status, message);
    *out = -1;
    snprintf(link, sizeof link, "/proc/self/fd/%d", found);
    /* Without /proc there is no root either, and the path is all that is known. */
    if (result == HEMI_OK)
        *out = open(access(link, F_OK) == 0 ? link : path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (result == HEMI_OK && *out < 0)
        result = fail(HEMI_ERROR_FILE, message, "cannot be opened: %s; check its permissions", strerror(errno));
    if (found >= 0) close(found);
    return result;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Up to size bytes; 0: the end, or before the first byte of a FIFO that has no writer yet. Waits for one that is slow.
 */
static ssize_t read_some(int descriptor, uint8_t *to, size_t size) {
    for (;;) {
        ssize_t got = read(descriptor, to, size);
        if (got >= 0 || (errno != EINTR && errno != EAGAIN)) return got;
        struct pollfd pipe = { .fd = descriptor, .events = POLLIN };
        if (errno == EAGAIN) poll(&pipe, 1, -1);
    }
}

static hemi_result read_regular(int descriptor, uint64_t length, file_room_fn room, void *user, size_t *size,
                                char *message) {
    uint8_t *to = room(user, (size_t)length);
    if (!to && length > 0)
        return fail(HEMI_ERROR_MEMORY, message, "out of memory for its %llu bytes", (unsigned long long)length);
    for (*size = 0; *size < length;) {
        ssize_t got = read_some(descriptor, to + *size, (size_t)length - *size);
        if (got < 0) return fail(HEMI_ERROR_FILE, message, "cannot be read: %s", strerror(errno));
        if (got == 0) return fail(HEMI_ERROR_FILE, message, "cannot be read to its end: it has become shorter");
        *size += (size_t)got;
    }
    return HEMI_OK;
}

static hemi_result read_fifo(int descriptor, uint64_t most, file_room_fn room, void *user, size_t *size,
                             char *message) {
    const struct timespec tick = { .tv_nsec = TICK_MS * 1000000L };
    double begin = seconds();
    uint8_t *to = NULL;
    *size = 0;
    for (size_t capacity = 0;;) {
        if (*size == capacity) to = room(user, capacity = capacity ? 2 * capacity : FIRST_ROOM);
        if (!to) return fail(HEMI_ERROR_MEMORY, message, "out of memory");
        ssize_t got = read_some(descriptor, to + *size, capacity - *size);
        if (got < 0) return fail(HEMI_ERROR_FILE, message, "cannot be read: %s", strerror(errno));
        *size += (size_t)got;
        if (*size > most)
            return fail(HEMI_ERROR_LIMIT, message, "it is longer than %llu bytes", (unsigned long long)most);
        if (got > 0) continue;
        if (*size > 0) break;
        if (seconds() - begin > WRITER_S) return fail(HEMI_ERROR_FILE, message, "it is a FIFO that nobody writes to");
        nanosleep(&tick, NULL);
    }
    return room(user, *size) ? HEMI_OK : fail(HEMI_ERROR_MEMORY, message, "out of memory");
}

hemi_result file_read(const char *path, const char *root, uint64_t most, file_room_fn room, void *user, size_t *size,
                      char message[FILE_MESSAGE_SIZE]) {
    struct stat status;
    int descriptor;
    message[0] = 0;
    hemi_result result = open_checked(path, root, &descriptor, &status, message);
    if (result != HEMI_OK) return result;
    uint64_t length = (uint64_t)status.st_size, stored = (uint64_t)status.st_blocks * STAT_BLOCK;
    if (S_ISFIFO(status.st_mode))
        result = read_fifo(descriptor, most, room, user, size, message);
    else if (length > most)
        result = fail(HEMI_ERROR_LIMIT, message, "it is longer than %llu bytes", (unsigned long long)most);
    else if (length >= HOLE_SIZE && stored < length / HOLE_SHARE)
        result = fail(HEMI_ERROR_FILE, message, "it is mostly holes: of %llu bytes %llu are stored; copy it again",
                      (unsigned long long)length, (unsigned long long)stored);
    else
        result = read_regular(descriptor, length, room, user, size, message);
    close(descriptor);
    return result;
}

/* One byte more, so that nothing is no NULL. */
static uint8_t *grow(void *user, size_t size) {
    uint8_t **bytes = user, *grown = realloc(*bytes, size + 1);
    if (grown) *bytes = grown;
    return grown;
}

hemi_result file_read_bytes(const char *path, const char *root, uint64_t most, uint8_t **bytes, size_t *size,
                            char message[FILE_MESSAGE_SIZE]) {
    *bytes = NULL;
    hemi_result result = file_read(path, root, most, grow, bytes, size, message);
    if (result == HEMI_OK) return result;
    free(*bytes);
    *bytes = NULL;
    *size = 0;
    return result;
}
