/* SPDX-License-Identifier: MIT */
#include "checkpoint_label.h"

#include "digest.h"
#include "input_digest.h"
#include "printable.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The build by its own bytes: two of one version need not have the same arithmetic. "": nobody knows. */
static void write_version(FILE *to) {
    char digest[65] = "";
    if (!digest_file("/proc/self/exe", digest)) digest[0] = 0;
    fprintf(to, "%s (build %.12s)%c", hemi_version(), digest, 0);
}

bool checkpoint_label_make(checkpoint_label *out, const options *o, const input_lists *lists) {
    const char *name, *value, *config = getenv("OCIO");
    char digest[65];
    FILE *to = open_memstream(&out->text, &out->size);
    if (!to) return false;
    write_version(to);
    input_digest_of_files(o, lists, digest);
    fprintf(to, "%s%c", digest, 0);
    for (int i = 0; options_recorded(o, i, &name, &value); i++) fprintf(to, "--%s %s%c", name, value, 0);
    if (o->bake.memory_limit != 0) fprintf(to, "--memory %.17g%c", (double)o->bake.memory_limit / (1 << 20), 0);
    if (o->max_pixels != 0) fprintf(to, "--max-pixels %.17g%c", (double)o->max_pixels, 0);
    if (o->ocio || config) fprintf(to, "--ocio %s%c", o->ocio ? o->ocio : config, 0);
    bool ok = ferror(to) == 0;
    return fclose(to) == 0 && ok;
}

/* ---- comparing ---- */

/* The line after one; NULL: there is none. */
static const char *next_line(const char *line, const char *end) {
    const char *next = line ? memchr(line, 0, (size_t)(end - line)) : NULL;
    return next && next + 1 < end ? next + 1 : NULL;
}

bool checkpoint_label_matches(const checkpoint_label *here, const char *text, size_t size,
                              char reason[CHECKPOINT_REASON_SIZE]) {
    if (size == here->size && memcmp(text, here->text, size) == 0) return true;
    if (size == 0 || text[size - 1] != 0) {
        snprintf(reason, CHECKPOINT_REASON_SIZE, "does not say what it is of");
        return false;
    }
    const char *a = text, *b = here->text, *end_a = text + size, *end_b = here->text + here->size;
    for (int line = 0;; line++, a = next_line(a, end_a), b = next_line(b, end_b)) {
        if (a && b && strcmp(a, b) == 0) continue;
        if (line == 0)
            snprintf(reason, CHECKPOINT_REASON_SIZE,
                     "is of another version, %.60s, and this is %.60s; leave out --resume to begin anew", a, b);
        else if (line == 1)
            snprintf(reason, CHECKPOINT_REASON_SIZE,
                     "is of another input, or of one that names other files; leave out --resume to begin anew");
        else
            snprintf(reason, CHECKPOINT_REASON_SIZE,
                     "is of other options: there %.100s, here %.100s; leave out --resume to begin anew",
                     a ? a : "no more", b ? b : "no more");
        printable(reason);
        return false;
    }
}
