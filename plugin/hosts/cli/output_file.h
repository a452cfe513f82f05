/* SPDX-License-Identifier: MIT
 * How does an output appear whole or not at all? Written beside its place, synced, and renamed.
 */
#ifndef HEMIBAKE_CLI_OUTPUT_FILE_H
#define HEMIBAKE_CLI_OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct output_file {
    const char *path; /* NULL: this output was not asked for */
    char *temporary;
    int descriptor;
} output_file;

/* Makes the file beside its place, so that a place that cannot be written is known before any work. path may be NULL.
 * False: *reason says why. */
bool output_file_open(output_file *f, const char *path, const char **reason);

/* Writes and syncs everything under its temporary name, so that several outputs can be whole before any appears. */
bool output_file_write(output_file *f, const void *bytes, size_t size, const char **reason);

/* Renames what was written into its place. */
bool output_file_commit(output_file *f, const char **reason);

/* Removes what was begun and not committed. */
void output_file_discard(output_file *f);

#endif
