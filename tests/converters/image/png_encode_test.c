/* SPDX-License-Identifier: MIT
 * Are the pixels that libpng reads back the ones that went in, and is what cannot be a picture refused? */
#include "check.h"
#include "png_encode.h"

#include <png.h>
#include <stdlib.h>

enum { WIDTH = 61, HEIGHT = 37 };

static void fill(uint8_t *rgba, size_t count) {
    uint32_t state = 1989;
    for (size_t i = 0; i < 4 * count; i++) {
        state = state * 1664525u + 1013904223u;
        rgba[i] = (uint8_t)(state >> 24);
    }
}

static bool holds_chunk(const unsigned char *bytes, size_t size, const char *name) {
    for (size_t i = 0; i + 4 <= size; i++)
        if (memcmp(bytes + i, name, 4) == 0) return true;
    return false;
}

static void decoded_pixels_are_the_encoded_ones(void) {
    uint8_t in[4 * WIDTH * HEIGHT], out[4 * WIDTH * HEIGHT];
    unsigned char *bytes = NULL;
    size_t size = 0;
    fill(in, WIDTH * HEIGHT);
    CHECK_EQUAL(png_encode(in, WIDTH, HEIGHT, &bytes, &size), HEMI_OK);
    png_image image;
    memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    CHECK(bytes && png_image_begin_read_from_memory(&image, bytes, size));
    CHECK_EQUAL(image.width, WIDTH);
    CHECK_EQUAL(image.height, HEIGHT);
    CHECK_EQUAL(image.format, PNG_FORMAT_RGBA);
    CHECK(png_image_finish_read(&image, NULL, out, 0, NULL));
    CHECK(memcmp(in, out, sizeof in) == 0);
    free(bytes);
}

static void the_file_says_srgb(void) {
    uint8_t pixel[4] = { 1, 2, 3, 255 };
    unsigned char *bytes = NULL;
    size_t size = 0;
    CHECK_EQUAL(png_encode(pixel, 1, 1, &bytes, &size), HEMI_OK);
    CHECK(bytes && holds_chunk(bytes, size, "sRGB"));
    free(bytes);
}

static void pictures_without_pixels_are_refused(void) {
    uint8_t pixel[4] = { 0 };
    unsigned char *bytes = pixel;
    size_t size = 7;
    CHECK_EQUAL(png_encode(pixel, 0, 1, &bytes, &size), HEMI_ERROR_ARGUMENT);
    CHECK(bytes == NULL && size == 0);
    CHECK_EQUAL(png_encode(pixel, 1, 0, &bytes, &size), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(png_encode(NULL, 1, 1, &bytes, &size), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(png_encode(pixel, 1, 1, NULL, &size), HEMI_ERROR_ARGUMENT);
    CHECK_EQUAL(png_encode(pixel, 1, 1, &bytes, NULL), HEMI_ERROR_ARGUMENT);
}

static void pictures_above_the_limit_are_refused(void) {
    uint8_t pixel[4] = { 0 };
    unsigned char *bytes;
    size_t size;
    CHECK_EQUAL(png_encode(pixel, PNG_ENCODE_EDGE_MAX + 1, 1, &bytes, &size), HEMI_ERROR_LIMIT);
    CHECK_EQUAL(png_encode(pixel, 1, UINT32_MAX, &bytes, &size), HEMI_ERROR_LIMIT);
}

static void the_widest_row_is_written(void) {
    uint8_t *row = calloc(PNG_ENCODE_EDGE_MAX, 4);
    unsigned char *bytes = NULL;
    size_t size = 0;
    CHECK(row && png_encode(row, PNG_ENCODE_EDGE_MAX, 1, &bytes, &size) == HEMI_OK);
    CHECK(size > 8);
    free(bytes);
    free(row);
}

int main(void) {
    RUN(decoded_pixels_are_the_encoded_ones);
    RUN(the_file_says_srgb);
    RUN(pictures_without_pixels_are_refused);
    RUN(pictures_above_the_limit_are_refused);
    RUN(the_widest_row_is_written);
    return check_end();
}
