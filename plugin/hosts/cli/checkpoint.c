/* SPDX-License-Identifier: MIT */
#include "checkpoint.h"

#include "checkpoint_file.h"
#include "checkpoint_label.h"
#include "output_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* Bytes; as much as results may take in memory where no --memory says. */
static const uint64_t SIZE_MAX_DEFAULT = UINT64_C(4) << 30;

struct checkpoint {
    hemi_checkpoint desc;
    const char *path;
    checkpoint_file *file;
};

static int fail(console *c, int status, const char *path, const char *text) {
    const char *before = c->file;
    c->file = path;
    console_error(c, "%s", text);
    c->file = before;
    return status;
}

/* ---- what the file is named like ---- */

static bool is_same(const char *a, const char *b) {
    return a && b && (strcmp(a, b) == 0 || output_folder_is_same_file(a, b));
}

static int check_names(const options *o, const char *path, console *c) {
    const char *const others[] = { o->inputs[0], o->output, o->report, o->preview, o->depfile, o->layer, o->reference };
    struct stat status;
    if (o->checkpoint && o->resume && !is_same(o->checkpoint, o->resume))
        return fail(c, EXIT_USAGE, o->checkpoint,
                    "results go to the file that --resume names; name the same, or leave it out");
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (is_same(path, others[i])) return fail(c, EXIT_USAGE, path, "a checkpoint is a file of its own");
    if (stat(o->inputs[0], &status) == 0 && !S_ISREG(status.st_mode))
        return fail(c, EXIT_BAD_INPUT, o->inputs[0],
                    "is no plain file, of which a checkpoint could know that it is the same");
    return EXIT_DONE;
}

/* ---- opening ---- */

/* Nothing but a checkpoint, or nothing at all, is written over. */
static int begin_anew(checkpoint *c, int descriptor, const checkpoint_label *label, console *to) {
    if (!checkpoint_file_is_one(descriptor))
        return fail(to, EXIT_BAD_INPUT, c->path, "is there and no checkpoint; it is not written over");
    c->file = checkpoint_file_begin(descriptor, label->text, label->size);
    return c->file ? EXIT_DONE : fail(to, EXIT_OUTPUT, c->path, "a checkpoint cannot be written there");
}

static int go_on(checkpoint *c, int descriptor, const checkpoint_label *label, console *to) {
    char *text = NULL, reason[CHECKPOINT_REASON_SIZE];
    size_t size = 0;
    c->file = checkpoint_file_read(descriptor, &text, &size, reason);
    bool ok = c->file && checkpoint_label_matches(label, text, size, reason);
    free(text);
    return ok ? EXIT_DONE : fail(to, EXIT_BAD_INPUT, c->path, reason);
}

static int open_locked(const char *path, bool is_there, console *c, int *out) {
    struct stat status;
    /* A FIFO keeps nobody here. */
    *out = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK | (is_there ? 0 : O_CREAT), 0666);
    if (*out < 0) return fail(c, is_there ? EXIT_BAD_INPUT : EXIT_OUTPUT, path, strerror(errno));
    if (fstat(*out, &status) != 0 || !S_ISREG(status.st_mode))
        return fail(c, EXIT_BAD_INPUT, path, "is no plain file, as a checkpoint is");
    if (flock(*out, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return fail(c, EXIT_BAD_INPUT, path, "another bake keeps its results there");
    return EXIT_DONE;
}

int checkpoint_open(const options *o, const input_lists *lists, console *to, checkpoint **out) {
    const char *path = o->resume ? o->resume : o->checkpoint;
    checkpoint_label label = { 0 };
    int descriptor = -1;
    *out = NULL;
    if (!path) return EXIT_DONE;
    int status = check_names(o, path, to);
    if (status == EXIT_DONE) status = open_locked(path, o->resume != NULL, to, &descriptor);
    checkpoint *c = status == EXIT_DONE ? calloc(1, sizeof *c) : NULL;
    if (status == EXIT_DONE && (!c || !checkpoint_label_make(&label, o, lists)))
        status = fail(to, EXIT_BAD_INPUT, path, "out of memory");
    if (status == EXIT_DONE) {
        c->path = path;
        /* Of a bake that was killed at its very beginning there is an empty file. */
        bool is_begun = o->resume && lseek(descriptor, 0, SEEK_END) != 0;
        status = (is_begun ? go_on : begin_anew)(c, descriptor, &label, to);
    }
    free(label.text);
    if (status == EXIT_DONE) {
        checkpoint_file_limit(c->file, o->bake.memory_limit > 0 ? (uint64_t)o->bake.memory_limit : SIZE_MAX_DEFAULT);
        c->desc = (hemi_checkpoint){ sizeof c->desc, c->file, checkpoint_file_find, checkpoint_file_add };
        *out = c;
        return EXIT_DONE;
    }
    if (c && c->file)
        checkpoint_file_close(c->file);
    else if (descriptor >= 0)
        close(descriptor);
    free(c);
    return status;
}

const hemi_checkpoint *checkpoint_desc(const checkpoint *c) {
    return c ? &c->desc : NULL;
}

void checkpoint_close(checkpoint *c, console *to, bool is_done) {
    if (!c) return;
    const char *failure = checkpoint_file_failure(c->file);
    if (is_done)
        unlink(c->path);
    else if (failure)
        console_note(to, "%s: %s; results from then on are not in it", c->path, failure);
    checkpoint_file_close(c->file);
    free(c);
}
