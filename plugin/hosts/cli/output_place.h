/* SPDX-License-Identifier: MIT
 * Where does an output go? Symbolic links are followed; what is no regular file is written where it is.
 */
#ifndef HEMIBAKE_CLI_OUTPUT_PLACE_H
#define HEMIBAKE_CLI_OUTPUT_PLACE_H

#include <stdbool.h>
#include <sys/stat.h>

typedef struct output_place {
    char *path;         /* with the links at its end followed, from malloc */
    char *folder;       /* of it, from malloc */
    bool exists;        /* then status is its */
    bool is_special;    /* a device, a FIFO or an open file by its number: nothing can be renamed onto it */
    int own_descriptor; /* of /dev/stdout, /dev/fd/N and their like; else -1 */
    struct stat status;
} output_place;

/* False: *reason says why nothing can be written there; *out is empty then. Nothing is made and nothing is opened, so a
 * place is known to be good before any work. */
bool output_place_find(const char *path, output_place *out, const char **reason);

/* Whether both would be renamed onto the same name. */
bool output_place_equal(const output_place *a, const output_place *b);

void output_place_free(output_place *place); /* leaves it empty */

#endif
