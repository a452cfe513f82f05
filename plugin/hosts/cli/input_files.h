/* SPDX-License-Identifier: MIT
 * Which files does a bake read?
 */
#ifndef HEMIBAKE_CLI_INPUT_FILES_H
#define HEMIBAKE_CLI_INPUT_FILES_H

#include "options.h"

/* Sees one file; only what is there and is a plain file. */
typedef void (*input_file_visit)(void *user, const char *path);

/* What stages say that they depend on: files of one path a line, of the input and of --lights-from; NULL: none. */
typedef struct input_lists {
    const char *input, *lights;
} input_lists;

/* The input and what it names, the same of --lights-from, then those of the lists (NULL: none), then the configuration
 * of colours with the tables that it names, and the sky. Always in the same order. */
void input_files_visit(const options *o, const input_lists *lists, input_file_visit visit, void *user);

/* The JSON of a glTF or GLB file, from cJSON; NULL: it is none. */
struct cJSON *input_files_json(const char *path);

#endif
