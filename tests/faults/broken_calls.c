/* SPDX-License-Identifier: MIT
 * Which system calls fail? Those that HEMIBAKE_BROKEN names, in a program that this is preloaded into: "tmpfile" (no files
 * without a name), "link" and "rename" (no space left), "fsync" (input or output error), "lock" (no locks).
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

static bool is_broken(const char *call) {
    const char *list = getenv("HEMIBAKE_BROKEN");
    return list && strstr(list, call);
}

static int broken(int error) {
    errno = error;
    return -1;
}

#define REAL(name) ((__typeof__(name) *)dlsym(RTLD_NEXT, #name))

int open(const char *path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    int mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(arguments, int) : 0;
    va_end(arguments);
    if ((flags & O_TMPFILE) == O_TMPFILE && is_broken("tmpfile")) return broken(EOPNOTSUPP);
    return REAL(open)(path, flags, mode);
}

int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags) {
    return is_broken("link") ? broken(ENOSPC) : REAL(linkat)(from_folder, from, to_folder, to, flags);
}

int rename(const char *from, const char *to) {
    return is_broken("rename") ? broken(ENOSPC) : REAL(rename)(from, to);
}

int fsync(int descriptor) {
    return is_broken("fsync") ? broken(EIO) : REAL(fsync)(descriptor);
}

int flock(int descriptor, int operation) {
    return is_broken("lock") ? broken(ENOLCK) : REAL(flock)(descriptor, operation);
}
