/* SPDX-License-Identifier: MIT
 * Is a file read whole, within its limit and its root, and is what is no file refused without waiting?
 */
#define _GNU_SOURCE
#include "check.h"
#include "file_read.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char message[FILE_MESSAGE_SIZE];
static char folder[] = "/tmp/hemibake-file-XXXXXX";

static const char *at(const char *name) {
    static char paths[4][128];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void put(const char *name, const char *text) {
    FILE *f = fopen(at(name), "w");
    CHECK(f != NULL);
    if (!f) return;
    fputs(text, f);
    fclose(f);
}

static hemi_result read_it(const char *path, const char *root, uint64_t most, const char *expected) {
    uint8_t *bytes;
    size_t size;
    hemi_result result = file_read_bytes(path, root, most, &bytes, &size, message);
    CHECK((result == HEMI_OK) == (bytes != NULL));
    CHECK((result == HEMI_OK) == (message[0] == 0));
    if (result == HEMI_OK) CHECK(size == strlen(expected) && memcmp(bytes, expected, size) == 0);
    free(bytes);
    return result;
}

static void a_file_is_read_up_to_its_limit(void) {
    put("a", "twelve bytes");
    put("empty", "");
    CHECK_EQUAL(read_it(at("a"), NULL, 12, "twelve bytes"), HEMI_OK);
    CHECK_EQUAL(read_it(at("empty"), NULL, 12, ""), HEMI_OK);
    CHECK_EQUAL(read_it(at("a"), NULL, 11, ""), HEMI_ERROR_LIMIT);
}

static void what_is_no_file_is_refused(void) {
    mkfifo(at("pipe"), 0600);
    CHECK_EQUAL(read_it(at("nothing"), NULL, 99, ""), HEMI_ERROR_FILE);
    CHECK_EQUAL(read_it(folder, NULL, 99, ""), HEMI_ERROR_FILE);
    CHECK_EQUAL(read_it("/dev/zero", NULL, 99, ""), HEMI_ERROR_FILE);
    CHECK_EQUAL(read_it(at("pipe"), NULL, 99, ""), HEMI_ERROR_FILE);
    CHECK(strstr(message, "nobody writes") != NULL);
}

static void a_fifo_with_a_writer_is_read_up_to_its_limit(void) {
    char path[32];
    for (int most = 11; most <= 12; most++) {
        int ends[2];
        CHECK_EQUAL(pipe(ends), 0);
        CHECK_EQUAL(write(ends[1], "twelve bytes", 12), 12);
        close(ends[1]);
        snprintf(path, sizeof path, "/proc/self/fd/%d", ends[0]);
        CHECK_EQUAL(read_it(path, NULL, (uint64_t)most, "twelve bytes"), most == 12 ? HEMI_OK : HEMI_ERROR_LIMIT);
        close(ends[0]);
    }
}

static void a_hole_is_refused(void) {
    put("hole", "");
    CHECK_EQUAL(truncate(at("hole"), (off_t)1 << 30), 0);
    CHECK_EQUAL(read_it(at("hole"), NULL, UINT64_C(1) << 31, ""), HEMI_ERROR_FILE);
    CHECK(strstr(message, "holes") != NULL);
}

static void the_root_holds_against_dots_and_links(void) {
    mkdir(at("in"), 0700);
    mkdir(at("inside"), 0700); /* begins with the same letters */
    put("in/a", "in");
    put("inside/b", "out");
    put("c", "out");
    CHECK_EQUAL(symlink("../c", at("in/link")), 0);
    CHECK_EQUAL(symlink("..", at("in/up")), 0);
    CHECK_EQUAL(symlink("in/a", at("into")), 0);
    CHECK_EQUAL(read_it(at("in/a"), at("in"), 99, "in"), HEMI_OK);
    CHECK_EQUAL(read_it(at("into"), at("in"), 99, "in"), HEMI_OK);
    CHECK_EQUAL(read_it(at("in/a"), "/", 99, "in"), HEMI_OK);
    static const char *const outside[] = { "c", "in/../c", "in/link", "in/up/c", "inside/b" };
    for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
        CHECK_EQUAL(read_it(at(outside[i]), at("in"), 99, ""), HEMI_ERROR_FILE);
        CHECK(strstr(message, "outside") != NULL);
        CHECK(!file_is_plain(at(outside[i]), at("in"), message) && strstr(message, "outside"));
        CHECK(file_is_plain(at(outside[i]), NULL, message));
    }
    CHECK(file_is_plain(at("in/a"), at("in"), message) && !*message);
    CHECK_EQUAL(read_it(at("in/a"), at("no such root"), 99, ""), HEMI_ERROR_FILE);
}

static void what_others_open_is_no_fifo(void) {
    CHECK_EQUAL(mkfifo(at("fifo"), 0600), 0);
    CHECK(!file_is_plain(at("fifo"), NULL, message) && strstr(message, "FIFO"));
    CHECK(!file_is_plain("/dev/null", NULL, message) && !file_is_plain(folder, NULL, message));
    CHECK(!file_is_plain(at("nothing"), NULL, message) && strstr(message, "check the path"));
    unlink(at("fifo"));
}

static void remove_all(void) {
    static const char *const names[] = { "a",       "empty", "pipe", "hole",     "in/a",
                                         "in/link", "in/up", "into", "inside/b", "c" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) unlink(at(names[i]));
    rmdir(at("in"));
    rmdir(at("inside"));
    rmdir(folder);
}

int main(void) {
    if (!mkdtemp(folder)) return 1;
    RUN(a_file_is_read_up_to_its_limit);
    RUN(what_is_no_file_is_refused);
    RUN(a_fifo_with_a_writer_is_read_up_to_its_limit);
    RUN(a_hole_is_refused);
    RUN(the_root_holds_against_dots_and_links);
    RUN(what_others_open_is_no_fifo);
    remove_all();
    return check_end();
}
