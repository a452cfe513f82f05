/* SPDX-License-Identifier: MIT
 * See usd_files.h. Which Python: $HEMIBAKE_USD_PYTHON, else that of the binding this program lies in, else the one that
 * the message about a missing Python tells people to make, else python3.
 */
#include "usd_files.h"

#include "child_process.h"
#include "file_read.h"
#include "path_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Reading takes a second for a million triangles; a file that pxr cannot come to an end with is given up. */
static const double LIMIT_S = 60.0, LIMIT_BYTES_A_SECOND = 1e6;

enum { ARGUMENTS_MAX = 24 };

/* ---- which files are USD ----------------------------------------------------------------------------------------- */

bool usd_is_output(const char *path) {
    return path_ends_in(path, ".usda") || path_ends_in(path, ".usdc") || path_ends_in(path, ".usdz") ||
           path_ends_in(path, ".usd");
}

bool usd_is_input(const char *path) {
    static const char *const magics[] = { "#usda", "PXR-USDC", "PK\3\4" };
    char bytes[8] = { 0 };
    struct stat status;
    if (usd_is_output(path)) return true;
    /* What a FIFO holds can be read once, and opening one without a writer would wait for it. */
    FILE *f = stat(path, &status) == 0 && S_ISREG(status.st_mode) ? fopen(path, "rb") : NULL;
    if (!f) return false;
    size_t count = fread(bytes, 1, sizeof bytes, f);
    fclose(f);
    for (size_t i = 0; i < sizeof magics / sizeof *magics; i++)
        if (count >= strlen(magics[i]) && memcmp(bytes, magics[i], strlen(magics[i])) == 0) return true;
    return false;
}

void *usd_read_file(const char *path, size_t *size) {
    char message[FILE_MESSAGE_SIZE];
    uint8_t *bytes;
    file_read_bytes(path, NULL, UINT64_MAX, &bytes, size, message);
    return bytes;
}

char *usd_payload_name(const char *layer) {
    size_t stem = strlen(layer), old = strlen(".usda");
    if (stem > old && path_ends_in(layer, ".usda")) stem -= old;
    return path_format("%.*s.baked.usdc", (int)stem, layer);
}

/* ---- the folder -------------------------------------------------------------------------------------------------- */

static bool open_folder(usd_files *f, console *c) {
    const char *place = getenv("TMPDIR");
    if (f->folder) return true;
    f->folder = path_format("%s/hemibake-usd-XXXXXX", place && *place ? place : "/tmp");
    if (f->folder && mkdtemp(f->folder)) {
        f->scene = path_format("%s/scene.glb", f->folder);
        f->sky = path_format("%s/sky.pfm", f->folder);
        f->dependencies = path_format("%s/dependencies", f->folder);
        f->baked = path_format("%s/baked.glb", f->folder);
        f->layer = path_format("%s/layer.usda", f->folder);
        if (f->scene && f->sky && f->dependencies && f->baked && f->layer) return true;
    }
    console_error(c, "USD needs a folder for what is in between, and there is none in %s", place ? place : "/tmp");
    free(f->folder);
    f->folder = NULL;
    return false;
}

static void remove_file(char *path) {
    if (path) unlink(path);
    free(path);
}

void usd_files_close(usd_files *f) {
    char *paths[] = { f->scene, f->sky, f->dependencies, f->baked, f->written, f->layer };
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) remove_file(paths[i]);
    if (f->folder) rmdir(f->folder);
    free(f->folder);
    for (size_t i = 0; i < f->loss_count; i++) free(f->losses[i]);
    free(f->losses);
    *f = (usd_files){ 0 };
}

/* ---- which Python, and where the package is ---------------------------------------------------------------------- */

/* The first of the names under the folder that is there, into out. */
static bool find_below(const char *folder, const char *const *names, int mode, char out[PATH_SIZE]) {
    for (; folder && *names; names++) {
        int length = snprintf(out, PATH_SIZE, "%s/%s", folder, *names);
        if (length > 0 && length < PATH_SIZE && access(out, mode) == 0) return true;
    }
    return false;
}

/* In the binding, hemibake/bin and hemibake/usd lie in ENV/lib/python3.X/site-packages. */
static const char *find_python(const char *own, char out[PATH_SIZE]) {
    static const char *const binding[] = { "../../../../../bin/python3", NULL };
    static const char *const of_message[] = { ".local/share/hemibake/bin/python3", NULL };
    static const char *const package[] = { "../usd/__main__.py", NULL };
    const char *named = getenv("HEMIBAKE_USD_PYTHON");
    if (named && *named) return named;
    if (own && find_below(own, package, R_OK, out) && find_below(own, binding, X_OK, out)) return out;
    return find_below(getenv("HOME"), of_message, X_OK, out) ? out : "python3";
}

static double time_limit(const char *path) {
    struct stat status;
    const char *asked = getenv("HEMIBAKE_USD_TIME_LIMIT");
    double seconds = asked ? strtod(asked, NULL) : 0.0;
    if (seconds > 0.0) return seconds;
    return LIMIT_S + (stat(path, &status) == 0 ? (double)status.st_size / LIMIT_BYTES_A_SECOND : 0.0);
}

/* ---- running it -------------------------------------------------------------------------------------------------- */

typedef struct listener {
    usd_files *files;
    console *console;
    bool failed;    /* an error has been printed */
    char last[256]; /* of the lines that are neither warning nor error; "": there was none */
} listener;

static void keep_loss(usd_files *f, const char *line) {
    char **more = realloc(f->losses, (f->loss_count + 1) * sizeof *more);
    if (!more) return;
    f->losses = more;
    f->losses[f->loss_count] = strdup(line);
    if (f->losses[f->loss_count]) f->loss_count++;
}

