/* SPDX-License-Identifier: MIT
 * Which system calls fail? Those that HEMIBAKE_BROKEN names, in a program that this is preloaded into: "tmpfile" (no
 * files without a name), "link" and "rename" (no space left), "fsync" (input or output error), "lock" (no locks). And
 * memory, from the n-th request on that follows the start of main():
 *
 *     HEMIBAKE_BROKEN_MEMORY=N     refuses the N-th request alone
 *     HEMIBAKE_BROKEN_MEMORY=N+    and all that follow
 *     HEMIBAKE_BROKEN_MEMORY=0     refuses none; with HEMIBAKE_COUNT=FILE their number is written there at the end
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

static bool is_broken(const char *call) {
    const char *list = getenv("HEMIBAKE_BROKEN");
    return list && strstr(list, call);
}

static int broken(int error) {
    errno = error;
    return -1;
}

#define REAL(name) ((__typeof__(name) *)dlsym(RTLD_NEXT, #name))

int open(const char *path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    int mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(arguments, int) : 0;
    va_end(arguments);
    if ((flags & O_TMPFILE) == O_TMPFILE && is_broken("tmpfile")) return broken(EOPNOTSUPP);
    return REAL(open)(path, flags, mode);
}

int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags) {
    return is_broken("link") ? broken(ENOSPC) : REAL(linkat)(from_folder, from, to_folder, to, flags);
}

int rename(const char *from, const char *to) {
    return is_broken("rename") ? broken(ENOSPC) : REAL(rename)(from, to);
}

int fsync(int descriptor) {
    return is_broken("fsync") ? broken(EIO) : REAL(fsync)(descriptor);
}

int flock(int descriptor, int operation) {
    return is_broken("lock") ? broken(ENOLCK) : REAL(flock)(descriptor, operation);
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

/* The loader, and constructors of libraries, ask before main() too; what they are refused is no fault of a bake. */
static atomic_bool started;
static atomic_ulong asked;
static unsigned long first;
static bool for_good;

static bool refuses(void) {
    if (!atomic_load_explicit(&started, memory_order_relaxed)) return false;
    unsigned long n = 1 + atomic_fetch_add_explicit(&asked, 1, memory_order_relaxed);
    if (!first || (for_good ? n < first : n != first)) return false;
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size) {
    return refuses() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    return refuses() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
    return refuses() ? NULL : __libc_realloc(block, size);
}

void *memalign(size_t alignment, size_t size) {
    return refuses() ? NULL : __libc_memalign(alignment, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    return refuses() ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size) {
    if (refuses()) return ENOMEM;
    *block = __libc_memalign(alignment, size);
    return *block ? 0 : ENOMEM;
}

static int (*main_of_program)(int, char **, char **);

static int counted_main(int argc, char **argv, char **environment) {
    const char *at = getenv("HEMIBAKE_BROKEN_MEMORY"), *file = getenv("HEMIBAKE_COUNT");
    char *end = NULL;
    first = at ? strtoul(at, &end, 10) : 0;
    for_good = end && *end == '+';
    atomic_store(&started, at != NULL);
    int status = main_of_program(argc, argv, environment);
    atomic_store(&started, false);
    FILE *f = file ? fopen(file, "w") : NULL;
    if (f) fprintf(f, "%lu\n", atomic_load(&asked)), fclose(f);
    return status;
}

/* The C library calls main() from here. */
int __libc_start_main(int (*program)(int, char **, char **), int argc, char **argv, void (*begin)(void),
                      void (*end)(void), void (*loader)(void), void *stack) {
    main_of_program = program;
    return REAL(__libc_start_main)(counted_main, argc, argv, begin, end, loader, stack);
}
