/* SPDX-License-Identifier: MIT
 * Which pixels does an encoded picture hold? PNG (libpng), JPEG (libjpeg-turbo) and WebP (libwebp), told by their first
 * bytes; and as radiance, the Radiance format .hdr (stb_image).
 */
#ifndef HEMIBAKE_IMAGE_IMAGE_DECODE_H
#define HEMIBAKE_IMAGE_IMAGE_DECODE_H

#include <hemibake/hemibake.h>

HEMI_C_BEGIN

#define IMAGE_MESSAGE_SIZE 160

/* Pixels of a picture at most, 5792 x 5792, where nobody asks for more: a small file can ask for much memory. */
#define IMAGE_PIXELS_DEFAULT (UINT64_C(1) << 25)

typedef struct image_pixels {
    uint8_t *rgba; /* rgba[4*(row*width+column)+c], row 0 on top, alpha not premultiplied; from malloc */
    uint32_t width, height;
} image_pixels;

/* HEMI_ERROR_UNSUPPORTED: another format. HEMI_ERROR_DATA: malformed, or cut short. HEMI_ERROR_LIMIT: more than
 * most pixels. HEMI_ERROR_MEMORY. message says what is wrong; *out is empty then. Safe from any thread. */
hemi_result image_decode(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out,
                         char message[IMAGE_MESSAGE_SIZE]);
void image_pixels_free(image_pixels *pixels); /* leaves it empty */

/* Pixels of a picture at most: a panorama of 16384 x 8192. */
#define HDR_PIXELS_MAX (UINT64_C(1) << 27)

typedef struct hdr_image {
    float *rgb; /* rgb[3*(row*width+column)+c], row 0 on top, finite and not negative; from malloc */
    uint32_t width, height;
} hdr_image;

/* Sets the message of a decoder, and returns the result. */
hemi_result image_fail(hemi_result result, const char *text, char *message);

/* bytes: of the file. HEMI_ERROR_DATA: not such a picture, or cut short; HEMI_ERROR_LIMIT, HEMI_ERROR_MEMORY. message
 * says what is wrong. */
hemi_result hdr_decode(const uint8_t *bytes, size_t size, hdr_image *out, char message[IMAGE_MESSAGE_SIZE]);
void hdr_image_free(hdr_image *image); /* leaves it empty */

HEMI_C_END
#endif
