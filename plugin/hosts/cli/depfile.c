/* SPDX-License-Identifier: MIT */
#include "depfile.h"

#include "input_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

static void put_escaped(FILE *to, const char *path) {
    for (; *path; path++) {
        if (*path == ' ' || *path == '#') fputc('\\', to);
        if (*path == '$') fputc('$', to);
        fputc(*path, to);
    }
}

static void put_file(void *to, const char *path) {
    fputs(" \\\n  ", to);
    put_escaped(to, path);
}

char *depfile_make(const options *o, const input_lists *lists) {
    struct stat status;
    char *text = NULL;
    size_t size;
    FILE *to = open_memstream(&text, &size);
    if (!to) return NULL;
    put_escaped(to, o->output);
    fputc(':', to);
    input_files_visit(o, lists, put_file, to);
    if (o->reference && stat(o->reference, &status) == 0 && S_ISREG(status.st_mode)) put_file(to, o->reference);
    fputc('\n', to);
    bool ok = ferror(to) == 0;
    if (fclose(to) == 0 && ok) return text;
    free(text);
    return NULL;
}
