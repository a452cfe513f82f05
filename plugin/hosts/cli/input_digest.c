/* SPDX-License-Identifier: MIT */
#include "input_digest.h"

#include "digest.h"
#include "input_files.h"
#include "usd_files.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* With its zero: "a","bc" is not "ab","c". */
static void add_text(FILE *to, const char *text) {
    fwrite(text, 1, strlen(text) + 1, to);
}

static void add_file(void *to, const char *path) {
    char digest[65];
    if (digest_file(path, digest)) add_text(to, digest);
}

static void add_all(FILE *to, const options *o) {
    const char *name, *value;
    add_text(to, hemi_version());
    for (int i = 0; options_recorded(o, i, &name, &value); i++) add_text(to, name), add_text(to, value);
    /* What stops a bake decides what it writes too, though the asset does not say that of itself. */
    fprintf(to, "%.17g %.17g %.17g", o->bake.time_limit_s, (double)o->bake.memory_limit, (double)o->max_pixels);
    input_files_visit(o, NULL, add_file, to);
}

void input_digest_of_files(const options *o, const input_lists *lists, char digest[65]) {
    char *text = NULL;
    size_t size = 0;
    FILE *to = open_memstream(&text, &size);
    digest[0] = 0;
    if (!to) return;
    input_files_visit(o, lists, add_file, to);
    bool ok = ferror(to) == 0;
    if (fclose(to) == 0 && ok) digest_text(text, size, digest);
    free(text);
}

void input_digest(const options *o, char digest[65]) {
    struct stat status;
    char *text = NULL;
    size_t size = 0;
    digest[0] = 0;
    if (usd_is_input(o->inputs[0]) || stat(o->inputs[0], &status) != 0 || !S_ISREG(status.st_mode)) return;
    FILE *to = open_memstream(&text, &size);
    if (!to) return;
    add_all(to, o);
    bool ok = ferror(to) == 0;
    if (fclose(to) == 0 && ok) digest_text(text, size, digest);
    free(text);
}

bool input_digest_is_in_output(const options *o) {
    char digest[65];
    input_digest(o, digest);
    cJSON *root = *digest ? input_files_json(o->output) : NULL;
    const cJSON *at = cJSON_GetObjectItemCaseSensitive(root, "asset");
    at = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(at, "extras"), "hemibake");
    const char *made_of = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(at, "input_sha256"));
    bool is_same = made_of && strcmp(made_of, digest) == 0;
    cJSON_Delete(root);
    return is_same;
}
