/* SPDX-License-Identifier: MIT
 * Where do the outputs of many inputs go? Into one folder, under the names of the inputs.
 */
#ifndef HEMIBAKE_CLI_OUTPUT_FOLDER_H
#define HEMIBAKE_CLI_OUTPUT_FOLDER_H

#include "options.h"

/* Of one input, each from malloc or NULL. */
typedef struct output_names {
    char *main, *bin, *report, *preview, *depfile;
} output_names;

/* Does -o name a folder: are there several inputs, does its name end with a slash, or is it a folder that has not the
 * name of an asset? */
bool output_folder_is_asked(const options *o);

/* Makes the folders that are named. EXIT_DONE, or an exit status with its line printed: two inputs share a name, an
 * option names one file for all of them, a folder cannot be made. */
int output_folder_make(const options *o);

/* o is of all of them. */
output_names output_folder_names(const options *o, const char *input);
void output_folder_forget(const output_names *names);

bool output_folder_is_same_file(const char *a, const char *b);

#endif
