/* SPDX-License-Identifier: MIT
 * What are the bytes of these pixels as a PNG file?
 *
 * Frame: row 0 is the top of the picture. Values are display code values of sRGB, 8 bits a channel; alpha is not
 * premultiplied. The file carries an sRGB chunk.
 */
#ifndef HEMIBAKE_IMAGE_PNG_ENCODE_H
#define HEMIBAKE_IMAGE_PNG_ENCODE_H

#include <hemibake/hemibake.h>

/* Pixels along one edge at most: a square of it is 1 GiB of pixels, the most that libpng's 32-bit sizes hold twice. */
#define PNG_ENCODE_EDGE_MAX 16384

/* rgba[4*(y*width+x)+c]. *bytes is malloc'ed and belongs to the caller (free); NULL and 0 on failure.
 * HEMI_ERROR_ARGUMENT: a null pointer or an edge of 0 pixels. HEMI_ERROR_LIMIT: an edge above PNG_ENCODE_EDGE_MAX.
 * HEMI_ERROR_MEMORY. Safe from any thread. */
hemi_result png_encode(const uint8_t *rgba, uint32_t width, uint32_t height, unsigned char **bytes, size_t *size);

#endif
