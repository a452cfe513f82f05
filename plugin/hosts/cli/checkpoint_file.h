/* SPDX-License-Identifier: MIT
 * How are results kept in a file (checkpoint.h) that may end anywhere?
 */
#ifndef HEMIBAKE_CLI_CHECKPOINT_FILE_H
#define HEMIBAKE_CLI_CHECKPOINT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CHECKPOINT_REASON_SIZE = 512 };

typedef struct checkpoint_file checkpoint_file;

/* Is the file empty, or does it begin as a checkpoint does? */
bool checkpoint_file_is_one(int descriptor);

/* Empties the file and says what it is of. It owns the descriptor from then on. NULL: out of memory or of space. */
checkpoint_file *checkpoint_file_begin(int descriptor, const char *text, size_t size);

/* Finds what is in it, and drops what was not written to its end; *text, from malloc, is what it is of. NULL: reason
 * says what is wrong. */
checkpoint_file *checkpoint_file_read(int descriptor, char **text, size_t *size, char reason[CHECKPOINT_REASON_SIZE]);

void checkpoint_file_limit(checkpoint_file *f, uint64_t bytes); /* it grows no further */
const char *checkpoint_file_failure(const checkpoint_file *f);  /* why it did not; NULL: it did */
void checkpoint_file_close(checkpoint_file *f);

/* Of hemi_checkpoint; user is the file. */
uint64_t checkpoint_file_find(void *user, const uint64_t key[2], void *bytes, uint64_t room);
void checkpoint_file_add(void *user, const uint64_t key[2], const void *bytes, uint64_t size);

#endif
