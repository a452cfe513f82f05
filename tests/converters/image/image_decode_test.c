/* SPDX-License-Identifier: MIT
 * Are pictures read as they were written, and is damage refused?
 */
#include "check.h"
#include "image_decode.h"
#include "png_encode.h"

#include <stdlib.h>
#include <turbojpeg.h>
#include <webp/encode.h>

enum { WIDTH = 32, HEIGHT = 24 };

typedef struct encoded {
    unsigned char *bytes;
    size_t size;
} encoded;

/* Smooth, so that lossy formats keep it; rows and columns differ. */
static void paint(uint8_t *rgba) {
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            uint8_t *pixel = rgba + 4 * (y * WIDTH + x);
            pixel[0] = (uint8_t)(40 + 5 * x), pixel[1] = (uint8_t)(30 + 8 * y), pixel[2] = 120, pixel[3] = 255;
        }
}

static encoded as_png(const uint8_t *rgba) {
    encoded out = { 0 };
    CHECK_EQUAL(png_encode(rgba, WIDTH, HEIGHT, &out.bytes, &out.size), HEMI_OK);
    return out;
}

static encoded as_jpeg(const uint8_t *rgba) {
    encoded out = { 0 };
    unsigned char *bytes = NULL;
    unsigned long size = 0;
    tjhandle encoder = tjInitCompress();
    CHECK_EQUAL(tjCompress2(encoder, rgba, WIDTH, 0, HEIGHT, TJPF_RGBA, &bytes, &size, TJSAMP_444, 95, 0), 0);
    out = (encoded){ malloc(size), size };
    memcpy(out.bytes, bytes, size);
    tjFree(bytes);
    tjDestroy(encoder);
    return out;
}

static encoded as_webp(const uint8_t *rgba) {
    encoded out = { 0 };
    uint8_t *bytes = NULL;
    size_t size = WebPEncodeLosslessRGBA(rgba, WIDTH, HEIGHT, 4 * WIDTH, &bytes);
    CHECK(size > 0);
    out = (encoded){ malloc(size), size };
    memcpy(out.bytes, bytes, size);
    WebPFree(bytes);
    return out;
}

static void pictures_are_read_as_they_were_written(void) {
    static uint8_t rgba[4 * WIDTH * HEIGHT];
    paint(rgba);
    /* JPEG at quality 95 quantises the lowest frequencies by 2 and converts colours twice. */
    const int tolerance[3] = { 0, 6, 0 };
    encoded all[3] = { as_png(rgba), as_jpeg(rgba), as_webp(rgba) };
    for (int k = 0; k < 3; k++) {
        image_pixels pixels;
        char message[IMAGE_MESSAGE_SIZE];
        CHECK_EQUAL(image_decode(all[k].bytes, all[k].size, IMAGE_PIXELS_DEFAULT, &pixels, message), HEMI_OK);
        CHECK_TEXT(message, "");
        CHECK_EQUAL(pixels.width, WIDTH);
        CHECK_EQUAL(pixels.height, HEIGHT);
        for (int i = 0; pixels.rgba && i < 4 * WIDTH * HEIGHT; i++) CHECK_NEAR(pixels.rgba[i], rgba[i], tolerance[k]);
        image_pixels_free(&pixels);
        CHECK(pixels.rgba == NULL);
        free(all[k].bytes);
    }
}

static void pictures_that_are_cut_short_are_refused(void) {
    static uint8_t rgba[4 * WIDTH * HEIGHT];
    paint(rgba);
    encoded all[3] = { as_png(rgba), as_jpeg(rgba), as_webp(rgba) };
    for (int k = 0; k < 3; k++) {
        for (size_t size = 16; size < all[k].size - 16; size += 7) {
            image_pixels pixels;
            char message[IMAGE_MESSAGE_SIZE] = "";
            uint8_t *part = malloc(size); /* of its own, so that a sanitizer sees what is read past its end */
            memcpy(part, all[k].bytes, size);
            CHECK_EQUAL(image_decode(part, size, IMAGE_PIXELS_DEFAULT, &pixels, message), HEMI_ERROR_DATA);
            CHECK(*message && pixels.rgba == NULL);
            free(part);
        }
        free(all[k].bytes);
    }
}

static void damage_never_crashes(void) {
    static uint8_t rgba[4 * WIDTH * HEIGHT];
    uint64_t state = 1;
    paint(rgba);
    encoded all[3] = { as_png(rgba), as_jpeg(rgba), as_webp(rgba) };
    for (int round = 0; round < 600; round++) {
        encoded *one = &all[round % 3];
        image_pixels pixels;
        char message[IMAGE_MESSAGE_SIZE];
        state = state * 6364136223846793005u + 1442695040888963407u;
        size_t at = (size_t)(state >> 33) % one->size;
        uint8_t before = one->bytes[at];
        one->bytes[at] ^= (uint8_t)(1 + (state >> 20) % 255);
        hemi_result result = image_decode(one->bytes, one->size, IMAGE_PIXELS_DEFAULT, &pixels, message);
        CHECK((result == HEMI_OK) == (pixels.rgba != NULL));
        CHECK((result == HEMI_OK) == (*message == 0));
        image_pixels_free(&pixels);
        one->bytes[at] = before;
    }
    for (int k = 0; k < 3; k++) free(all[k].bytes);
}

static void other_formats_are_told_apart(void) {
    image_pixels pixels;
    char message[IMAGE_MESSAGE_SIZE];
    CHECK_EQUAL(image_decode((const uint8_t *)"GIF89a..........", 16, IMAGE_PIXELS_DEFAULT, &pixels, message),
                HEMI_ERROR_UNSUPPORTED);
    CHECK_EQUAL(image_decode((const uint8_t *)"", 0, IMAGE_PIXELS_DEFAULT, &pixels, message), HEMI_ERROR_UNSUPPORTED);
}

int main(void) {
    RUN(pictures_are_read_as_they_were_written);
    RUN(pictures_that_are_cut_short_are_refused);
    RUN(damage_never_crashes);
    RUN(other_formats_are_told_apart);
    return check_end();
}
