/* SPDX-License-Identifier: MIT
 * Where does an output wait until it is whole? In a file without a name, or where a file system has none, in one whose
 * name is nobody else's.
 *
 *     .hemibake-0123456789abcdef.part   beside the output, locked (flock) as long as its process lives
 *
 * A file without a name goes with its process, however that ends. One with a name stays if the process is killed;
 * whoever writes into the folder next removes it, since its lock is free then. Process numbers say nothing about that:
 * in containers each of them is 1.
 */
#ifndef HEMIBAKE_CLI_TEMPORARY_FILE_H
#define HEMIBAKE_CLI_TEMPORARY_FILE_H

#include <stdbool.h>
#include <sys/types.h>

typedef struct temporary_file {
    int descriptor; /* -1: there is none */
    char *name;     /* NULL: it has none */
} temporary_file;

/* Opens one in the folder; its mode is mode without umask's bits. False: errno says why. */
bool temporary_file_open(temporary_file *f, const char *folder, mode_t mode);

/* Gives it a name in the folder if it has none yet: what needs room in the folder needs it now. False: errno. */
bool temporary_file_name(temporary_file *f, const char *folder);

/* Renames it to path, and closes it. False: errno; the file is still there. */
bool temporary_file_rename(temporary_file *f, const char *path);

/* Removes it. */
void temporary_file_discard(temporary_file *f);

/* Removes those in the folder whose processes are gone. */
void temporary_files_sweep(const char *folder);

#endif
