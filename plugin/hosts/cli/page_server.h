/* SPDX-License-Identifier: MIT
 * How does a browser on this machine get what a page needs? From a few folders and texts, on 127.0.0.1 and from nowhere
 * else, until the process ends.
 */
#ifndef HEMIBAKE_CLI_PAGE_SERVER_H
#define HEMIBAKE_CLI_PAGE_SERVER_H

#include "console.h"

#include <stddef.h>
#include <stdint.h>

/* /prefix/rest is the file rest of the folder; "" is what no other prefix takes. What lies outside of the folder is not
 * served, links followed. */
typedef struct page_folder {
    const char *prefix, *path;
} page_folder;

/* Bytes that are in no file. */
typedef struct page_text {
    const char *name; /* without the slash */
    const void *bytes;
    size_t size;
} page_text;

typedef struct page_server {
    int listener;
    uint16_t port;
    const page_folder *folders;
    const page_text *texts;
    size_t folder_count, text_count;
} page_server;

/* port 0: any that is free. False: *reason says why. */
bool page_server_open(page_server *s, uint16_t port, const char **reason);

/* Answers until a signal ends the process. */
void page_server_run(const page_server *s);

#endif
