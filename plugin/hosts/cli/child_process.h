/* SPDX-License-Identifier: MIT
 * How does the command run another program and hear what it says? Without a shell, for no longer than a limit, line by
 * line from its stderr.
 */
#ifndef HEMIBAKE_CLI_CHILD_PROCESS_H
#define HEMIBAKE_CLI_CHILD_PROCESS_H

#include <stdbool.h>

typedef enum child_end {
    CHILD_EXITED,  /* of itself: status */
    CHILD_KILLED,  /* by a signal: status is its number */
    CHILD_LATE,    /* ended here, at the limit */
    CHILD_STOPPED, /* ended here, since this process was asked to stop */
    CHILD_MISSING  /* it could not be started: status is errno */
} child_end;

/* One line of its stderr, without the newline; longer ones come in parts. */
typedef void (*child_line_fn)(void *user, const char *line);

/* Runs argv[0], looked up in PATH, with nothing to read and its output thrown away, in a process group of its own, and
 * waits for its end. */
child_end child_run(char *const argv[], double limit_s, child_line_fn line, void *user, int *status);

#endif
