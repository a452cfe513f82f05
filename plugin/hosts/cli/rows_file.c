/* SPDX-License-Identifier: MIT */
#include "rows_file.h"

#include "file_read.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Fewer bytes than were asked for are the end of the file, or an error, which is no end that rows have. */
static size_t read_bytes(void *user, void *bytes, size_t size) {
    const rows_file *f = user;
    size_t taken = 0;
    while (taken < size) {
        ssize_t got = read(f->descriptor, (uint8_t *)bytes + taken, size - taken);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        taken += (size_t)got;
    }
    return taken;
}

static bool write_bytes(void *user, const void *bytes, size_t size) {
    rows_file *f = user;
    if (size > f->size - f->used) {
        size_t room = 2 * f->size > f->used + size ? 2 * f->size : f->used + size;
        uint8_t *larger = realloc(f->bytes, room);
        if (!larger) return false;
        f->bytes = larger, f->size = room;
    }
    if (size > 0) memcpy(f->bytes + f->used, bytes, size);
    f->used += size;
    return true;
}

int rows_file_open(rows_file *f, const options *o, console *c) {
    char reason[FILE_MESSAGE_SIZE];
    const char *file = c->file;
    *f = (rows_file){ .path = o->rows, .descriptor = -1 };
    if (!f->path) return EXIT_DONE;
    if (o->is_one_of_many || o->input_count > 1) {
        console_error(c, "--rows is for one input, whose geometry its file is of");
        return EXIT_USAGE;
    }
    f->is_there = access(f->path, F_OK) == 0;
    if (!f->is_there) return EXIT_DONE;
    c->file = f->path;
    if (!file_is_plain(f->path, o->root, reason)) return console_error(c, "--rows: %s", reason);
    f->descriptor = open(f->path, O_RDONLY | O_CLOEXEC);
    if (f->descriptor < 0) return console_error(c, "--rows: %s", strerror(errno));
    c->file = file;
    return EXIT_DONE;
}

void rows_file_ask(rows_file *f, hemi_bake_desc *desc) {
    if (!f->path) return;
    desc->rows_name = f->path, desc->rows_user = f;
    if (f->is_there)
        desc->rows_read = read_bytes;
    else
        desc->rows_write = write_bytes;
}

void rows_file_close(rows_file *f) {
    if (f->path && f->descriptor >= 0) close(f->descriptor);
    free(f->bytes);
    *f = (rows_file){ .descriptor = -1 };
}
