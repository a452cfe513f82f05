/* SPDX-License-Identifier: MIT
 * Which lamps light nothing but what closely surrounds them? (private to shut_in.c)
 */
#ifndef HEMIBAKE_CLI_SHUT_LAMPS_H
#define HEMIBAKE_CLI_SHUT_LAMPS_H

#include "shut_in.h"
#include "shut_world.h"

/* Empty: none does. False: out of memory. */
bool shut_lamps_find(shut_world *w, char line[SHUT_IN_LINE_SIZE]);

#endif
