/* SPDX-License-Identifier: MIT */
#include "output_file.h"

#include "signals.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

/* What permissions are; a program's right to act as its owner is no matter of data. */
static const mode_t PERMISSIONS = 0777;

bool output_file_open(output_file *f, const char *path, const char **reason) {
    *f = OUTPUT_FILE_NONE;
    f->path = path;
    if (!path) return true;
    if (!output_place_find(path, &f->place, reason)) return false;
    if (!f->place.is_special) temporary_files_sweep(f->place.folder);
    return true;
}

/* ---- writing ---- */

static bool write_all(int descriptor, const char *bytes, size_t size) {
    while (size > 0) {
        ssize_t written = write(descriptor, bytes, size);
        if (written < 0 && errno == EINTR && !signals_interrupted) continue;
        if (written <= 0) return false;
        bytes += written;
        size -= (size_t)written;
    }
    return true;
}

/* A FIFO waits for its reader, as for any program that writes there; Ctrl-C ends that. */
static bool write_in_place(const output_place *place, const void *bytes, size_t size) {
    int descriptor = place->own_descriptor >= 0 ? fcntl(place->own_descriptor, F_DUPFD_CLOEXEC, 0)
                                                : open(place->path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor < 0) return false;
    bool ok = write_all(descriptor, bytes, size);
    int error = errno;
    bool closed = close(descriptor) == 0;
    if (!ok) errno = error;
    return ok && closed;
}

/* The new file is allowed to whom the old one was; until then to its owner alone. */
static void keep_mode(int descriptor, const struct stat *old) {
    /* Only root may give a file away; for others it is theirs, as after any rename. */
    if (fchown(descriptor, old->st_uid, old->st_gid) != 0) errno = 0;
    fchmod(descriptor, old->st_mode & PERMISSIONS);
}

static bool write_beside(output_file *f, const void *bytes, size_t size) {
    if (!temporary_file_open(&f->temporary, f->place.folder, f->place.exists ? 0600 : 0666)) return false;
    if (f->place.exists) keep_mode(f->temporary.descriptor, &f->place.status);
    return write_all(f->temporary.descriptor, bytes, size) && fsync(f->temporary.descriptor) == 0;
}

bool output_file_write(output_file *f, const void *bytes, size_t size, const char **reason) {
    if (!f->path) return true;
    if (f->place.is_special ? write_in_place(&f->place, bytes, size) : write_beside(f, bytes, size)) return true;
    *reason = strerror(errno);
    output_file_discard(f);
    return false;
}

/* ---- appearing ---- */

bool output_files_commit(output_file *const *files, size_t count, const char **path, const char **reason) {
    bool ok = true;
    signals_hold();
    for (int renames = 0; renames < 2; renames++)
        for (size_t i = 0; ok && i < count; i++) {
            output_file *f = files[i];
            if (f->temporary.descriptor < 0) continue;
            ok = renames ? temporary_file_rename(&f->temporary, f->place.path)
                         : temporary_file_name(&f->temporary, f->place.folder);
            if (!ok) *path = f->path, *reason = strerror(errno);
        }
    for (size_t i = 0; i < count; i++) output_file_discard(files[i]);
    if (!ok) signals_release();
    return ok;
}

bool output_file_save(const char *path, const void *bytes, size_t size, const char **reason) {
    output_file file, *const files[] = { &file };
    bool ok = output_file_open(&file, path, reason) && output_file_write(&file, bytes, size, reason) &&
              output_files_commit(files, 1, &path, reason);
    output_file_discard(&file);
    return ok;
}

void output_file_discard(output_file *f) {
    temporary_file_discard(&f->temporary);
    output_place_free(&f->place);
    *f = OUTPUT_FILE_NONE;
}
