/* SPDX-License-Identifier: MIT
 * Is a Radiance panorama read as the light that it holds, and is one that is cut short refused?
 */
#include "check.h"
#include "image_decode.h"

#include <stdint.h>

#define HEADER "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n"

/* Two rows of three pixels, red, green, blue and exponent each: a byte stands for itself / 256 x 2^(exponent - 128). */
static const uint8_t PIXELS[24] = { 128, 64, 32, 129, 255, 0,   0,  128, 0,   0,   0,   0,
                                    1,   2,  3,  136, 200, 100, 50, 140, 128, 128, 128, 120 };

static size_t make_file(uint8_t *bytes) {
    memcpy(bytes, HEADER, sizeof HEADER - 1);
    memcpy(bytes + sizeof HEADER - 1, PIXELS, sizeof PIXELS);
    return sizeof HEADER - 1 + sizeof PIXELS;
}

static void pixels_are_mantissas_times_a_power_of_two(void) {
    uint8_t bytes[128];
    char message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    CHECK_EQUAL(hdr_decode(bytes, make_file(bytes), &image, message), HEMI_OK);
    CHECK_TEXT(message, "");
    CHECK_EQUAL(image.width, 3);
    CHECK_EQUAL(image.height, 2);
    for (int i = 0; image.rgb && i < 18; i++) {
        int exponent = PIXELS[4 * (i / 3) + 3];
        double value = exponent ? ldexp(PIXELS[4 * (i / 3) + i % 3], exponent - 136) : 0.0;
        CHECK_NEAR(image.rgb[i], value, 0);
    }
    hdr_image_free(&image);
}

static void whatever_is_cut_off_is_refused(void) {
    uint8_t bytes[128];
    char message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    size_t size = make_file(bytes);
    for (size_t kept = 0; kept < size; kept++) {
        CHECK(hdr_decode(bytes, kept, &image, message) != HEMI_OK);
        CHECK(image.rgb == NULL && message[0] != 0);
    }
}

static void what_is_no_panorama_is_refused(void) {
    static const uint8_t png[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
    char message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    CHECK_EQUAL(hdr_decode(png, sizeof png, &image, message), HEMI_ERROR_DATA);
    CHECK(strstr(message, ".hdr") != NULL);
}

int main(void) {
    RUN(pixels_are_mantissas_times_a_power_of_two);
    RUN(whatever_is_cut_off_is_refused);
    RUN(what_is_no_panorama_is_refused);
    return check_end();
}
