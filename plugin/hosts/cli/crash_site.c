/* SPDX-License-Identifier: MIT
 * See crash_site.h. The libraries are loaded with the command, so where they lie is known at the start.
 */
#include "crash_site.h"

#include <link.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/ucontext.h>
#include <sys/uio.h>
#include <unistd.h>

/* Between abort() and the library lie the C library, that of C++ and the unwinder, whose tables take a few kB. */
enum { SPANS_MAX = 256, WORDS_SEEN = 4096 };

static const char DRIVER[] = "the OpenGL driver";

static const struct {
    const char *path, *name;
} LIBRARIES[] = { { "/libOSMesa", DRIVER },      { "/libLLVM", DRIVER }, { "/libgallium", DRIVER },
                  { "/libEGL", DRIVER },         { "/libGL", DRIVER },   { "/libOpenColorIO", "OpenColorIO" },
                  { "/libtinygltf", "tinygltf" } };

/* Of executable code. */
typedef struct span {
    uintptr_t begin, end;
    const char *library; /* NULL: none that crashes */
    bool is_command;
} span;

static span spans[SPANS_MAX];
static size_t span_count;
static uintptr_t stack_words[WORDS_SEEN];

static const char *library_at(const char *path) {
    for (size_t i = 0; i < sizeof LIBRARIES / sizeof *LIBRARIES; i++)
        if (strstr(path, LIBRARIES[i].path)) return LIBRARIES[i].name;
    return NULL;
}

/* The command itself comes first. */
static int note(struct dl_phdr_info *loaded, size_t size, void *user) {
    bool *is_first = user;
    (void)size;
    for (int i = 0; i < loaded->dlpi_phnum && span_count < SPANS_MAX; i++) {
        const ElfW(Phdr) *part = &loaded->dlpi_phdr[i];
        if (part->p_type != PT_LOAD || !(part->p_flags & PF_X)) continue;
        uintptr_t begin = (uintptr_t)loaded->dlpi_addr + part->p_vaddr;
        spans[span_count++] = (span){ begin, begin + part->p_memsz, library_at(loaded->dlpi_name), *is_first };
    }
    *is_first = false;
    return 0;
}

void crash_site_prepare(void) {
    bool is_first = true;
    dl_iterate_phdr(note, &is_first);
}

static const span *span_of(uintptr_t address) {
    for (size_t i = 0; i < span_count; i++)
        if (address - spans[i].begin < spans[i].end - spans[i].begin) return &spans[i];
    return NULL;
}

static bool find_registers(const ucontext_t *state, uintptr_t *at, uintptr_t *stack) {
#if defined __x86_64__
    *at = (uintptr_t)state->uc_mcontext.gregs[REG_RIP], *stack = (uintptr_t)state->uc_mcontext.gregs[REG_RSP];
    return true;
#elif defined __aarch64__
    *at = (uintptr_t)state->uc_mcontext.pc, *stack = (uintptr_t)state->uc_mcontext.sp;
    return true;
#else
    (void)state, (void)at, (void)stack;
    return false;
#endif
}

/* The nearest word that looks like a return to the command or to one of the libraries decides. The kernel reads, since
 * the stack may end before. */
static const char *nearest_caller(uintptr_t stack) {
    const struct iovec here = { stack_words, sizeof stack_words };
    ssize_t got = -1;
    for (size_t size = sizeof stack_words; got < 0 && size >= sizeof *stack_words; size /= 2) {
        const struct iovec there = { (void *)(stack & ~(uintptr_t)7), size };
        got = process_vm_readv(getpid(), &here, 1, &there, 1, 0);
    }
    for (ssize_t i = 0; i < got / (ssize_t)sizeof *stack_words; i++) {
        const span *caller = span_of(stack_words[i]);
        if (caller && (caller->library || caller->is_command)) return caller->library;
    }
    return NULL;
}

const char *crash_site_library(const void *machine) {
    uintptr_t at, stack;
    if (!find_registers(machine, &at, &stack)) return NULL;
    const span *here = span_of(at);
    /* Loaded since, as EGL is, or compiled by the driver; a call of NULL is anybody's. */
    if (!here && at) return DRIVER;
    if (here && (here->library || here->is_command)) return here->library;
    return nearest_caller(stack);
}
