/* SPDX-License-Identifier: MIT
 * Which of several processes that share a bake is this one? Those that mpirun, or whatever starts programs by MPI, has
 * started together, in a build with -DHEMIBAKE_MPI=ON; elsewhere it is alone. The first reads, bakes, writes and speaks
 * as one alone does; the others bake with it and are silent, as long as nothing fails.
 */
#ifndef HEMIBAKE_CLI_PROCESSES_H
#define HEMIBAKE_CLI_PROCESSES_H

#include <hemibake/hemibake.h>

#include <stdbool.h>

/* Before anything is written. */
void processes_begin(void);

/* Is it the one that speaks and writes? */
bool processes_is_first(void);

/* How they exchange what they find; NULL: it is alone. */
const hemi_ranks *processes_ranks(void);

/* When this one has come to its end, with an exit status, which is returned. One that failed alone takes the others
 * along, which would wait for it. */
int processes_end(int status, bool has_failed);

#endif
