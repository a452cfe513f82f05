/* SPDX-License-Identifier: MIT
 * How does an output appear whole or not at all? Written where it has no name yet, synced, and renamed into its place.
 *
 * A file that is replaced keeps its mode, and where that is allowed its owner; links to it are followed. Of a file that
 * has several names (hard links) only the one given becomes the new file. A device, a FIFO or /dev/stdout is written
 * where it is, and cannot be taken back.
 */
#ifndef HEMIBAKE_CLI_OUTPUT_FILE_H
#define HEMIBAKE_CLI_OUTPUT_FILE_H

#include "output_place.h"
#include "temporary_file.h"

#include <stddef.h>

typedef struct output_file {
    const char *path; /* as it was asked for; NULL: it was not */
    output_place place;
    temporary_file temporary;
} output_file;

/* Empty: all that is done to it does nothing. */
#define OUTPUT_FILE_NONE ((output_file){ .place.own_descriptor = -1, .temporary.descriptor = -1 })

/* Looks whether the place can be written, before any work; what killed processes left there goes. Makes nothing. path
 * may be NULL. False: *reason says why. */
bool output_file_open(output_file *f, const char *path, const char **reason);

/* Writes and syncs everything, without its name, so that several outputs can be whole before any appears. */
bool output_file_write(output_file *f, const void *bytes, size_t size, const char **reason);

/* Renames what was written into its place, in this order. All of them get a name beside their places first, so that a
 * folder without room for one leaves all as they were. From here on signals wait (signals.h). False: *path and *reason
 * say which and why. */
bool output_files_commit(output_file *const *files, size_t count, const char **path, const char **reason);

/* One output that stands alone: opens, writes and commits it. False: *reason says why. */
bool output_file_save(const char *path, const void *bytes, size_t size, const char **reason);

/* Removes what was begun and not committed, and empties *f. */
void output_file_discard(output_file *f);

#endif
