/* SPDX-License-Identifier: MIT
 * Of which version, input and options is a checkpoint? Lines that end with a zero each.
 */
#ifndef HEMIBAKE_CLI_CHECKPOINT_LABEL_H
#define HEMIBAKE_CLI_CHECKPOINT_LABEL_H

#include "checkpoint_file.h"
#include "input_files.h"

typedef struct checkpoint_label {
    char *text; /* from malloc */
    size_t size;
} checkpoint_label;

/* lists: of what stages depend on. False when out of memory. */
bool checkpoint_label_make(checkpoint_label *out, const options *o, const input_lists *lists);

/* False: reason says what is another. */
bool checkpoint_label_matches(const checkpoint_label *here, const char *text, size_t size,
                              char reason[CHECKPOINT_REASON_SIZE]);

#endif
