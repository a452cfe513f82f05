/* SPDX-License-Identifier: MIT
 * What radiance does a portable float map (.pfm) hold? Numbers as they are, which .hdr rounds to one in 256.
 */
#ifndef HEMIBAKE_IMAGE_PFM_DECODE_H
#define HEMIBAKE_IMAGE_PFM_DECODE_H

#include "image_decode.h"

/* Do the first bytes say so? */
bool pfm_is_it(const uint8_t *bytes, size_t size);

/* "PF", width, height, a negative scale (little-endian) and floats, the lowest row first. Codes and message as
 * hdr_decode; hdr_image_free frees it. */
hemi_result pfm_decode(const uint8_t *bytes, size_t size, hdr_image *out, char message[IMAGE_MESSAGE_SIZE]);

#endif
