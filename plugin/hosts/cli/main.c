/* SPDX-License-Identifier: MIT
 * Which command runs?
 */
#include "commands.h"
#include "output_folder.h"
#include "signals.h"
#include "streams.h"

#include <stdlib.h>
#include <string.h>

static int run(const options *o) {
    if (o->command == COMMAND_BAKE && output_folder_is_asked(o)) return command_bake_many(o);
    if (o->command == COMMAND_BAKE && o->scene && !strcmp(o->scene, "all")) return command_bake_scenes(o);
    if (o->command == COMMAND_BAKE) return command_bake(o);
    if (o->command == COMMAND_INSPECT) return command_inspect(o);
    if (o->command == COMMAND_VIEW) return command_view(o);
    if (o->command == COMMAND_FACTORS) return command_factors(o);
    return o->command == COMMAND_COMPARE ? command_compare(o) : command_render(o);
}

int main(int argc, char **argv) {
    options o;
    streams_open();
    int status = options_parse(argc, argv, &o);
    if (status != EXIT_DONE) return streams_close(status < 0 ? EXIT_DONE : status);
    /* hemibake brings its own threads; one llvmpipe context a thread is twice as fast as threads inside each. */
    setenv("LP_NUM_THREADS", "0", 0);
    signals_catch(o.inputs[0]);
    signals_fence_libraries();
    return streams_close(run(&o));
}
