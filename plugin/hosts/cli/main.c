/* SPDX-License-Identifier: MIT
 * Which command runs?
 */
#include "commands.h"

#include <stdlib.h>

int main(int argc, char **argv) {
    options o;
    int status = options_parse(argc, argv, &o);
    if (status != EXIT_DONE) return status < 0 ? EXIT_DONE : status;
    /* hemibake brings its own threads; one llvmpipe context a thread is twice as fast as threads inside each. */
    setenv("LP_NUM_THREADS", "0", 0);
    if (o.command == COMMAND_BAKE) return command_bake(&o);
    if (o.command == COMMAND_FACTORS) return command_factors(&o);
    return o.command == COMMAND_COMPARE ? command_compare(&o) : command_render(&o);
}
