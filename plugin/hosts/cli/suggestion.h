/* SPDX-License-Identifier: MIT
 * Which word did the user mean? The nearest of those that there are, if it is near enough to be worth a question.
 */
#ifndef HEMIBAKE_CLI_SUGGESTION_H
#define HEMIBAKE_CLI_SUGGESTION_H

#include <stddef.h>

typedef struct suggestion {
    const char *word;  /* that was typed */
    const char *found; /* the nearest so far; NULL: none is near */
    size_t distance;   /* to it */
} suggestion;

void suggestion_consider(suggestion *s, const char *candidate);

#endif
