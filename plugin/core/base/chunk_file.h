/* SPDX-License-Identifier: MIT
 * How are arrays kept in a file so that damage shows? One after the other, each with a tag, its size and a checksum:
 *
 *     magic, 8 bytes | version, 4 | byte order, 4
 *     tag, 4 | 0, 4 | size, 8 | bytes ... | checksum, 8      as often as there are arrays
 *     "end " | 0 | 0 | checksum
 *
 * A checksum (XXH3, 64 bits) is of tag, size, bytes and all checksums before it, so that a chunk of another file, or in
 * another place, is none of this one. Numbers lie as the machine has them, and a machine that has them the other way
 * round refuses the file.
 *
 * The reader knows what it expects: a chunk with another tag, or not of the size that was asked for, is a fault, as is
 * anything after the end. It asks for memory as bytes arrive, so that a size that lies costs no more than twice the
 * file. What the numbers mean, and whether indices are in range, is for whoever asked.
 *
 * Where bytes go and come from is the caller's: a file that appears whole or not at all, or memory.
 */
#ifndef HEMIBAKE_CORE_BASE_CHUNK_FILE_H
#define HEMIBAKE_CORE_BASE_CHUNK_FILE_H

#include "base/block.h"

#include <stdint.h>

/* Says false when not all could be written. */
typedef bool (*chunk_write_fn)(void *user, const void *bytes, size_t size);
/* How many bytes were read; fewer than were asked for: there are no more. */
typedef size_t (*chunk_read_fn)(void *user, void *bytes, size_t size);

typedef struct chunk_writer {
    chunk_write_fn write;
    void *user;
    uint64_t checksum; /* of all before */
    bool failed;       /* nothing is written any more */
} chunk_writer;

/* magic: 8 characters; tag: 4. */
void chunk_write_begin(chunk_writer *w, const char *magic, uint32_t version);
void chunk_write(chunk_writer *w, const char *tag, const void *bytes, size_t size);
bool chunk_write_end(chunk_writer *w); /* false: something could not be written */

typedef enum chunk_fault {
    CHUNK_FINE,
    CHUNK_OTHER_KIND,    /* the magic is another one, or the byte order */
    CHUNK_OTHER_VERSION, /* which chunk_reader.version says */
    CHUNK_TRUNCATED,
    CHUNK_DAMAGED,    /* a checksum is wrong, or there is more after the end */
    CHUNK_UNEXPECTED, /* another tag or size than was asked for */
    CHUNK_NO_MEMORY
} chunk_fault;

typedef struct chunk_reader {
    chunk_read_fn read;
    void *user;
    allocator *memory;
    uint64_t checksum;
    uint32_t version;  /* of the file, once begun */
    chunk_fault fault; /* nothing is read any more */
} chunk_reader;

bool chunk_read_begin(chunk_reader *r, const char *magic, uint32_t version);
/* Exactly so many bytes. */
bool chunk_read_into(chunk_reader *r, const char *tag, void *bytes, size_t size);
/* As many as there are, in a block of its own, which is never NULL where this succeeds; false where their number is no
 * multiple of `unit`. *count: of units. */
bool chunk_read_block(chunk_reader *r, const char *tag, size_t unit, void **block, size_t *count);
bool chunk_read_end(chunk_reader *r);

/* What became of a file, as the end of a sentence that begins with its name. */
const char *chunk_fault_text(chunk_fault fault);

/* Bytes in memory, for either: bytes[used ..] are read or written next. */
typedef struct chunk_memory {
    allocator *memory;
    unsigned char *bytes;
    size_t size, used; /* size: when written to, what there is room for */
} chunk_memory;

bool chunk_memory_write(void *chunk_memory, const void *bytes, size_t size); /* grows it; the bytes are a block */
size_t chunk_memory_read(void *chunk_memory, void *bytes, size_t size);

/* The same bytes, the same number; another seed, another number. For keys of what must not change. */
uint64_t chunk_digest(const void *bytes, size_t size, uint64_t seed);

#endif