/* "warning: /World/Lamp: ..." is kept for the report, "error: ..." ends the bake; of the rest nobody knows what it is,
 * but its last line may say why Python itself would not.
 */
static void hear(void *user, const char *line) {
    listener *l = user;
    if (strncmp(line, "warning: ", 9) == 0) {
        console_note(l->console, "%s", line);
        keep_loss(l->files, line + 9);
    } else if (strncmp(line, "error: ", 7) == 0 && !l->failed) {
        console_error(l->console, "%s", line + 7);
        l->failed = true;
    } else if (*line) {
        snprintf(l->last, sizeof l->last, "%s", line);
    }
}

/* One line for whatever way it ended, unless it has said one itself. */
static int explain(const listener *l, child_end end, int status, const char *python, double limit_s) {
    if (end == CHILD_EXITED && status == 0) return EXIT_DONE;
    if (end == CHILD_STOPPED)
        console_error(l->console, "interrupted; nothing is written");
    else if (end == CHILD_MISSING)
        console_error(l->console,
                      "USD needs Python with usd-core, and %s does not run (%s): python3 -m venv "
                      "~/.local/share/hemibake && ~/.local/share/hemibake/bin/pip install usd-core numpy",
                      python, strerror(status));
    else if (end == CHILD_LATE)
        console_error(l->console, "the reader of USD was ended after %.0f s ($HEMIBAKE_USD_TIME_LIMIT)", limit_s);
    else if (end == CHILD_KILLED)
        console_error(l->console, "the reader of USD crashed (signal %d)", status);
    else if (!l->failed)
        console_error(l->console, "the reader of USD ended with status %d%s%s", status,
                      *l->last ? ": " : " and no word", l->last);
    if (end == CHILD_STOPPED) return EXIT_INTERRUPTED;
    return end == CHILD_EXITED && status >= EXIT_BAD_INPUT && status <= EXIT_OUTPUT ? status : EXIT_BAD_INPUT;
}

/* arguments: of the package, NULL at the end. */
static int run_package(usd_files *files, const char *const *arguments, double limit_s, console *c) {
    static const char *const places[] = { "../share/hemibake/usd/__main__.py", "../usd/__main__.py", NULL };
    char own[PATH_SIZE], python[PATH_SIZE], package[PATH_SIZE];
    const char *argv[ARGUMENTS_MAX] = { NULL };
    bool placed = path_of_program(own);
    int count = 0, status;
    argv[count++] = find_python(placed ? own : NULL, python);
    if (placed && find_below(own, places, R_OK, package)) {
        argv[count++] = package;
    } else {
        argv[count++] = "-m";
        argv[count++] = "hemibake.usd";
    }
    while (*arguments && count + 1 < ARGUMENTS_MAX) argv[count++] = *arguments++;
    listener l = { .files = files, .console = c };
    child_end end = child_run((char *const *)argv, limit_s, hear, &l, &status);
    return explain(&l, end, status, argv[0], limit_s);
}

/* ---- reading and writing ----------------------------------------------------------------------------------------- */

/* What options say of the stage, as words that begin with no dash of their own. */
typedef struct stage_words {
    char *variant, time_code[64];
} stage_words;

static bool make_words(const options *o, stage_words *out) {
    out->variant = path_format("--variant=%s", o->variant ? o->variant : "");
    snprintf(out->time_code, sizeof out->time_code, "--time-code=%.17g", o->time_code);
    return out->variant != NULL;
}

int usd_read(usd_files *f, const options *o, console *c) {
    stage_words words;
    char message[FILE_MESSAGE_SIZE];
    if (!file_is_plain(o->inputs[0], o->root, message)) return console_error(c, "%s", message);
    if (!open_folder(f, c)) return EXIT_OUTPUT;
    if (!make_words(o, &words)) return EXIT_BAD_INPUT;
    const char *arguments[ARGUMENTS_MAX] = { "scene",          o->inputs[0],    "-o",         f->scene, "--sky", f->sky,
                                             "--dependencies", f->dependencies, words.variant };
    int count = 9;
    if (!isnan(o->time_code)) arguments[count++] = words.time_code;
    if (o->root) arguments[count++] = "--root", arguments[count++] = o->root;
    int status = run_package(f, arguments, time_limit(o->inputs[0]), c);
    free(words.variant);
    f->is_read = true;
    f->has_sky = access(f->sky, R_OK) == 0;
    return status;
}

static bool write_file(const char *path, const void *bytes, size_t size) {
    FILE *f = fopen(path, "wb");
    bool ok = f && fwrite(bytes, 1, size, f) == size;
    return f && fclose(f) == 0 && ok;
}

int usd_write(usd_files *f, const options *o, const char *output, const void *glb, size_t size, console *c) {
    stage_words words;
    if (open_folder(f, c)) f->written = path_format("%s/out%.8s", f->folder, strrchr(output, '.'));
    if (!f->written) return EXIT_OUTPUT;
    if (!write_file(f->baked, glb, size)) {
        console_error(c, "USD needs room for what is in between in %s", f->folder);
        return EXIT_OUTPUT;
    }
    if (!make_words(o, &words)) return EXIT_BAD_INPUT;
    const char *arguments[ARGUMENTS_MAX] = { "write", f->baked, "-o", f->written, "--name", path_name(output) };
    int count = 6;
    if (o->layer) {
        const char *more[] = { "--layer", f->layer,  "--stage", o->inputs[0], "--payload",
                               output,    "--place", o->layer,  words.variant };
        memcpy(arguments + count, more, sizeof more);
        count += (int)(sizeof more / sizeof *more);
        if (!isnan(o->time_code)) arguments[count] = words.time_code;
    }
    int status = run_package(f, arguments, time_limit(f->baked) + time_limit(o->inputs[0]), c);
    free(words.variant);
    return status;
}
