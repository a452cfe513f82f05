/* SPDX-License-Identifier: MIT
 * What does the text of a path say: which name, of which kind? And how is another made of it?
 */
#ifndef HEMIBAKE_CLI_PATH_TEXT_H
#define HEMIBAKE_CLI_PATH_TEXT_H

#include <stdbool.h>

enum { PATH_SIZE = 4096 };

/* room.glb of a/room.glb, in place. */
const char *path_name(const char *path);

/* Does a/room.glb end in .glb? Case is no matter; NULL ends in nothing. */
bool path_ends_in(const char *path, const char *ending);

/* 10 of 'a' or 'A'; -1: it is no digit of %20 and its like. */
int path_hex_digit(char c);

/* Where this program lies, without its name; false: nobody knows. */
bool path_of_program(char out[PATH_SIZE]);

/* As printf, from malloc; NULL: out of memory. */
char *path_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
