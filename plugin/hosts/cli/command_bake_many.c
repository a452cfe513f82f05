/* SPDX-License-Identifier: MIT
 * hemibake bake IN... -o DIR --jobs N: each asset in a process of its own, so that none takes another down; what is
 * unchanged since it was baked is passed over.
 */
#include "commands.h"
#include "input_digest.h"
#include "output_folder.h"
#include "printable.h"
#include "signals.h"
#include "streams.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* Of a child that has passed its asset over; its parent alone sees it. */
enum { EXIT_UNCHANGED = 64, STATUS_OF_SIGNAL = 128 };

typedef struct batch {
    const options *o;
    int jobs;
    pid_t *children; /* children[i] of input i; 0: not started, or over */
    sigset_t watched, before;
    int running, next, baked, unchanged, failed, unconverged;
    int ended_by; /* a signal, or 0 */
} batch;

/* ---- one asset, in its own process ------------------------------------------------------------------------------- */

static bool exists(const char *path) {
    return !path || access(path, F_OK) == 0;
}

static bool is_unchanged(const options *one, const char *bin) {
    bool is_whole = exists(bin) && exists(one->report) && exists(one->preview) && exists(one->depfile);
    return is_whole && !one->force && input_digest_is_in_output(one);
}

static void say_unchanged(const options *one) {
    if (one->quiet) return;
    printf("unchanged ");
    print_printable(stdout, one->inputs[0]);
    printf(" -> ");
    print_printable(stdout, one->output);
    printf("\n");
}

static int bake_one(const options *one, const char *bin) {
    const char *input = one->inputs[0];
    if (is_unchanged(one, bin)) {
        say_unchanged(one);
        return EXIT_UNCHANGED;
    }
    if (!one->force && output_folder_is_same_file(input, one->output)) {
        print_failure(input, "would be written onto itself; give -o another folder, or say --force");
        return EXIT_USAGE;
    }
    return one->scene && strcmp(one->scene, "all") == 0 ? command_bake_scenes(one) : command_bake(one);
}

/* Threads of all jobs together are as many as of one; what is baked is the same for any number. */
static options options_of_one(const batch *b, const char *const *input, const output_names *names) {
    options one = *b->o;
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    one.inputs = input;
    one.input_count = 1;
    one.output = names->main;
    one.report = names->report;
    one.preview = names->preview;
    one.depfile = names->depfile;
    one.is_one_of_many = true;
    one.hides_progress = b->jobs > 1;
    if (!one.threads && b->jobs > 1) one.threads = (uint32_t)(cores > b->jobs ? cores / b->jobs : 1);
    return one;
}

/* A group of its own: Ctrl-C on the terminal reaches the parent alone, which hands it on once. */
static void be_child(const batch *b, int i) {
    const char *const input = b->o->inputs[i];
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    signals_catch(input);
    sigprocmask(SIG_SETMASK, &b->before, NULL);
    const output_names names = output_folder_names(b->o, input);
    const options one = options_of_one(b, &input, &names);
    int status = bake_one(&one, names.bin);
    output_folder_forget(&names);
    exit(streams_close(status));
}

/* ---- all of them ------------------------------------------------------------------------------------------------- */

static void start_next(batch *b) {
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) be_child(b, b->next);
    if (child < 0) {
        print_failure(b->o->inputs[b->next], strerror(errno));
        b->failed++;
    } else {
        b->children[b->next] = child;
        b->running++;
    }
    b->next++;
}

static void count_end(batch *b, const char *input, int status) {
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : STATUS_OF_SIGNAL + WTERMSIG(status);
    b->running--;
    if (code == EXIT_DONE)
        b->baked++;
    else if (code == EXIT_NOT_CONVERGED)
        b->baked++, b->unconverged++;
    else if (code == EXIT_UNCHANGED)
        b->unchanged++;
    else
        b->failed++;
    if (WIFSIGNALED(status)) print_failure(input, "its process crashed; nothing of it is written");
}

static void reap(batch *b) {
    int status;
    for (pid_t child; (child = waitpid(-1, &status, WNOHANG)) > 0;)
        for (int i = 0; i < b->next; i++)
            if (b->children[i] == child) {
                b->children[i] = 0;
                count_end(b, b->o->inputs[i], status);
            }
}

/* Nothing is started any more; what runs does with it what a bake does. */
static void hand_on(batch *b, int number) {
    b->ended_by = number;
    for (int i = 0; i < b->next; i++)
        if (b->children[i] > 0) kill(b->children[i], number);
}

static void work(batch *b) {
    while (b->running > 0 || (!b->ended_by && b->next < b->o->input_count)) {
        if (!b->ended_by && b->running < b->jobs && b->next < b->o->input_count) {
            start_next(b);
            continue;
        }
        int number = sigwaitinfo(&b->watched, NULL);
        if (number > 0 && number != SIGCHLD) hand_on(b, number);
        reap(b);
    }
}

static int finish(const batch *b) {
    int left = b->o->input_count - b->baked - b->unchanged - b->failed;
    if (!b->o->quiet) {
        printf("%d baked, %d unchanged, %d failed", b->baked, b->unchanged, b->failed);
        if (b->unconverged) printf(", %d stopped before converged", b->unconverged);
        if (left) printf(", %d not begun", left);
        printf("\n");
    }
    if (b->ended_by) return STATUS_OF_SIGNAL + b->ended_by;
    if (b->failed) return EXIT_BAD_INPUT;
    return b->unconverged ? EXIT_NOT_CONVERGED : EXIT_DONE;
}

int command_bake_many(const options *o) {
    static const int watched[] = { SIGCHLD, SIGINT, SIGTERM, SIGHUP, SIGQUIT };
    batch b = { .o = o, .jobs = o->jobs ? (int)o->jobs : 1 };
    int status = output_folder_make(o);
    if (status != EXIT_DONE) return status;
    b.children = calloc((size_t)o->input_count + 1, sizeof *b.children);
    if (!b.children) return EXIT_BAD_INPUT;
    sigemptyset(&b.watched);
    for (size_t i = 0; i < sizeof watched / sizeof *watched; i++) sigaddset(&b.watched, watched[i]);
    sigprocmask(SIG_BLOCK, &b.watched, &b.before);
    work(&b);
    sigprocmask(SIG_SETMASK, &b.before, NULL);
    status = finish(&b);
    free(b.children);
    return status;
}
