/* SPDX-License-Identifier: MIT
 * Which points of a scene have a known radiance? Reads a .hprb file and believes none of its numbers. */
#include "probes.h"

#include "file_read.h"

#include "geometry/vec3.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_SIZE = 8, ROW_FLOATS = 10, ROW_SIZE = 4 * ROW_FLOATS };
_Static_assert(sizeof(probe) == ROW_SIZE, "a probe is a row of the file");

/* float32 normals are unit to 1e-7; a writer that rounds them to 16 bits is off by 1e-4. */
#define NORMAL_TOLERANCE 1e-3

hemi_result probes_fail(hemi_result result, char *message, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, PROBES_MESSAGE_SIZE, format, arguments);
    va_end(arguments);
    return result;
}

static uint32_t read_uint32(const unsigned char *bytes) {
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void read_row(const unsigned char *bytes, float row[ROW_FLOATS]) {
    for (int k = 0; k < ROW_FLOATS; k++) {
        uint32_t bits = read_uint32(bytes + 4 * k);
        memcpy(&row[k], &bits, sizeof bits);
    }
}

/* What is wrong with a row, or NULL. */
static const char *row_fault(const float row[ROW_FLOATS]) {
    for (int k = 0; k < ROW_FLOATS; k++)
        if (!isfinite(row[k])) return "holds a value that is not finite";
    double length = sqrt(vec3_dot_floats(row + 3, row + 3));
    if (fabs(length - 1.0) > NORMAL_TOLERANCE) return "has a normal that is not of length 1";
    if (row[9] < 0.0f) return "has a negative standard error";
    return NULL;
}

static hemi_result check_header(const unsigned char *bytes, size_t size, uint32_t *count, char *message) {
    if (size < HEADER_SIZE || memcmp(bytes, "HPRB", 4) != 0)
        return probes_fail(HEMI_ERROR_DATA, message, "not a probe file: it does not begin with HPRB and a count");
    *count = read_uint32(bytes + 4);
    if (*count == 0) return probes_fail(HEMI_ERROR_DATA, message, "the probe file holds no probes");
    if (*count > PROBES_COUNT_MAX)
        return probes_fail(HEMI_ERROR_LIMIT, message, "the probe file claims %lu probes; at most %lu are read",
                           (unsigned long)*count, (unsigned long)PROBES_COUNT_MAX);
    size_t expected = HEADER_SIZE + (size_t)*count * ROW_SIZE;
    if (size != expected)
        return probes_fail(HEMI_ERROR_DATA, message, "the probe file has %zu bytes; %lu probes take %zu", size,
                           (unsigned long)*count, expected);
    return HEMI_OK;
}

hemi_result probe_set_parse(const void *bytes, size_t size, probe_set *out, char message[PROBES_MESSAGE_SIZE]) {
    const unsigned char *rows = (const unsigned char *)bytes + HEADER_SIZE;
    uint32_t count = 0;
    *out = (probe_set){ 0 };
    message[0] = '\0';
    hemi_result result = check_header(bytes, size, &count, message);
    if (result != HEMI_OK) return result;
    probe *probes = malloc(count * sizeof *probes);
    if (!probes) return probes_fail(HEMI_ERROR_MEMORY, message, "out of memory for %lu probes", (unsigned long)count);
    for (size_t i = 0; i < count; i++) {
        float row[ROW_FLOATS];
        read_row(rows + i * ROW_SIZE, row);
        const char *fault = row_fault(row);
        if (fault) {
            free(probes);
            return probes_fail(HEMI_ERROR_DATA, message, "probe %zu %s", i, fault);
        }
        memcpy(&probes[i], row, sizeof row);
    }
    *out = (probe_set){ probes, count };
    return HEMI_OK;
}

hemi_result probe_set_read(const char *path, const char *root, probe_set *out, char message[PROBES_MESSAGE_SIZE]) {
    const uint64_t largest = HEADER_SIZE + (uint64_t)PROBES_COUNT_MAX * ROW_SIZE;
    char reason[FILE_MESSAGE_SIZE];
    uint8_t *bytes;
    size_t size;
    *out = (probe_set){ 0 };
    message[0] = '\0';
    hemi_result result = file_read_bytes(path, root, largest, &bytes, &size, reason);
    if (result != HEMI_OK) return probes_fail(result, message, "the probe file: %s", reason);
    result = probe_set_parse(bytes, size, out, message);
    free(bytes);
    return result;
}

void probe_set_destroy(probe_set *set) {
    if (!set) return;
    free(set->probes);
    *set = (probe_set){ 0 };
}
