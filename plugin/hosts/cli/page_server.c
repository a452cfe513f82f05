/* SPDX-License-Identifier: MIT
 * HTTP/1.1 as little as a browser needs: GET, one answer a connection. Browsers open connections ahead and leave them
 * idle, so all are waited for at once. A page elsewhere that had its name mean 127.0.0.1 would be served if Host were
 * not looked at.
 */
#include "page_server.h"

#include "file_read.h"
#include "path_text.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

enum { CONNECTIONS = 64, REQUEST_SIZE = 8192, PATIENCE_S = 10 };

typedef struct connection {
    int socket;
    size_t length;
    char request[REQUEST_SIZE + 1];
} connection;

bool page_server_open(page_server *s, uint16_t port, const char **reason) {
    struct sockaddr_in at = { .sin_family = AF_INET,
                              .sin_port = htons(port),
                              .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    socklen_t size = sizeof at;
    int yes = 1;
    s->listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bool ok = s->listener >= 0 && setsockopt(s->listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
              bind(s->listener, (struct sockaddr *)&at, size) == 0 && listen(s->listener, CONNECTIONS) == 0 &&
              getsockname(s->listener, (struct sockaddr *)&at, &size) == 0;
    if (!ok) *reason = strerror(errno);
    s->port = ntohs(at.sin_port);
    return ok;
}

/* ---- answers ----------------------------------------------------------------------------------------------------- */

static bool send_all(int to, const void *bytes, size_t size) {
    for (const char *at = bytes; size > 0;) {
        ssize_t sent = send(to, at, size, MSG_NOSIGNAL);
        if (sent <= 0) return false;
        at += sent, size -= (size_t)sent;
    }
    return true;
}

static const char *type_of(const char *name) {
    static const char *const types[][2] = { { ".html", "text/html; charset=utf-8" },
                                            { ".js", "text/javascript" },
                                            { ".json", "application/json" },
                                            { ".wasm", "application/wasm" },
                                            { ".glb", "model/gltf-binary" },
                                            { ".gltf", "model/gltf+json" },
                                            { ".png", "image/png" },
                                            { ".jpg", "image/jpeg" } };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (path_ends_in(name, types[i][0])) return types[i][1];
    return "application/octet-stream";
}

static void answer(int to, const char *status, const char *type, const void *bytes, size_t size) {
    char head[512];
    int length = snprintf(head, sizeof head,
                          "HTTP/1.1 %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\nCache-Control: no-store\r\n"
                          "X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
                          status, type, size);
    if (send_all(to, head, (size_t)length)) send_all(to, bytes, size);
}

static void refuse(int to, const char *status) {
    answer(to, status, "text/plain", status, strlen(status));
}

/* ---- requests ---------------------------------------------------------------------------------------------------- */

/* The path of a request line without its query, unescaped; false: it is none, or is meant to lead elsewhere. */
static bool take_path(const char *line, char out[PATH_SIZE]) {
    size_t length = 0;
    if (strncmp(line, "GET /", 5) != 0) return false;
    for (const char *c = line + 5; *c && !strchr(" ?#\r\n", *c); c++) {
        int high = *c == '%' ? path_hex_digit(c[1]) : 0, low = *c == '%' && high >= 0 ? path_hex_digit(c[2]) : 0;
        if (high < 0 || low < 0 || length + 1 >= PATH_SIZE) return false;
        out[length] = *c == '%' ? (char)(16 * high + low) : *c;
        if (*c == '%') c += 2;
        if (out[length++] == 0) return false;
    }
    out[length] = 0;
    return strncmp(out, "../", 3) != 0 && !strstr(out, "/../") && out[0] != '/';
}

/* Does the browser mean this machine by the name that it used? */
static bool is_for_us(const char *request) {
    const char *host = strcasestr(request, "\nHost:");
    if (!host) return false;
    host += strlen("\nHost:");
    host += strspn(host, " ");
    size_t length = strcspn(host, ":\r\n ");
    return (length == 9 && (strncmp(host, "127.0.0.1", 9) == 0 || strncasecmp(host, "localhost", 9) == 0));
}

static void send_file(int to, const page_folder *folder, const char *rest) {
    char path[2 * PATH_SIZE], message[FILE_MESSAGE_SIZE];
    uint8_t *bytes = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, "%s/%s", folder->path, *rest ? rest : "index.html");
    if (file_read_bytes(path, folder->path, UINT64_MAX, &bytes, &size, message) == HEMI_OK)
        answer(to, "200 OK", type_of(path), bytes, size);
    else
        refuse(to, "404 Not Found");
    free(bytes);
}

static void serve(const page_server *s, const connection *c) {
    char path[PATH_SIZE];
    if (!is_for_us(c->request)) return refuse(c->socket, "403 Forbidden");
    if (!take_path(c->request, path)) return refuse(c->socket, "400 Bad Request");
    for (size_t i = 0; i < s->text_count; i++)
        if (strcmp(path, s->texts[i].name) == 0)
            return answer(c->socket, "200 OK", type_of(path), s->texts[i].bytes, s->texts[i].size);
    for (size_t i = 0; i < s->folder_count; i++) {
        size_t length = strlen(s->folders[i].prefix);
        if (strncmp(path, s->folders[i].prefix, length) != 0 || (length > 0 && path[length] != '/')) continue;
        return send_file(c->socket, &s->folders[i], path + length + (length > 0));
    }
    refuse(c->socket, "404 Not Found");
}

/* ---- connections ------------------------------------------------------------------------------------------------- */

static void hang_up(connection *c) {
    close(c->socket);
    *c = (connection){ .socket = -1 };
}

static void receive(const page_server *s, connection *c) {
    ssize_t got = recv(c->socket, c->request + c->length, REQUEST_SIZE - c->length, 0);
    if (got > 0) c->length += (size_t)got;
    c->request[c->length] = 0;
    bool is_whole = strstr(c->request, "\r\n\r\n") != NULL;
    if (got > 0 && !is_whole && c->length < REQUEST_SIZE) return;
    if (is_whole) serve(s, c);
    hang_up(c);
}

/* Where there is no room the one that came first goes: nothing has come from it for the longest time. */
static void accept_one(const page_server *s, connection *all, size_t *next) {
    const struct timeval patience = { .tv_sec = PATIENCE_S };
    int socket = accept4(s->listener, NULL, NULL, SOCK_CLOEXEC);
    if (socket < 0) return;
    setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    connection *c = &all[(*next)++ % CONNECTIONS];
    if (c->socket >= 0) hang_up(c);
    c->socket = socket;
}

void page_server_run(const page_server *s) {
    connection *all = calloc(CONNECTIONS, sizeof *all);
    struct pollfd watched[CONNECTIONS + 1];
    size_t next = 0;
    for (size_t i = 0; all && i < CONNECTIONS; i++) all[i].socket = -1;
    while (all) {
        for (size_t i = 0; i < CONNECTIONS; i++) watched[i] = (struct pollfd){ .fd = all[i].socket, .events = POLLIN };
        watched[CONNECTIONS] = (struct pollfd){ .fd = s->listener, .events = POLLIN };
        if (poll(watched, CONNECTIONS + 1, -1) < 0) continue;
        for (size_t i = 0; i < CONNECTIONS; i++)
            if (watched[i].revents) receive(s, &all[i]);
        if (watched[CONNECTIONS].revents) accept_one(s, all, &next);
    }
}
