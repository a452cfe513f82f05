/* SPDX-License-Identifier: MIT
 * See signals.h. Handlers call nothing but what POSIX lets them call.
 */
#include "signals.h"

#include "crash_site.h"
#include "options.h"
#include "printable.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

volatile int signals_interrupted;

enum { TICK_NS = 10000000, TICKS = 50 };
enum { GUARDED_MAX = 16, NAME_SIZE = 1024, STATUS_OF_SIGNAL = 128, STACK_SIZE = 1 << 16 };

/* What handlers see of the rest of the program; no other state lives outside of a function. */
static _Atomic(const char *) guarded[GUARDED_MAX];
static atomic_bool interrupt_allowed, held, is_worth_waiting;
static timer_t patience;
static bool has_patience;
static char opening[NAME_SIZE + 32]; /* of the last line: "hemibake: FILE: " */
static char crash_line[NAME_SIZE + 256];
static atomic_bool has_crashed;
enum { UNSAID, BEING_SAID, SAID, CRASH_SAID };
static atomic_int error_line;
static bool is_space_limited;

static const struct {
    int number;
    const char *text;
} ENDINGS[] = { { SIGINT, "interrupted; nothing is written\n" },
                { SIGTERM, "stopped from outside (SIGTERM); nothing is written\n" },
                { SIGHUP, "stopped from outside (SIGHUP); nothing is written\n" },
                { SIGQUIT, "stopped from outside (SIGQUIT); nothing is written\n" },
                { SIGXCPU, "the limit of processor time is reached (SIGXCPU); nothing is written\n" } };
enum { ENDING_COUNT = sizeof ENDINGS / sizeof *ENDINGS };

/* From a Ctrl-C to the end, s: where there is nothing to show, somebody waits for nothing and a second is long. What
 * can be shown is finished in less than a second too, but not of every scene under every load: however long the bake
 * has run, who presses Ctrl-C is promised the end within a second. Sanitizers take theirs. */
static const double PATIENCE = 0.5;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static const double PATIENCE_FOR_AN_ANSWER = 20.0;
#else
static const double PATIENCE_FOR_AN_ANSWER = 0.85;
#endif

/* A pipe that nobody empties keeps nobody here. */
static void say(const char *text) {
    struct pollfd stream = { .fd = STDERR_FILENO, .events = POLLOUT };
    if (poll(&stream, 1, 0) == 1 && write(STDERR_FILENO, text, strlen(text)) < 0) return;
}

static void remove_guarded(void) {
    for (int i = 0; i < GUARDED_MAX; i++) {
        const char *path = atomic_load(&guarded[i]);
        if (path) unlink(path);
    }
}

static void leave(int number) {
    remove_guarded();
    say(opening);
    for (int i = 0; i < ENDING_COUNT; i++)
        if (ENDINGS[i].number == number) say(ENDINGS[i].text);
    _exit(STATUS_OF_SIGNAL + number);
}

static void on_signal(int number) {
    int before = errno;
    bool asks = number == SIGINT && atomic_load(&interrupt_allowed) && !signals_interrupted;
    if (asks) {
        double wait = atomic_load(&is_worth_waiting) ? PATIENCE_FOR_AN_ANSWER : PATIENCE;
        const struct itimerspec end = { .it_value = { (time_t)wait, (long)(1e9 * (wait - (double)(time_t)wait)) } };
        signals_interrupted = 1;
        if (has_patience) timer_settime(patience, 0, &end, NULL);
    }
    if (!asks && !atomic_load(&held)) leave(number);
    errno = before;
}

static void on_patience_ended(int number) {
    if (!signals_interrupted) { /* somebody else's, which is not ours to answer */
        signal(number, SIG_DFL);
        raise(number);
    } else if (!atomic_load(&held)) {
        leave(SIGINT);
    }
}

void signals_catch(const char *name) {
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    /* A progress line that is open on a terminal is written over. */
    int start = snprintf(opening, sizeof opening, "%s", isatty(STDERR_FILENO) ? "\r\033[K" : "");
    snprintf(opening + start, sizeof opening - (size_t)start, "hemibake: %.*s: ", NAME_SIZE - 1, name);
    printable(opening + start);
    action.sa_handler = on_signal;
    for (int i = 0; i < ENDING_COUNT; i++) {
        /* nohup asks for that: the bake goes on without its terminal. */
        if (ENDINGS[i].number == SIGHUP && sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler == SIG_IGN)
            continue;
        sigaction(ENDINGS[i].number, &action, NULL);
    }
    action.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &action, NULL);
    sigaction(SIGXFSZ, &action, NULL);
}

