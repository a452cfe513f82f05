/* SPDX-License-Identifier: MIT
 * See processes.h.
 */
#include "processes.h"

#if HEMIBAKE_MPI

#include <mpi.h>

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* So many bytes a message: counts of MPI are ints. */
static const uint64_t MESSAGE_BYTES = 1 << 30;

/* The others leave the first so long to say why it failed, which is why they did as a rule. */
enum { SECONDS_FOR_THE_FIRST = 2 };

static hemi_ranks shared;
static FILE *said; /* what this one has written on stderr, which nobody has seen */
static int real_stderr = -1;

/* Whoever starts programs by MPI says so in the environment; a program that was started alone need not wait for it. */
static bool is_started_by_mpi(void) {
    static const char *const names[] = { "OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (getenv(names[i])) return true;
    return false;
}

static bool exchange(void *user, void *bytes, const uint64_t *begin) {
    const hemi_ranks *all = user;
    for (uint32_t r = 0; r < all->count; r++)
        for (uint64_t at = begin[r]; at < begin[r + 1]; at += MESSAGE_BYTES) {
            uint64_t left = begin[r + 1] - at, size = left < MESSAGE_BYTES ? left : MESSAGE_BYTES;
            if (MPI_Bcast((char *)bytes + at, (int)size, MPI_BYTE, (int)r, MPI_COMM_WORLD) != MPI_SUCCESS) return false;
        }
    return true;
}

static void be_silent(void) {
    said = tmpfile();
    real_stderr = dup(STDERR_FILENO);
    if (!freopen("/dev/null", "w", stdout) || !said || dup2(fileno(said), STDERR_FILENO) < 0) exit(EXIT_FAILURE);
}

void processes_begin(void) {
    int rank = 0, count = 1;
    if (!is_started_by_mpi()) return;
    MPI_Init(NULL, NULL);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
    shared = (hemi_ranks){ sizeof shared, (uint32_t)rank, (uint32_t)count, exchange, &shared };
    if (rank > 0) be_silent();
}

bool processes_is_first(void) {
    return shared.rank == 0;
}

const hemi_ranks *processes_ranks(void) {
    return shared.count > 1 ? &shared : NULL;
}

/* Repeats what nobody has seen. */
static void say(void) {
    char line[1024];
    rewind(said);
    while (fgets(line, sizeof line, said)) dprintf(real_stderr, "process %u: %s", shared.rank, line);
}

int processes_end(int status, bool has_failed) {
    if (shared.count == 0) return status;
    if (!has_failed || shared.count == 1) return MPI_Finalize(), status;
    if (shared.rank > 0) {
        sleep(SECONDS_FOR_THE_FIRST);
        say();
    }
    fflush(NULL);
    MPI_Abort(MPI_COMM_WORLD, status);
    return status;
}

#else

void processes_begin(void) {}

bool processes_is_first(void) {
    return true;
}

const hemi_ranks *processes_ranks(void) {
    return NULL;
}

int processes_end(int status, bool has_failed) {
    (void)has_failed;
    return status;
}

#endif
