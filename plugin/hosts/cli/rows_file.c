/* SPDX-License-Identifier: MIT */
#include "rows_file.h"

#include "file_read.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const size_t SIZE_MOST = (size_t)1 << 40;

static size_t read_bytes(void *user, void *bytes, size_t size) {
    rows_file *f = user;
    size_t left = f->size - f->used, taken = size < left ? size : left;
    if (taken > 0) memcpy(bytes, f->bytes + f->used, taken);
    f->used += taken;
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
    *f = (rows_file){ .path = o->rows };
    if (!f->path) return EXIT_DONE;
    if (o->is_one_of_many || o->input_count > 1) {
        console_error(c, "--rows is for one input, whose geometry its file is of");
        return EXIT_USAGE;
    }
    f->is_there = access(f->path, F_OK) == 0;
    if (!f->is_there) return EXIT_DONE;
    if (file_read_bytes(f->path, o->root, SIZE_MOST, &f->bytes, &f->size, reason) == HEMI_OK) return EXIT_DONE;
    c->file = f->path;
    console_error(c, "--rows: %s", reason);
    return EXIT_BAD_INPUT;
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
    free(f->bytes);
    *f = (rows_file){ 0 };
}
