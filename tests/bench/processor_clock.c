/* SPDX-License-Identifier: MIT
 * For LD_PRELOAD: the clock of a program is that of the processors that it has used. With one thread a bake then keeps
 * its time limit as on a machine that nobody else uses, however busy this one is.
 */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t clock, struct timespec *out) {
    return (int)syscall(SYS_clock_gettime, clock == CLOCK_MONOTONIC ? CLOCK_PROCESS_CPUTIME_ID : clock, out);
}
