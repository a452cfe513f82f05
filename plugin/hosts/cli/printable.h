/* SPDX-License-Identifier: MIT
 * How is a name that a stranger gave printed? On one line, in its order, moving no cursor and colouring nothing.
 */
#ifndef HEMIBAKE_CLI_PRINTABLE_H
#define HEMIBAKE_CLI_PRINTABLE_H

#include <stdio.h>

/* Rewrites text, in place and never longer: '?' stands for each control character (C0, DEL, C1), each that changes the
 * direction of writing, line and paragraph separators, and each byte that is no UTF-8. Returns text. */
char *printable(char *text);

/* Prints text so. */
void print_printable(FILE *to, const char *text);

/* The line on stderr that says what is wrong with a file. */
void print_failure(const char *file, const char *text);

/* Prints a name so, and spaces up to a width in bytes. */
void print_padded(const char *name, size_t width);

/* Prints JSON whose strings may hold such characters, which it then names: \u009b. Any reader reads the same. */
void print_json_printable(FILE *to, const char *json);

#endif
