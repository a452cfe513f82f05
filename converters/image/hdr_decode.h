/* SPDX-License-Identifier: MIT
 * What radiance does a picture in the Radiance format (.hdr) hold?
 */
#ifndef HEMIBAKE_IMAGE_HDR_DECODE_H
#define HEMIBAKE_IMAGE_HDR_DECODE_H

#include <hemibake/hemibake.h>

#define HDR_MESSAGE_SIZE 160

/* Pixels of a picture at most: a panorama of 16384 x 8192. */
#define HDR_PIXELS_MAX (UINT64_C(1) << 27)

typedef struct hdr_image {
    float *rgb; /* rgb[3*(row*width+column)+c], row 0 on top, finite and not negative; from malloc */
    uint32_t width, height;
} hdr_image;

/* bytes: of the file. HEMI_ERROR_DATA: not such a picture, or cut short; HEMI_ERROR_LIMIT, HEMI_ERROR_MEMORY. message
 * says what is wrong. */
hemi_result hdr_decode(const uint8_t *bytes, size_t size, hdr_image *out, char message[HDR_MESSAGE_SIZE]);
void hdr_image_free(hdr_image *image); /* leaves it empty */

#endif
