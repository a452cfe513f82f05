/* SPDX-License-Identifier: MIT
 * What stands on the command line? The options of ../options/option_list.h, commands and their inputs.
 */
#ifndef HEMIBAKE_CLI_OPTIONS_H
#define HEMIBAKE_CLI_OPTIONS_H

#include "option_table.h"

/* Exit statuses, a contract with build systems. */
enum {
    EXIT_DONE = 0,
    EXIT_BAD_INPUT = 1,
    EXIT_USAGE = 2,
    EXIT_OUTPUT = 3,
    EXIT_NOT_CONVERGED = 4,
    EXIT_INTERRUPTED = 130 /* and 129, 131, 143, 152: signals.h */
};

typedef enum progress_style { PROGRESS_AUTO, PROGRESS_PLAIN, PROGRESS_JSON } progress_style;

/* "hybrid", "analytic", "pr" or "fm". */
const char *options_method(hemi_method method);

/* EXIT_DONE: go on; -1: help or the version was asked for and printed; else an exit status, its line printed. */
int options_parse(int argc, char **argv, options *out);

/* The options on the line that what a bake writes depends on, one after the other: name without dashes, value ("" of a
 * flag). False when index is past the last. */
bool options_recorded(const options *o, int index, const char **name, const char **value);

#endif
