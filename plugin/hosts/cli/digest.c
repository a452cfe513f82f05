/* SPDX-License-Identifier: MIT */
#include "digest.h"

#include <sha256.h>

bool digest_file(const char *path, char digest[65]) {
    return SHA256File(path, digest) != NULL;
}

void digest_text(const char *text, size_t size, char digest[65]) {
    SHA256Data((const uint8_t *)text, size, digest);
}
