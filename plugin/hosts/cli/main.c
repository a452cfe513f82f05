/* SPDX-License-Identifier: MIT
 * Which command runs?
 */
#include "commands.h"
#include "output_folder.h"
#include "processes.h"
#include "signals.h"
#include "streams.h"

#include <stdlib.h>
#include <string.h>

/* Of several processes all share a bake; what is no bake the first does. */
static int run(const options *o) {
    if (o->command != COMMAND_BAKE && !processes_is_first()) return EXIT_DONE;
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
    processes_begin();
    int status = options_parse(argc, argv, &o);
    if (status != EXIT_DONE) return processes_end(streams_close(status < 0 ? EXIT_DONE : status), status > 0);
    /* hemibake brings its own threads; one llvmpipe context a thread is twice as fast as threads inside each. */
    setenv("LP_NUM_THREADS", "0", 0);
    signals_catch(o.inputs[0]);
    signals_fence_libraries();
    status = streams_close(run(&o));
    return processes_end(status, status != EXIT_DONE && status != EXIT_NOT_CONVERGED);
}
