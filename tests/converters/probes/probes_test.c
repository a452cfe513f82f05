/* SPDX-License-Identifier: MIT
 * Does the reader give back what a probe file holds, and does it refuse every file that lies? */
#include "check.h"
#include "probes.h"

#include <stdlib.h>

enum { COUNT = 3, SIZE = 8 + 40 * COUNT };

static void put_uint32(unsigned char *bytes, uint32_t value) {
    for (int k = 0; k < 4; k++) bytes[k] = (unsigned char)(value >> (8 * k));
}

static void put_float(unsigned char *bytes, size_t row, int column, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_uint32(bytes + 8 + 40 * row + 4 * (size_t)column, bits);
}

/* Row r, column c holds 10 r + c, but the normal is +y and the error 0.5. */
static void make_file(unsigned char bytes[SIZE]) {
    memcpy(bytes, "HPRB", 4);
    put_uint32(bytes + 4, COUNT);
    for (size_t r = 0; r < COUNT; r++) {
        for (int c = 0; c < 9; c++) put_float(bytes, r, c, (float)(10 * r) + (float)c);
        for (int c = 3; c < 6; c++) put_float(bytes, r, c, c == 4 ? 1.0f : 0.0f);
        put_float(bytes, r, 9, 0.5f);
    }
}

static hemi_result parse(const unsigned char *bytes, size_t size, char *message) {
    probe_set set;
    hemi_result result = probe_set_parse(bytes, size, &set, message);
    if (result != HEMI_OK) CHECK(set.probes == NULL && set.count == 0 && message[0] != '\0');
    probe_set_destroy(&set);
    return result;
}

static void rows_come_back_in_order(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    probe_set set;
    make_file(bytes);
    CHECK_EQUAL(probe_set_parse(bytes, SIZE, &set, message), HEMI_OK);
    CHECK_EQUAL(set.count, COUNT);
    CHECK_NEAR(set.probes[2].position[1], 21.0, 0);
    CHECK_NEAR(set.probes[1].normal[1], 1.0, 0);
    CHECK_NEAR(set.probes[1].radiance[2], 18.0, 0);
    CHECK_NEAR(set.probes[0].standard_error, 0.5, 0);
    probe_set_destroy(&set);
}

static void every_truncation_is_refused(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    make_file(bytes);
    for (size_t size = 0; size < SIZE; size++) CHECK_EQUAL(parse(bytes, size, message), HEMI_ERROR_DATA);
}

static void a_wrong_magic_is_refused(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    make_file(bytes);
    bytes[0] = 'h';
    CHECK_EQUAL(parse(bytes, SIZE, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, "HPRB"));
}

static void a_count_that_the_file_cannot_hold_is_refused(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    const uint32_t counts[] = { 0,         1, COUNT - 1, COUNT + 1, PROBES_COUNT_MAX,
                                107374183u /* 40 times it is 24 mod 2^32 */ };
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        make_file(bytes);
        put_uint32(bytes + 4, counts[i]);
        CHECK(parse(bytes, SIZE, message) != HEMI_OK);
    }
    put_uint32(bytes + 4, UINT32_MAX);
    CHECK_EQUAL(parse(bytes, SIZE, message), HEMI_ERROR_LIMIT);
}

static void values_that_are_not_finite_are_refused_wherever_they_are(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    const float bad[] = { NAN, INFINITY, -INFINITY };
    for (int c = 0; c < 10; c++)
        for (int i = 0; i < 3; i++) {
            make_file(bytes);
            put_float(bytes, 1, c, bad[i]);
            CHECK_EQUAL(parse(bytes, SIZE, message), HEMI_ERROR_DATA);
            CHECK(strstr(message, "probe 1 "));
        }
}

static void normals_that_are_not_unit_are_refused(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    make_file(bytes);
    put_float(bytes, 2, 4, 0.0f);
    CHECK_EQUAL(parse(bytes, SIZE, message), HEMI_ERROR_DATA);
    put_float(bytes, 2, 4, 1e30f);
    CHECK_EQUAL(parse(bytes, SIZE, message), HEMI_ERROR_DATA);
}

static void negative_standard_errors_are_refused(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    make_file(bytes);
    put_float(bytes, 0, 9, -0.1f);
    CHECK_EQUAL(parse(bytes, SIZE, message), HEMI_ERROR_DATA);
}

static void a_file_on_disk_reads_like_its_bytes(void) {
    unsigned char bytes[SIZE];
    char message[PROBES_MESSAGE_SIZE];
    char path[] = "/tmp/hemibake-probes-XXXXXX";
    probe_set set;
    int descriptor = mkstemp(path);
    CHECK(descriptor >= 0);
    FILE *file = fdopen(descriptor, "wb");
    make_file(bytes);
    CHECK(file && fwrite(bytes, 1, SIZE, file) == SIZE && fclose(file) == 0);
    CHECK_EQUAL(probe_set_read(path, NULL, &set, message), HEMI_OK);
    CHECK_EQUAL(set.count, COUNT);
    probe_set_destroy(&set);
    remove(path);
    CHECK_EQUAL(probe_set_read(path, NULL, &set, message), HEMI_ERROR_FILE);
    CHECK(set.probes == NULL && strstr(message, "cannot be opened"));
}

static void a_folder_is_no_probe_file(void) {
    char message[PROBES_MESSAGE_SIZE];
    probe_set set;
    CHECK(probe_set_read("/", NULL, &set, message) != HEMI_OK);
    CHECK(set.probes == NULL && message[0] != '\0');
}

int main(void) {
    RUN(rows_come_back_in_order);
    RUN(every_truncation_is_refused);
    RUN(a_wrong_magic_is_refused);
    RUN(a_count_that_the_file_cannot_hold_is_refused);
    RUN(values_that_are_not_finite_are_refused_wherever_they_are);
    RUN(normals_that_are_not_unit_are_refused);
    RUN(negative_standard_errors_are_refused);
    RUN(a_file_on_disk_reads_like_its_bytes);
    RUN(a_folder_is_no_probe_file);
    return check_end();
}
