/* SPDX-License-Identifier: MIT
 * Do inputs that once failed, and the seeds with what an interrupted copy leaves of them, pass without libFuzzer?
 *
 *     replay FOLDER ...    the name of a file begins with that of its target and a dash
 */
#include "targets.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of each file so many beginnings are tried besides the whole. */
enum { BEGINNINGS = 24, NAME_MOST = 16 };

static int run_file(const char *folder, const char *file) {
    char path[4096], name[NAME_MOST] = "";
    const char *dash = strchr(file, '-');
    if (!dash || dash - file >= NAME_MOST) return 0;
    memcpy(name, file, (size_t)(dash - file));
    const fuzz_target *target = fuzz_target_named(name);
    snprintf(path, sizeof path, "%s/%s", folder, file);
    FILE *f = target ? fopen(path, "rb") : NULL;
    if (!f || fseek(f, 0, SEEK_END) != 0) return 0;
    size_t size = (size_t)ftell(f);
    rewind(f);
    uint8_t *bytes = malloc(size + 1);
    if (!bytes || fread(bytes, 1, size, f) != size) exit(1);
    fclose(f);
    target->run(bytes, size);
    for (size_t i = 0; i < BEGINNINGS; i++) {
        /* In a block of its own, so that a sanitizer sees a byte read too many. */
        size_t part = size * i / BEGINNINGS;
        uint8_t *beginning = malloc(part ? part : 1);
        if (!beginning) exit(1);
        memcpy(beginning, bytes, part);
        target->run(beginning, part);
        free(beginning);
    }
    free(bytes);
    return 1;
}

int main(int argc, char **argv) {
    int count = 0;
    for (int i = 1; i < argc; i++) {
        DIR *folder = opendir(argv[i]);
        if (!folder) continue;
        for (const struct dirent *entry; (entry = readdir(folder));) count += run_file(argv[i], entry->d_name);
        closedir(folder);
    }
    printf("%d files, each with %d of its beginnings\n", count, BEGINNINGS);
    return count > 0 ? 0 : 1;
}
