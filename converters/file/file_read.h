/* SPDX-License-Identifier: MIT
 * Which bytes does a file hold that a stranger may have named? A regular file, or a FIFO that somebody writes to; never
 * a device, which could block, never end, or do something by being opened.
 *
 * root confines: what is opened must lie in that folder once links are followed. It is checked on the file that has
 * been found, not on its name, so that no link can change in between.
 */
#ifndef HEMIBAKE_FILE_FILE_READ_H
#define HEMIBAKE_FILE_FILE_READ_H

#include <hemibake/hemibake.h>

HEMI_C_BEGIN

#define FILE_MESSAGE_SIZE 240

/* Room for size bytes that keeps what was there; NULL: there is no memory. */
typedef uint8_t *(*file_room_fn)(void *user, size_t size);

/* Reads all of the file, at most `most` bytes, into what room last gave; it is asked before bytes come, never for more
 * than twice what came, and last for the very size. root NULL: any folder. HEMI_ERROR_FILE: it cannot be opened or
 * read, lies outside of root, is a device or a folder, or mostly holes; a FIFO that nobody begins to write to in two
 * seconds. HEMI_ERROR_LIMIT: it is longer. HEMI_ERROR_MEMORY. message says what is wrong, without the file's name. */
hemi_result file_read(const char *path, const char *root, uint64_t most, file_room_fn room, void *user, size_t *size,
                      char message[FILE_MESSAGE_SIZE]);

/* The same into *bytes, from malloc; NULL on failure. */
hemi_result file_read_bytes(const char *path, const char *root, uint64_t most, uint8_t **bytes, size_t *size,
                            char message[FILE_MESSAGE_SIZE]);

/* Whether somebody else, who opens it by its name, will find a file there that has an end: a regular one, in root
 * (NULL: anywhere). message as above if not. */
bool file_is_plain(const char *path, const char *root, char message[FILE_MESSAGE_SIZE]);

HEMI_C_END
#endif
