/* SPDX-License-Identifier: MIT
 * Which few names stand for many in a line?
 */
#ifndef HEMIBAKE_CLI_NAME_LIST_H
#define HEMIBAKE_CLI_NAME_LIST_H

#include <stddef.h>

enum { NAMES_MAX = 3, NAME_LENGTH = 40, NAMES_TEXT_SIZE = NAMES_MAX * (NAME_LENGTH + 8) + 32 };

/* Each name once, in the order of their coming; names are the caller's. */
typedef struct name_list {
    const char *names[NAMES_MAX];
    size_t count;
    double area; /* m2, of all that was added */
} name_list;

void name_list_add(name_list *l, const char *name, double area);

/* "a", "b", "c" and others */
void name_list_write(const name_list *l, char text[NAMES_TEXT_SIZE]);

#endif