/* ---- crashes of libraries ---------------------------------------------------------------------------------------- */

static const int CRASHES[] = { SIGSEGV, SIGBUS, SIGABRT };
enum { CRASH_COUNT = sizeof CRASHES / sizeof *CRASHES };
static struct sigaction unfenced[CRASH_COUNT];

/* Nobody has said why the command ends. Who is about to is waited for, unless it is this thread. */
static bool is_line_free(void) {
    const struct timespec tick = { .tv_nsec = TICK_NS };
    for (int i = 0; i < TICKS && atomic_load(&error_line) == BEING_SAID; i++) nanosleep(&tick, NULL);
    int unsaid = UNSAID;
    return atomic_compare_exchange_strong(&error_line, &unsaid, CRASH_SAID);
}

static void on_crash(int number, siginfo_t *info, void *machine) {
    const char *library = crash_site_library(machine);
    (void)info;
    if (!is_space_limited && !library) {
        /* Ours: it comes again, and ends the process as any crash does, or in the report of a sanitizer. */
        for (int i = 0; i < CRASH_COUNT; i++)
            if (CRASHES[i] == number) sigaction(number, &unfenced[i], NULL);
        if (number == SIGABRT) raise(number);
        return;
    }
    /* Where memory ends it does for all threads: one speaks, and ends them all. */
    while (atomic_exchange(&has_crashed, true)) pause();
    remove_guarded();
    strcpy(crash_line, opening); /* one write, since another thread may have a line of its own to say */
    strcat(crash_line, library ? library : "it");
    strcat(crash_line, is_space_limited ? " crashed for want of memory under this limit of address space (ulimit -v); "
                                          "raise it; nothing is written\n"
                                        : " crashed, most likely for want of memory; nothing is written\n");
    if (is_line_free()) say(crash_line);
    _exit(EXIT_BAD_INPUT);
}

void signals_error_begins(void) {
    if (atomic_exchange(&error_line, BEING_SAID) != CRASH_SAID) return;
    for (;;) pause(); /* the crash ends all threads */
}

void signals_error_is_said(void) {
    atomic_store(&error_line, SAID);
}

void signals_fence_libraries(void) {
    static char stack[STACK_SIZE];
    struct rlimit limit;
    struct sigaction action;
    is_space_limited = getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
    crash_site_prepare();
    sigaltstack(&(stack_t){ .ss_sp = stack, .ss_size = sizeof stack }, NULL);
    memset(&action, 0, sizeof action);
    action.sa_sigaction = on_crash;
    action.sa_flags = SA_ONSTACK | SA_SIGINFO;
    for (int i = 0; i < CRASH_COUNT; i++) sigaction(CRASHES[i], &action, &unfenced[i]);
}

/* POSIX lets a handler set a timer, and make none. */
void signals_allow_interrupt(void) {
    struct sigaction action;
    struct sigevent event;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_patience_ended;
    sigaction(SIGALRM, &action, NULL);
    memset(&event, 0, sizeof event);
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGALRM;
    if (timer_create(CLOCK_MONOTONIC, &event, &patience) == 0) has_patience = true;
    atomic_store(&interrupt_allowed, true);
}

void signals_set_worth(bool is_worth_it) {
    atomic_store(&is_worth_waiting, is_worth_it);
}

void signals_hold(void) {
    atomic_store(&held, true);
}

void signals_release(void) {
    atomic_store(&held, false);
}

void signals_guard(const char *path) {
    for (int i = 0; i < GUARDED_MAX; i++)
        if (!atomic_load(&guarded[i])) {
            atomic_store(&guarded[i], path);
            return;
        }
}

void signals_unguard(const char *path) {
    for (int i = 0; i < GUARDED_MAX; i++)
        if (path && atomic_load(&guarded[i]) == path) atomic_store(&guarded[i], NULL);
}
