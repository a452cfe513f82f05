/* SPDX-License-Identifier: MIT */
#include "temporary_file.h"

#include "signals.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#define PREFIX ".hemibake-"
#define SUFFIX ".part"
enum { DIGITS = 16, LINK_SIZE = 64, TRIES_MAX = 100 };

/* ---- names ---- */

/* A name that nobody else makes, from malloc. NULL: errno. */
static char *new_name(const char *folder) {
    uint64_t number;
    char *name;
    if (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number) return NULL;
    if (asprintf(&name, "%s/" PREFIX "%016llx" SUFFIX, folder, (unsigned long long)number) >= 0) return name;
    errno = ENOMEM;
    return NULL;
}

static bool is_such_name(const char *name) {
    const size_t prefix = strlen(PREFIX);
    return strlen(name) == prefix + DIGITS + strlen(SUFFIX) && strncmp(name, PREFIX, prefix) == 0 &&
           strspn(name + prefix, "0123456789abcdef") == DIGITS && strcmp(name + prefix + DIGITS, SUFFIX) == 0;
}

static void set_name(temporary_file *f, char *name) {
    f->name = name;
    signals_guard(name);
}

static void forget_name(temporary_file *f) {
    signals_unguard(f->name);
    free(f->name);
    f->name = NULL;
}

/* ---- opening ---- */

/* What linkat takes for a file without a name. False: there is no /proc, and such a file would never get one. */
static bool link_of(int descriptor, char text[LINK_SIZE]) {
    snprintf(text, LINK_SIZE, "/proc/self/fd/%d", descriptor);
    return access(text, F_OK) == 0;
}

static bool open_unnamed(temporary_file *f, const char *folder, mode_t mode) {
    char link[LINK_SIZE];
    f->descriptor = open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
    if (f->descriptor < 0) return false;
    if (link_of(f->descriptor, link)) {
        flock(f->descriptor,
              LOCK_EX | LOCK_NB); /* Nobody sweeps it once it has a name; where locks fail, nobody sweeps. */
        return true;
    }
    close(f->descriptor);
    f->descriptor = -1;
    return false;
}

/* A sweeper may come between a file's making and its lock; then the file has no name any more. */
static bool is_swept(int descriptor) {
    struct stat status;
    return fstat(descriptor, &status) == 0 && status.st_nlink == 0;
}

static bool open_named(temporary_file *f, const char *folder, mode_t mode) {
    for (int i = 0; i < TRIES_MAX; i++) {
        char *name = new_name(folder);
        if (!name) return false;
        set_name(f, name);
        f->descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode);
        if (f->descriptor >= 0) {
            flock(f->descriptor, LOCK_EX | LOCK_NB);
            if (!is_swept(f->descriptor)) return true;
            close(f->descriptor);
            f->descriptor = -1;
        }
        forget_name(f);
        if (errno != EEXIST) return false;
    }
    return false;
}

bool temporary_file_open(temporary_file *f, const char *folder, mode_t mode) {
    *f = (temporary_file){ .descriptor = -1 };
    /* Whatever a file system says to what it does not know: the second way finds out what is really wrong. */
    return open_unnamed(f, folder, mode) || open_named(f, folder, mode);
}

/* ---- ending ---- */

bool temporary_file_name(temporary_file *f, const char *folder) {
    char link[LINK_SIZE];
    for (int i = 0; !f->name && i < TRIES_MAX; i++) {
        char *name = new_name(folder);
        if (!name || !link_of(f->descriptor, link)) {
            free(name);
            return false;
        }
        set_name(f, name);
        if (linkat(AT_FDCWD, link, AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0) return true;
        forget_name(f);
        if (errno != EEXIST) return false;
    }
    return f->name != NULL;
}

bool temporary_file_rename(temporary_file *f, const char *path) {
    if (rename(f->name, path) != 0) return false;
    forget_name(f);
    temporary_file_discard(f);
    return true;
}

void temporary_file_discard(temporary_file *f) {
    if (f->name) {
        unlink(f->name);
        forget_name(f);
    }
    if (f->descriptor >= 0) close(f->descriptor);
    f->descriptor = -1;
}

/* ---- those of others ---- */

static void remove_if_free(int folder, const char *name) {
    struct stat opened, there;
    int descriptor = openat(folder, name, O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) return;
    /* Another sweeper may have been here: the name is removed only if it is still this file's. */
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && fstat(descriptor, &opened) == 0 &&
        fstatat(folder, name, &there, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(there.st_mode) &&
        opened.st_dev == there.st_dev && opened.st_ino == there.st_ino)
        unlinkat(folder, name, 0);
    close(descriptor);
}

void temporary_files_sweep(const char *folder) {
    DIR *list = opendir(folder);
    if (!list) return;
    for (const struct dirent *entry; (entry = readdir(list));)
        if (is_such_name(entry->d_name)) remove_if_free(dirfd(list), entry->d_name);
    closedir(list);
}
