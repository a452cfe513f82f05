/* SPDX-License-Identifier: MIT
 * What radiance does an OpenEXR picture hold? Scanlines or tiles, of these the finest level; channels R, G, B, or Y.
 * OpenEXRCore reads and decompresses, and OpenEXR's C++ library DWAA and DWAB, which the core has from 3.4 on only.
 */
#ifndef HEMIBAKE_IMAGE_EXR_DECODE_H
#define HEMIBAKE_IMAGE_EXR_DECODE_H

#include "image_decode.h"

#define EXR_NOTE_SIZE 320

/* Do the first bytes say so? */
bool exr_is_it(const uint8_t *bytes, size_t size);

/* The picture is the display window, black where the data window has nothing. Numbers as they are, but what is negative
 * or not finite is 0, as in hdr_decode. Codes and message as hdr_decode's, and HEMI_ERROR_UNSUPPORTED: deep, luminance
 * and chroma, a cube map, or a compression that is newer than this OpenEXR. note, on success: what was chosen,
 * left out or changed; else empty. hdr_image_free frees *out. Safe from any thread. */
hemi_result exr_decode(const uint8_t *bytes, size_t size, hdr_image *out, char note[EXR_NOTE_SIZE],
                       char message[IMAGE_MESSAGE_SIZE]);

#endif
