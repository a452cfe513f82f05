/* SPDX-License-Identifier: MIT
 * Which readers of a stranger's bytes are there to be fuzzed?
 */
#ifndef HEMIBAKE_TESTS_FUZZ_TARGETS_H
#define HEMIBAKE_TESTS_FUZZ_TARGETS_H

#include <hemibake/hemibake.h>
#include <stddef.h>
#include <stdint.h>

typedef struct fuzz_target {
    const char *name;
    void (*run)(const uint8_t *bytes, size_t size);
} fuzz_target;

extern const fuzz_target FUZZ_TARGETS[]; /* ends with a name of NULL */

const fuzz_target *fuzz_target_named(const char *name); /* NULL: there is none */

/* One for all executions, of one thread: a context opens a driver, which takes longer than what is asked of it here. */
hemi_context *fuzz_context(void);

/* hemi_bake_desc.memory_limit, of which the empty process is said to have 100 MiB: what is left is room for a twelfth
 * of the rays that a draft casts, so that a bake takes milliseconds. */
enum { FUZZ_MEMORY = 106 << 20 };

/* calls.c: those that take no file. */
void fuzz_meshopt(const uint8_t *bytes, size_t size);
void fuzz_scene(const uint8_t *bytes, size_t size);
void fuzz_bake(const uint8_t *bytes, size_t size);
void fuzz_config(const uint8_t *bytes, size_t size);
void fuzz_factor(const uint8_t *bytes, size_t size);

/* kept.c: what was kept of another bake. */
void fuzz_kept(const uint8_t *bytes, size_t size);
void fuzz_rows(const uint8_t *bytes, size_t size);
void fuzz_checkpoint(const uint8_t *bytes, size_t size);

#endif
