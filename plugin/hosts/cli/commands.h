/* SPDX-License-Identifier: MIT
 * What does each command do? Each returns the exit status of the process.
 */
#ifndef HEMIBAKE_CLI_COMMANDS_H
#define HEMIBAKE_CLI_COMMANDS_H

#include "options.h"

int command_bake(const options *o);
int command_bake_scenes(const options *o); /* all scenes of an asset, one by one */
int command_bake_many(const options *o);   /* several, into a folder */
int command_compare(const options *o);
int command_inspect(const options *o);
int command_render(const options *o);
int command_factors(const options *o);
int command_view(const options *o);

#endif
