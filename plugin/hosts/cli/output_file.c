/* SPDX-License-Identifier: MIT
 * See output_file.h.
 */
#include "output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *reason_of_errno(void) {
    return strerror(errno);
}

bool output_file_open(output_file *f, const char *path, const char **reason) {
    struct stat status;
    *f = (output_file){ .path = path, .descriptor = -1 };
    if (!path) return true;
    if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        *reason = "it is a folder";
        return false;
    }
    size_t size = strlen(path) + 32;
    f->temporary = malloc(size);
    if (!f->temporary) {
        *reason = "out of memory";
        return false;
    }
    snprintf(f->temporary, size, "%s.%ld.part", path, (long)getpid());
    f->descriptor = open(f->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (f->descriptor >= 0) return true;
    *reason = reason_of_errno();
    free(f->temporary);
    f->temporary = NULL;
    return false;
}

static bool write_all(int descriptor, const char *bytes, size_t size) {
    while (size > 0) {
        ssize_t written = write(descriptor, bytes, size);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        bytes += written;
        size -= (size_t)written;
    }
    return true;
}

bool output_file_write(output_file *f, const void *bytes, size_t size, const char **reason) {
    if (!f->path) return true;
    bool ok = write_all(f->descriptor, bytes, size) && fsync(f->descriptor) == 0;
    ok = close(f->descriptor) == 0 && ok;
    f->descriptor = -1;
    if (ok) return true;
    *reason = reason_of_errno();
    output_file_discard(f);
    return false;
}

bool output_file_commit(output_file *f, const char **reason) {
    if (!f->temporary) return true;
    if (rename(f->temporary, f->path) != 0) {
        *reason = reason_of_errno();
        output_file_discard(f);
        return false;
    }
    free(f->temporary);
    f->temporary = NULL;
    return true;
}

void output_file_discard(output_file *f) {
    if (f->descriptor >= 0) close(f->descriptor);
    f->descriptor = -1;
    if (f->temporary) unlink(f->temporary);
    free(f->temporary);
    f->temporary = NULL;
}
