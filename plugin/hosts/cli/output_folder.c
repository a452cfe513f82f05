/* SPDX-License-Identifier: MIT */
#include "output_folder.h"

#include "path_text.h"
#include "printable.h"
#include "usd_files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

bool output_folder_is_same_file(const char *a, const char *b) {
    struct stat of_a, of_b;
    return stat(a, &of_a) == 0 && stat(b, &of_b) == 0 && S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev &&
           of_a.st_ino == of_b.st_ino;
}

static bool is_folder(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

static bool ends_with_slash(const char *path) {
    return *path && path[strlen(path) - 1] == '/';
}

/* Of the name without its last ending. */
static int stem_length(const char *name) {
    const char *dot = strrchr(name, '.');
    return (int)(dot && dot > name ? (size_t)(dot - name) : strlen(name));
}

static bool has_ending_of_asset(const char *path) {
    return path_ends_in(path, ".glb") || path_ends_in(path, ".gltf") || usd_is_output(path);
}

bool output_folder_is_asked(const options *o) {
    if (!o->output) return false;
    /* What is said for many is, though a pattern finds a single one today. */
    return o->input_count > 1 || ends_with_slash(o->output) ||
           ((o->jobs > 0 || is_folder(o->output)) && !has_ending_of_asset(o->output));
}

/* ---- what cannot be ---------------------------------------------------------------------------------------------- */

static int fail(int status, const char *path, const char *text) {
    print_failure(path, text);
    return status;
}

static int by_stem(const void *left, const void *right) {
    const char *a = path_name(*(const char *const *)left), *b = path_name(*(const char *const *)right);
    int of_a = stem_length(a), of_b = stem_length(b), order = strncmp(a, b, (size_t)(of_a < of_b ? of_a : of_b));
    return order ? order : of_a - of_b;
}

static int check_names(const options *o) {
    size_t count = (size_t)o->input_count;
    const char **sorted = malloc(count * sizeof *sorted);
    int status = sorted ? EXIT_DONE : EXIT_BAD_INPUT;
    if (!sorted) return status;
    memcpy(sorted, o->inputs, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, by_stem);
    for (size_t i = 1; status == EXIT_DONE && i < count; i++)
        if (by_stem(&sorted[i - 1], &sorted[i]) == 0)
            status = fail(EXIT_USAGE, sorted[i], "another input has this name too, and both go into one folder");
    free(sorted);
    return status;
}

/* Folders above it too. */
static int make_folder(const char *path) {
    char *copy = strdup(path);
    for (char *slash = copy; copy && (slash = strchr(slash + 1, '/'));) {
        *slash = 0;
        if (mkdir(copy, 0777) != 0) errno = 0; /* the last one's word counts */
        *slash = '/';
    }
    free(copy);
    if (is_folder(path) || mkdir(path, 0777) == 0 || is_folder(path)) return EXIT_DONE;
    return fail(EXIT_OUTPUT, path, strerror(errno));
}

static int make_named(const char *name, const char *path) {
    char text[160];
    if (!path) return EXIT_DONE;
    if (ends_with_slash(path) || is_folder(path)) return make_folder(path);
    snprintf(text, sizeof text, "%s names a folder, with a slash at its end, where several assets are baked", name);
    return fail(EXIT_USAGE, path, text);
}

int output_folder_make(const options *o) {
    if (o->layer) return fail(EXIT_USAGE, o->layer, "--layer is of one stage; bake it alone");
    if (has_ending_of_asset(o->output) && !ends_with_slash(o->output) && !is_folder(o->output))
        return fail(EXIT_USAGE, o->output, "several inputs go into a folder; -o names one, with a slash at its end");
    int status = check_names(o);
    if (status == EXIT_DONE) status = make_named("--report", o->report);
    if (status == EXIT_DONE) status = make_named("--preview", o->preview);
    if (status == EXIT_DONE) status = make_named("--depfile", o->depfile);
    return status == EXIT_DONE ? make_folder(o->output) : status;
}

/* ---- names ------------------------------------------------------------------------------------------------------- */

/* FOLDER/STEM and an ending; NULL of no folder. */
static char *name_in(const char *folder, const char *input, const char *ending) {
    const char *name = path_name(input), *slash = folder && !ends_with_slash(folder) ? "/" : "";
    return folder ? path_format("%s%s%.*s%s", folder, slash, stem_length(name), name, ending) : NULL;
}

output_names output_folder_names(const options *o, const char *input) {
    const char *ending = path_name(input) + stem_length(path_name(input));
    bool is_gltf = strcasecmp(ending, ".gltf") == 0;
    return (output_names){ .main = name_in(o->output, input, ending),
                           .bin = is_gltf ? name_in(o->output, input, ".bin") : NULL,
                           .report = name_in(o->report, input, ".json"),
                           .preview = name_in(o->preview, input, ".png"),
                           .depfile = name_in(o->depfile, input, ".d") };
}

void output_folder_forget(const output_names *names) {
    free(names->main);
    free(names->bin);
    free(names->report);
    free(names->preview);
    free(names->depfile);
}
