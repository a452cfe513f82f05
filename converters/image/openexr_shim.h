/* SPDX-License-Identifier: MIT
 * What are the pixels of a part that only OpenEXR's C++ library decompresses, as 3.1 does DWAA and DWAB?
 */
#ifndef HEMIBAKE_IMAGE_OPENEXR_SHIM_H
#define HEMIBAKE_IMAGE_OPENEXR_SHIM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum openexr_status { OPENEXR_READ, OPENEXR_MALFORMED, OPENEXR_NO_MEMORY } openexr_status;

/* A row of the data window, values[3*i+k] of channel k at its i-th column. */
typedef void (*openexr_row_fn)(void *user, int32_t y, const float *values);

/* Three channels of a part by their names, which may be one and the same; where a row is missing none is said, and the
 * picture is malformed. */
openexr_status openexr_read_part(const uint8_t *bytes, size_t size, int part, const char *const channel[3],
                                 openexr_row_fn row, void *user);

#ifdef __cplusplus
}
#endif

#endif
