/* SPDX-License-Identifier: MIT */
#include "output_place.h"

#include "path_text.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* As many as the kernel follows. */
enum { LINKS_MAX = 40 };

static char *folder_of(const char *path) {
    const char *slash = strrchr(path, '/');
    if (!slash) return strdup(".");
    return slash == path ? strdup("/") : strndup(path, (size_t)(slash - path));
}

/* ---- open files by their number ---- */

/* A link in /proc is a file that a process has open, whatever its text says. *number: of one of our own, or -1. */
static bool is_open_file(const char *path, int *number) {
    char *folder = folder_of(path), *real = folder ? realpath(folder, NULL) : NULL, own[64], *end;
    bool is_one = real && strncmp(real, "/proc/", 6) == 0;
    snprintf(own, sizeof own, "/proc/%ld/fd", (long)getpid());
    long value = strtol(path_name(path), &end, 10);
    *number = is_one && strcmp(real, own) == 0 && !*end && value <= INT_MAX ? (int)value : -1;
    free(folder);
    free(real);
    return is_one;
}

/* ---- links ---- */

/* What the link at path leads to, from malloc. NULL: errno says why. */
static char *link_target(const char *path) {
    char text[PATH_MAX];
    ssize_t length = readlink(path, text, sizeof text - 1);
    if (length < 0) return NULL;
    text[length] = 0;
    if (*text == '/') return strdup(text);
    char *folder = folder_of(path), *target = folder ? path_format("%s/%s", folder, text) : NULL;
    free(folder);
    return target;
}

/* Follows links until path is none, or is an open file; the last of them need not exist yet. */
static bool follow_links(output_place *place) {
    for (int i = 0; i < LINKS_MAX; i++) {
        struct stat status;
        if (lstat(place->path, &status) != 0) return errno == ENOENT;
        if (!S_ISLNK(status.st_mode)) return true;
        place->is_special = is_open_file(place->path, &place->own_descriptor);
        if (place->is_special) return true;
        char *target = link_target(place->path);
        if (!target) return false;
        free(place->path);
        place->path = target;
    }
    errno = ELOOP;
    return false;
}

/* ---- what is there ---- */

static const char *refusal(output_place *place) {
    mode_t mode = place->status.st_mode;
    if (!place->exists && !*path_name(place->path)) return "it names a folder";
    if (place->exists && S_ISDIR(mode)) return "it is a folder";
    if (place->exists && S_ISSOCK(mode)) return "it is a socket";
    if (place->exists && !S_ISREG(mode)) place->is_special = true;
    /* What is already open was opened by somebody who was allowed to. */
    if (place->own_descriptor >= 0) return fcntl(place->own_descriptor, F_GETFL) < 0 ? strerror(errno) : NULL;
    int wanted = place->is_special ? W_OK : W_OK | X_OK;
    const char *asked = place->is_special ? place->path : place->folder;
    return faccessat(AT_FDCWD, asked, wanted, AT_EACCESS) == 0 ? NULL : strerror(errno);
}

bool output_place_find(const char *path, output_place *out, const char **reason) {
    *out = (output_place){ .path = strdup(path), .own_descriptor = -1 };
    *reason = "out of memory";
    bool ok = out->path != NULL;
    if (ok && !follow_links(out)) ok = false, *reason = strerror(errno);
    if (ok) ok = (out->folder = folder_of(out->path)) != NULL;
    if (ok) {
        out->exists = stat(out->path, &out->status) == 0;
        *reason = !out->exists && errno != ENOENT ? strerror(errno) : refusal(out);
        ok = !*reason;
    }
    if (!ok) output_place_free(out);
    return ok;
}

bool output_place_equal(const output_place *a, const output_place *b) {
    struct stat of_a, of_b;
    if (!a->path || !b->path || a->is_special || b->is_special) return false;
    return strcmp(path_name(a->path), path_name(b->path)) == 0 && stat(a->folder, &of_a) == 0 &&
           stat(b->folder, &of_b) == 0 && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

void output_place_free(output_place *place) {
    free(place->path);
    free(place->folder);
    *place = (output_place){ .own_descriptor = -1 };
}
