/* SPDX-License-Identifier: MIT
 * Which commands are there, and what is printed of them and their options?
 */
#ifndef HEMIBAKE_CLI_HELP_H
#define HEMIBAKE_CLI_HELP_H

#include "options.h"

#include <stdio.h>

typedef struct command_text {
    const char *name;
    command command;
    int inputs;
    bool takes_many; /* and more of them */
    const char *synopsis, *help, *example;
} command_text;

/* NULL: there is none of that name. */
const command_text *find_command(const char *name);

/* All of them, one after the other; the last one's name is NULL. */
const command_text *first_command(void);

void print_overview(FILE *to);
void print_help(const command_text *c);
void print_option(const option *o);

/* The commands and the table of options for other programs: 'hemibake help --json'. */
void print_json(void);

#endif
