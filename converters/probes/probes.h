/* SPDX-License-Identifier: MIT
 * Which points of a scene have a known radiance?
 *
 * A .hprb file, little-endian: the four bytes "HPRB", uint32 count, then count rows of ten float32: position x y z
 * (world, metres), unit normal x y z, outgoing radiance r g b (W/m2/sr), standard error of the mean of each band.
 * The probes lie on the fronts of surfaces, uniform by area, so that a plain sum over them is an integral over area.
 */
#ifndef HEMIBAKE_PROBES_PROBES_H
#define HEMIBAKE_PROBES_PROBES_H

#include <hemibake/hemibake.h>

enum { PROBES_MESSAGE_SIZE = 280 };

/* 640 MB of rows; a larger count is a damaged file sooner than a measurement. */
#define PROBES_COUNT_MAX 16000000u

typedef struct probe {
    float position[3], normal[3], radiance[3], standard_error;
} probe;

typedef struct probe_set {
    probe *probes; /* owned; probe_set_destroy */
    size_t count;
} probe_set;

/* Reads the bytes of a file. HEMI_ERROR_DATA: no probe file, a size that does not fit the count, a value that is not
 * finite, a normal that is not unit, a negative error; HEMI_ERROR_LIMIT: more than PROBES_COUNT_MAX probes;
 * HEMI_ERROR_MEMORY. message gets one line that says what is wrong and where; out is empty then. */
hemi_result probe_set_parse(const void *bytes, size_t size, probe_set *out, char message[PROBES_MESSAGE_SIZE]);

/* The same from a file; HEMI_ERROR_FILE if it cannot be read. */
hemi_result probe_set_read(const char *path, const char *root, probe_set *out, char message[PROBES_MESSAGE_SIZE]);

void probe_set_destroy(probe_set *set); /* NULL and empty are fine */

/* Writes the message of a failure in this folder; its code. */
hemi_result probes_fail(hemi_result result, char *message, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
