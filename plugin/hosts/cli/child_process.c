/* SPDX-License-Identifier: MIT */
#include "child_process.h"

#include "progress.h"
#include "signals.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* How often a child that has closed its stderr is looked after, and a request to stop is noticed. */
enum { LOOK_MS = 20, LINE_SIZE = 1024 };

typedef struct child {
    pid_t pid;
    int lines; /* the pipe its stderr comes from */
    double end_s;
    char line[LINE_SIZE];
    size_t length;
    child_line_fn told;
    void *user;
} child;

static int spawn(char *const argv[], int write_end, pid_t *pid) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, write_end, STDERR_FILENO);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    int fault = posix_spawnp(pid, argv[0], &files, &attributes, argv, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return fault;
}

static void tell(child *c) {
    c->line[c->length] = 0;
    if (c->length) c->told(c->user, c->line);
    c->length = 0;
}

/* False: the pipe has ended. */
static bool read_lines(child *c) {
    char bytes[4096];
    ssize_t count = read(c->lines, bytes, sizeof bytes);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) return true;
    for (ssize_t i = 0; i < count; i++) {
        if (bytes[i] != '\n') c->line[c->length++] = bytes[i];
        if (bytes[i] == '\n' || c->length + 1 == sizeof c->line) tell(c);
    }
    if (count <= 0) tell(c);
    return count > 0;
}

/* Whether it has ended; *told is what waitpid says. */
static bool has_ended(child *c, int *told) {
    pid_t ended = waitpid(c->pid, told, WNOHANG);
    return ended == c->pid || (ended < 0 && errno != EINTR);
}

static child_end kill_group(child *c, child_end why) {
    int told;
    kill(-c->pid, SIGKILL);
    while (waitpid(c->pid, &told, 0) < 0 && errno == EINTR) {
    }
    return why;
}

/* Until it has ended and all it said is read. */
static child_end follow(child *c, int *status) {
    bool open = true;
    int told = 0;
    for (;;) {
        struct pollfd waiting = { .fd = c->lines, .events = POLLIN };
        int ready = poll(&waiting, open ? 1 : 0, LOOK_MS);
        if (signals_interrupted) return kill_group(c, CHILD_STOPPED);
        if (progress_seconds() > c->end_s) return kill_group(c, CHILD_LATE);
        if (open && ready > 0) open = read_lines(c);
        if (!(open && ready > 0) && has_ended(c, &told)) break;
    }
    while (open && poll(&(struct pollfd){ .fd = c->lines, .events = POLLIN }, 1, 0) > 0) open = read_lines(c);
    tell(c);
    *status = WIFSIGNALED(told) ? WTERMSIG(told) : WEXITSTATUS(told);
    return WIFSIGNALED(told) ? CHILD_KILLED : CHILD_EXITED;
}

child_end child_run(char *const argv[], double limit_s, child_line_fn line, void *user, int *status) {
    int ends[2];
    child c = { .told = line, .user = user, .end_s = progress_seconds() + limit_s };
    *status = 0;
    if (pipe(ends) == 0) {
        fcntl(ends[0], F_SETFD, FD_CLOEXEC);
        fcntl(ends[1], F_SETFD, FD_CLOEXEC);
        c.lines = ends[0];
        *status = spawn(argv, ends[1], &c.pid);
        close(ends[1]);
    } else {
        *status = errno;
        return CHILD_MISSING;
    }
    child_end end = *status ? CHILD_MISSING : follow(&c, status);
    close(ends[0]);
    return end;
}
