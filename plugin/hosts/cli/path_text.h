/* SPDX-License-Identifier: MIT
 * What does the text of a path say: which name, of which kind? And how is another made of it?
 */
#ifndef HEMIBAKE_CLI_PATH_TEXT_H
#define HEMIBAKE_CLI_PATH_TEXT_H

#include <stdbool.h>

/* room.glb of a/room.glb, in place. */
const char *path_name(const char *path);

/* Does a/room.glb end in .glb? Case is no matter; NULL ends in nothing. */
bool path_ends_in(const char *path, const char *ending);

/* As printf, from malloc; NULL: out of memory. */
char *path_format(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
