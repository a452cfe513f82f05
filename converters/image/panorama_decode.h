/* SPDX-License-Identifier: MIT
 * What radiance does the picture of a sky hold? Radiance's .hdr, OpenEXR's .exr or .pfm, told by the first bytes.
 */
#ifndef HEMIBAKE_IMAGE_PANORAMA_DECODE_H
#define HEMIBAKE_IMAGE_PANORAMA_DECODE_H

#include "image_decode.h"

#define PANORAMA_NOTE_SIZE 320

/* As the decoder of the format says; note as exr_decode's. hdr_image_free frees *out. */
hemi_result panorama_decode(const uint8_t *bytes, size_t size, hdr_image *out, char note[PANORAMA_NOTE_SIZE],
                            char message[IMAGE_MESSAGE_SIZE]);

#endif
