/* SPDX-License-Identifier: MIT
 * Where do the rows of --rows come from, or go? From its file if that is there, into it if not.
 */
#ifndef HEMIBAKE_CLI_ROWS_FILE_H
#define HEMIBAKE_CLI_ROWS_FILE_H

#include "console.h"

typedef struct rows_file {
    const char *path; /* NULL: there is none */
    bool is_there;
    uint8_t *bytes;    /* that are read, or were written */
    size_t size, used; /* used: of what is read; size: of what was written, there is room for so many */
} rows_file;

/* Looks whether the file is there, and reads it. EXIT_DONE, or an exit status with its line printed. */
int rows_file_open(rows_file *f, const options *o, console *c);

/* What hemi_bake is to do with it. */
void rows_file_ask(rows_file *f, hemi_bake_desc *desc);

void rows_file_close(rows_file *f);

#endif
