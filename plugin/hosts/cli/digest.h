/* SPDX-License-Identifier: MIT
 * Are these the same bytes as those? SHA-256, as 64 hexadecimal digits.
 */
#ifndef HEMIBAKE_CLI_DIGEST_H
#define HEMIBAKE_CLI_DIGEST_H

#include <stdbool.h>
#include <stddef.h>

/* False if it cannot be read. */
bool digest_file(const char *path, char digest[65]);

void digest_text(const char *text, size_t size, char digest[65]);

#endif
