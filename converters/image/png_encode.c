/* SPDX-License-Identifier: MIT
 * What are the bytes of these pixels as a PNG file? libpng's simplified writer: one call, no longjmp in our frames, and
 * an sRGB chunk by itself because the pixels are declared 8-bit sRGB. */
#include "png_encode.h"

#include <png.h>
#include <stdlib.h>

hemi_result png_encode(const uint8_t *rgba, uint32_t width, uint32_t height, unsigned char **bytes, size_t *size) {
    if (!bytes || !size) return HEMI_ERROR_ARGUMENT;
    *bytes = NULL;
    *size = 0;
    if (!rgba || width == 0 || height == 0) return HEMI_ERROR_ARGUMENT;
    if (width > PNG_ENCODE_EDGE_MAX || height > PNG_ENCODE_EDGE_MAX) return HEMI_ERROR_LIMIT;
    png_image image = { .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGBA };
    /* One compression into a buffer of the upper bound; asking libpng for the size first would compress twice. */
    png_alloc_size_t length = PNG_IMAGE_PNG_SIZE_MAX(image);
    unsigned char *buffer = malloc(length);
    if (!buffer) return HEMI_ERROR_MEMORY;
    if (!png_image_write_to_memory(&image, buffer, &length, 0, rgba, 0, NULL)) {
        free(buffer);
        return HEMI_ERROR_MEMORY; /* every other cause has been refused before */
    }
    unsigned char *fitted = realloc(buffer, length);
    *bytes = fitted ? fitted : buffer;
    *size = length;
    return HEMI_OK;
}
