/* SPDX-License-Identifier: MIT */
#include "streams.h"

#include "options.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void streams_open(void) {
    static char lines[BUFSIZ]; /* here, so that a line is said where no memory is left */
    static const int flags[] = { O_RDONLY, O_RDONLY, O_WRONLY };
    for (int i = 0; i <= STDERR_FILENO; i++)
        if (fcntl(i, F_GETFD) < 0 && open("/dev/null", flags[i]) < 0) break;
    setvbuf(stderr, lines, _IOLBF, sizeof lines);
}

int streams_close(int status) {
    bool failed = ferror(stdout) != 0;
    if (fflush(stdout) == 0 && !failed) return status;
    /* The reason of a failure in between is gone; what is broken says it again. */
    if (failed && write(STDOUT_FILENO, "\n", 1) == 1) errno = EIO;
    fprintf(stderr, "hemibake: stdout: cannot be written: %s\n", strerror(errno));
    return EXIT_OUTPUT;
}
