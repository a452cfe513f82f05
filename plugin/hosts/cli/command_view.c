/* SPDX-License-Identifier: MIT
 * hemibake view OUT [--before IN] [--reference PROBES.hprb|OTHER.glb]: a page that shows a bake, on 127.0.0.1
 */
#include "asset_input.h"
#include "commands.h"
#include "comparison.h"
#include "page_server.h"
#include "path_text.h"
#include "printable.h"

#include <cjson/cJSON.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { URL_SIZE = 3 * PATH_SIZE + 64 };

/* What stands before the names of files in the page's addresses. */
static const char OUT[] = "out", BEFORE[] = "before";

/* ---- where the page is ------------------------------------------------------------------------------------------- */

/* Beside the program, as it was built or installed, or in Python's package. */
static bool find_page(char out[PATH_SIZE]) {
    static const char *const places[] = { "../share/hemibake/viewer", "../viewer" };
    char own[PATH_SIZE], index[PATH_SIZE + 16];
    if (!path_of_program(own)) return false;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        if (snprintf(out, PATH_SIZE, "%s/%s", own, places[i]) >= PATH_SIZE) continue;
        snprintf(index, sizeof index, "%s/viewer.js", out);
        if (access(index, R_OK) == 0) return true;
    }
    return false;
}

/* ---- what it is to load ------------------------------------------------------------------------------------------ */

static void write_folder(const char *path, char out[PATH_SIZE]) {
    size_t length = (size_t)(path_name(path) - path);
    snprintf(out, PATH_SIZE, "%.*s", length > 0 ? (int)length : 1, length > 0 ? path : ".");
}

/* out/room%20two.glb */
static void write_url(const char *prefix, const char *path, char out[URL_SIZE]) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~";
    int at = snprintf(out, URL_SIZE, "%s/", prefix);
    for (const char *c = path_name(path); *c && at < URL_SIZE - 4; c++)
        at += snprintf(out + at, 4, strchr(plain, *c) ? "%c" : "%%%02X", (unsigned char)*c);
}

static char *make_config(const options *o, bool has_errors) {
    char url[URL_SIZE];
    cJSON *root = cJSON_CreateObject();
    write_url(OUT, o->inputs[0], url);
    cJSON_AddStringToObject(root, "out", url);
    if (o->before) {
        write_url(BEFORE, o->before, url);
        cJSON_AddStringToObject(root, "before", url);
    }
    if (has_errors) cJSON_AddStringToObject(root, "error", "error.bin");
    char *text = cJSON_PrintUnformatted(root);
    cJSON_Delete(root);
    return text;
}

/* What cannot be read is said here, where somebody looks, and not on the page. */
static int check_assets(const options *o, console *c, float **errors, size_t *count) {
    gltf_asset *asset = NULL, *before = NULL;
    int status = asset_input_open(o->inputs[0], o, c, &asset);
    if (status == EXIT_DONE && o->before) status = asset_input_open(o->before, o, c, &before);
    if (status == EXIT_DONE && o->reference) status = comparison_points(asset, o, c, errors, count);
    gltf_asset_destroy(before);
    gltf_asset_destroy(asset);
    return status;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int serve(const options *o, console *c, const char *page, const float *errors, size_t count) {
    char out[PATH_SIZE], before[PATH_SIZE] = ".";
    char *config = make_config(o, errors != NULL);
    const char *reason = "out of memory";
    write_folder(o->inputs[0], out);
    if (o->before) write_folder(o->before, before);
    const page_folder folders[] = { { OUT, out }, { BEFORE, before }, { "", page } };
    const page_text texts[] = { { "config.json", config, config ? strlen(config) : 0 },
                                { "error.bin", errors, count * sizeof *errors } };
    page_server s = { .folders = folders, .texts = texts, .folder_count = 3, .text_count = errors ? 2 : 1 };
    if (!config || !page_server_open(&s, (uint16_t)o->port, &reason)) {
        free(config);
        return console_error(c, "cannot be shown on port %u: %s", (unsigned)o->port, reason);
    }
    printf("http://127.0.0.1:%u/ shows ", (unsigned)s.port);
    print_printable(stdout, o->inputs[0]);
    printf("; Ctrl-C ends it\n");
    fflush(stdout);
    signal(SIGINT, SIG_DFL); /* there is nothing to be left behind */
    page_server_run(&s);
    free(config);
    return EXIT_DONE;
}

int command_view(const options *o) {
    char page[PATH_SIZE];
    float *errors = NULL;
    size_t count = 0;
    console c = { 0 };
    console_start(&c, o);
    int status = check_assets(o, &c, &errors, &count);
    if (status == EXIT_DONE && !find_page(page))
        status = console_error(&c, "the viewer was not built with this program: 'cmake --build BUILD --target viewer' "
                                   "makes it, and needs npm");
    if (status == EXIT_DONE) status = serve(o, &c, page, errors, count);
    free(errors);
    return status;
}
