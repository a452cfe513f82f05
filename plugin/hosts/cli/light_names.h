/* SPDX-License-Identifier: MIT
 * Which groups of lights are told apart, and what are they called? What emits is in the group that
 * extras.hemibake.group of its material names, else in one by the name of its node; lights go by theirs, the sun and
 * the sky are groups too. The attribute of a group is _LIGHT_ and its name in capitals.
 */
#ifndef HEMIBAKE_CLI_LIGHT_NAMES_H
#define HEMIBAKE_CLI_LIGHT_NAMES_H

#include "console.h"

#include <stdint.h>

enum { LIGHT_NAMES_MAX = 64, LIGHT_NAME_SIZE = 64 };

typedef struct light_names {
    char all[LIGHT_NAMES_MAX][LIGHT_NAME_SIZE]; /* of attributes */
    uint32_t count;
    bool is_asked; /* false: all is group 0, and there are none */
    bool is_too_many;
} light_names;

/* The group of this name, a new one if there is none; kind, with a number, is what is without a name. */
uint32_t light_names_group(light_names *n, const char *name, const char *kind, uint32_t index);

/* EXIT_DONE, or an exit status with its line printed. */
int light_names_ask(light_names *n, const options *o, bool for_usd, console *c);

/* What is lit by nothing that has a name is lit by the sky. EXIT_DONE, or an exit status with its line printed. */
int light_names_end(light_names *n, console *c);

#endif
