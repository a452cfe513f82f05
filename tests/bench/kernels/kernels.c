/* SPDX-License-Identifier: MIT
 * How fast are the parts that a bake spends its time in? Each beside the simplest correct loop that does the same.
 *
 *     build/release/tests/bench/kernels [hemi-cubes|items|closed-forms|formats ...]      default: all
 *
 * One thread. Exit status 1: a kernel and its simplest loop do not agree.
 */
#include "kernels.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

double kernel_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double kernel_random(uint64_t *state) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

double kernel_best(void (*work)(void *user), void *user, int runs) {
    double best = 1e300;
    for (int r = 0; r < runs; r++) {
        double begin = kernel_seconds(), taken = 0.0;
        int calls = 0;
        do {
            work(user);
            calls++;
            taken = kernel_seconds() - begin;
        } while (taken < 0.01);
        if (taken / calls < best) best = taken / calls;
    }
    return best;
}

static void print_first_line_of(const char *command, const char *label) {
    char line[256] = "";
    FILE *pipe = popen(command, "r");
    bool any = pipe && fgets(line, sizeof line, pipe);
    if (pipe) pclose(pipe);
    line[strcspn(line, "\n")] = '\0';
    printf("%s: %s\n", label, any ? line : "unknown");
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        bool (*run)(void);
    } kernels[] = { { "hemi-cubes", kernel_hemicubes },
                    { "items", kernel_items },
                    { "closed-forms", kernel_closed_forms },
                    { "formats", kernel_formats } };
    bool agree = true, found = argc == 1;
    setenv("LP_NUM_THREADS", "0", 0); /* as the command does */
    print_first_line_of("git describe --always --dirty 2>/dev/null", "commit");
    print_first_line_of("sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null", "machine");
    for (size_t k = 0; k < sizeof kernels / sizeof *kernels; k++) {
        bool wanted = argc == 1;
        for (int i = 1; i < argc; i++) wanted = wanted || strcmp(argv[i], kernels[k].name) == 0;
        if (wanted) agree = kernels[k].run() && agree;
        found = found || wanted;
    }
    if (!found) fprintf(stderr, "kernels: hemi-cubes, items, closed-forms or formats\n");
    return agree && found ? 0 : 1;
}
