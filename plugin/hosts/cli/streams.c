/* SPDX-License-Identifier: MIT
 * See streams.h.
 */
#include "streams.h"

#include "options.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void streams_open(void) {
    static const int flags[] = { O_RDONLY, O_RDONLY, O_WRONLY };
    for (int i = 0; i <= STDERR_FILENO; i++)
        if (fcntl(i, F_GETFD) < 0 && open("/dev/null", flags[i]) < 0) return;
}

int streams_close(int status) {
    errno = 0;
    bool failed = ferror(stdout) != 0;
    if (fflush(stdout) != 0 || failed) {
        const char *reason = errno ? strerror(errno) : "not all of it was taken";
        fprintf(stderr, "hemibake: stdout: cannot be written: %s\n", reason);
        return EXIT_OUTPUT;
    }
    return status;
}
