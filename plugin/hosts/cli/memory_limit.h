/* SPDX-License-Identifier: MIT
 * What if a bake takes more memory than was predicted? Under --memory what the library asks for is counted, on top of
 * what the process has by then, and refused past the limit: the bake ends with a line, as for want of memory.
 */
#ifndef HEMIBAKE_CLI_MEMORY_LIMIT_H
#define HEMIBAKE_CLI_MEMORY_LIMIT_H

#include <hemibake/hemibake.h>

typedef struct memory_limit memory_limit;

/* Of the process from now on; NULL: out of memory. Lives as long as what it gave. */
memory_limit *memory_limit_create(uint64_t bytes);
void memory_limit_destroy(memory_limit *m); /* NULL is fine */

hemi_allocator memory_limit_allocator(memory_limit *m);
/* The process has more by now that the library does not know of, and what it had before. */
void memory_limit_count(memory_limit *m);
uint64_t memory_limit_left(const memory_limit *m); /* bytes that the process may still take */
bool memory_limit_refused(const memory_limit *m);  /* NULL: nothing was */
uint64_t memory_limit_bytes(const memory_limit *m);

#endif
