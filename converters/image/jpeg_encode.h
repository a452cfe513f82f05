/* SPDX-License-Identifier: MIT
 * What are the bytes of these pixels as a JPEG file? For pictures that are shown, not measured: it loses a little.
 */
#ifndef HEMIBAKE_IMAGE_JPEG_ENCODE_H
#define HEMIBAKE_IMAGE_JPEG_ENCODE_H

#include <hemibake/hemibake.h>

/* As png_encode, without alpha; HEMI_ERROR_LIMIT: an edge above PNG_ENCODE_EDGE_MAX. */
hemi_result jpeg_encode(const uint8_t *rgba, uint32_t width, uint32_t height, unsigned char **bytes, size_t *size);

#endif
