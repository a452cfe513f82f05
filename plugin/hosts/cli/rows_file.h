/* SPDX-License-Identifier: MIT
 * Where do the rows of --rows come from, or go? From its file if that is there, into it if not.
 */
#ifndef HEMIBAKE_CLI_ROWS_FILE_H
#define HEMIBAKE_CLI_ROWS_FILE_H

#include "console.h"

typedef struct rows_file {
    const char *path; /* NULL: there is none */
    bool is_there;
    int descriptor;    /* that is read from as a bake asks; below 0: none */
    uint8_t *bytes;    /* that were written */
    size_t size, used; /* size: there is room for so many */
} rows_file;

/* Looks whether the file is there, and opens it. EXIT_DONE, or an exit status with its line printed. */
int rows_file_open(rows_file *f, const options *o, console *c);

/* What hemi_bake is to do with it. */
void rows_file_ask(rows_file *f, hemi_bake_desc *desc);

void rows_file_close(rows_file *f);

#endif
