/* SPDX-License-Identifier: MIT */
#include "pfm_decode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_SIZE = 64 };

bool pfm_is_it(const uint8_t *bytes, size_t size) {
    return size > 3 && bytes[0] == 'P' && bytes[1] == 'F' && bytes[2] == '\n';
}

/* Where the floats begin; 0: this is no header that is read here. */
static size_t read_header(const uint8_t *bytes, size_t size, unsigned *width, unsigned *height) {
    char text[HEADER_SIZE + 1] = "";
    int end = 0;
    double scale = 0.0;
    memcpy(text, bytes, size < HEADER_SIZE ? size : HEADER_SIZE);
    if (sscanf(text, "PF %7u %7u %lf%n", width, height, &scale, &end) != 3 || scale >= 0.0 || text[end] != '\n')
        return 0;
    return (size_t)end + 1;
}

static bool copy_rows(const uint8_t *from, uint32_t width, uint32_t height, float *to) {
    size_t row = 3 * (size_t)width;
    for (uint32_t r = 0; r < height; r++) memcpy(to + row * (height - 1 - r), from + 4 * row * r, 4 * row);
    for (size_t i = 0; i < row * height; i++)
        if (!isfinite(to[i]) || to[i] < 0.0f) return false;
    return true;
}

hemi_result pfm_decode(const uint8_t *bytes, size_t size, hdr_image *out, char message[IMAGE_MESSAGE_SIZE]) {
    unsigned width = 0, height = 0;
    *out = (hdr_image){ 0 };
    size_t begin = pfm_is_it(bytes, size) ? read_header(bytes, size, &width, &height) : 0;
    if (begin == 0 || width == 0 || height == 0)
        return image_fail(HEMI_ERROR_DATA, "it is no PFM with colours", message);
    uint64_t pixels = (uint64_t)width * height;
    if (pixels > HDR_PIXELS_MAX) return image_fail(HEMI_ERROR_LIMIT, "it has too many pixels", message);
    if ((size - begin) / 12 < pixels) return image_fail(HEMI_ERROR_DATA, "it is cut short", message);
    float *rgb = malloc(12 * (size_t)pixels);
    if (!rgb) return image_fail(HEMI_ERROR_MEMORY, "out of memory", message);
    if (!copy_rows(bytes + begin, width, height, rgb)) {
        free(rgb);
        return image_fail(HEMI_ERROR_DATA, "it has pixels that are negative or not finite", message);
    }
    *out = (hdr_image){ rgb, width, height };
    return HEMI_OK;
}
