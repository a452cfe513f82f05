/* SPDX-License-Identifier: MIT
 * What are the bytes of these channels as an OpenEXR file? As OpenEXRCore writes them; into memory.
 */
#ifndef HEMIBAKE_TESTS_EXR_FILE_H
#define HEMIBAKE_TESTS_EXR_FILE_H

#include <openexr.h>

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { EXR_FILE_CHANNELS = 6 };

/* The value of a channel at a place of the data window. */
typedef double (*exr_file_value)(int channel, int x, int y);

typedef struct exr_file {
    const char *channels[EXR_FILE_CHANNELS]; /* in the order of the alphabet; NULL ends them */
    exr_pixel_type_t types[EXR_FILE_CHANNELS];
    exr_compression_t compression;
    exr_attr_box2i_t data, display;
    int tile; /* side of a tile; 0: scanlines */
    const exr_attr_chromaticities_t *primaries;
    bool is_cube;
    exr_file_value value;
} exr_file;

typedef struct exr_bytes {
    uint8_t *bytes;
    size_t size;
} exr_bytes;

/* Ends the program where it cannot be written; free() frees its bytes. */
exr_bytes exr_file_write(const exr_file *file);

/* The same of DWAA and DWAB, as floats; by OpenEXR's C++ library. */
exr_bytes exr_file_write_dwa(const exr_file *file);

#ifdef __cplusplus
}
#endif

#endif
