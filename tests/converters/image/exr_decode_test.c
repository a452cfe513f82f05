/* SPDX-License-Identifier: MIT
 * Is an OpenEXR picture read as the light that it holds, however it is stored, and is what cannot be read refused by a
 * line that says why?
 */
#include "check.h"
#include "exr_decode.h"
#include "exr_file.h"

#include <stdlib.h>

enum { WIDTH = 37, HEIGHT = 19 };

#define WINDOW(left, top, right, bottom)                                                                               \
    {                                                                                                                  \
        .min = { .x = (left), .y = (top) }, .max = {.x = (right), .y = (bottom) }                                      \
    }

/* Smooth, so that what B44 does to it is small; whole numbers below 2048, which a half has exactly. */
static double smooth(int channel, int x, int y) {
    return 100 + 3 * x + 2 * y + 50 * channel;
}

static exr_file colors(exr_pixel_type_t type) {
    return (exr_file){ .channels = { "B", "G", "R" },
                       .types = { type, type, type },
                       .compression = EXR_COMPRESSION_ZIP,
                       .data = WINDOW(0, 0, WIDTH - 1, HEIGHT - 1),
                       .display = WINDOW(0, 0, WIDTH - 1, HEIGHT - 1),
                       .value = smooth };
}

static exr_bytes write_file(const exr_file *f) {
    bool is_dwa = f->compression == EXR_COMPRESSION_DWAA || f->compression == EXR_COMPRESSION_DWAB;
    return is_dwa ? exr_file_write_dwa(f) : exr_file_write(f);
}

static hemi_result decode(const exr_file *f, hdr_image *out, char *note, char *message) {
    exr_bytes file = write_file(f);
    hemi_result result = exr_decode(file.bytes, file.size, out, note, message);
    free(file.bytes);
    return result;
}

/* What is read against what was written: channel[k] of the file is red, green, blue; outside of the data window is 0.
 */
static void check_pixels(const exr_file *f, const int channel[3], double relative, const char *expected_note) {
    char note[EXR_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    CHECK_EQUAL(decode(f, &image, note, message), HEMI_OK);
    CHECK_TEXT(message, "");
    CHECK_TEXT(note, expected_note);
    CHECK_EQUAL(image.width, f->display.max.x - f->display.min.x + 1);
    CHECK_EQUAL(image.height, f->display.max.y - f->display.min.y + 1);
    double most = 0.0;
    for (size_t i = 0; image.rgb && i < 3 * (size_t)image.width * image.height; i++) {
        int x = (int)(i / 3 % image.width) + f->display.min.x, y = (int)(i / 3 / image.width) + f->display.min.y;
        bool is_there = x >= f->data.min.x && x <= f->data.max.x && y >= f->data.min.y && y <= f->data.max.y;
        double value = is_there ? f->value(channel[i % 3], x, y) : 0.0;
        most = fmax(most, fabs((double)image.rgb[i] - value) / fmax(value, 1e-30));
    }
    CHECK_NEAR(most, 0.0, relative);
    hdr_image_free(&image);
}

static const int REVERSED[3] = { 2, 1, 0 };

static void each_compression_gives_what_went_in(void) {
    static const exr_compression_t exact[] = { EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                               EXR_COMPRESSION_ZIP, EXR_COMPRESSION_PIZ };
    static const exr_pixel_type_t types[] = { EXR_PIXEL_UINT, EXR_PIXEL_HALF, EXR_PIXEL_FLOAT };
    for (size_t t = 0; t < 3; t++) {
        exr_file f = colors(types[t]);
        for (size_t i = 0; i < sizeof exact / sizeof *exact; i++) {
            f.compression = exact[i];
            check_pixels(&f, REVERSED, 0.0, "");
        }
        f.compression = EXR_COMPRESSION_PXR24;
        check_pixels(&f, REVERSED, 0.0, ""); /* of floats 16 bits of mantissa, and these have 11 */
    }
    exr_file half = colors(EXR_PIXEL_HALF);
    for (int by = EXR_COMPRESSION_B44; by <= EXR_COMPRESSION_B44A; by++) {
        half.compression = (exr_compression_t)by;
        check_pixels(&half, REVERSED, 0.02,
                     ""); /* steps of 1/32 of what a block of 4 x 4 spans, here half of its value */
    }
}

/* The byte of the header that says how it is compressed. */
static uint8_t *compression_of(exr_bytes file) {
    static const char before[] = "compression\0compression\0\1\0\0";
    for (size_t i = 0; i + sizeof before < file.size; i++)
        if (memcmp(file.bytes + i, before, sizeof before) == 0) return file.bytes + i + sizeof before;
    CHECK(false);
    return file.bytes;
}

/* B44 stores as it is what it would not make smaller; one row is one chunk with and without it. */
static void what_b44_stores_as_it_is_is_read(void) {
    char note[EXR_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    for (int type = EXR_PIXEL_UINT; type <= EXR_PIXEL_FLOAT; type++) {
        exr_file f = colors((exr_pixel_type_t)type);
        f.compression = EXR_COMPRESSION_NONE;
        f.data = f.display = (exr_attr_box2i_t)WINDOW(0, 0, WIDTH - 1, 0);
        exr_bytes file = exr_file_write(&f);
        *compression_of(file) = EXR_COMPRESSION_B44;
        CHECK_EQUAL(exr_decode(file.bytes, file.size, &image, note, message), HEMI_OK);
        for (int i = 0; image.rgb && i < 3 * WIDTH; i++) CHECK_NEAR(image.rgb[i], smooth(2 - i % 3, i / 3, 0), 0);
        hdr_image_free(&image);
        free(file.bytes);
    }
}

/* Beside other channels, before and behind in the alphabet; one that is wider moves the rows of the rest. */
static void other_channels_are_passed_over(void) {
    exr_file f = colors(EXR_PIXEL_HALF);
    const char *const names[] = { "A", "B", "G", "R", "Z" };
    for (int i = 0; i < 5; i++) f.channels[i] = names[i], f.types[i] = i < 4 ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    check_pixels(&f, (int[3]){ 3, 2, 1 }, 0.0, "");
    f.channels[4] = NULL; /* four halves, of which three are asked for */
    check_pixels(&f, (int[3]){ 3, 2, 1 }, 0.0, "");
}

static void tiles_are_put_together(void) {
    exr_file f = colors(EXR_PIXEL_HALF);
    f.compression = EXR_COMPRESSION_PIZ;
    for (f.tile = 8; f.tile <= 64; f.tile *= 2) check_pixels(&f, REVERSED, 0.0, "");
}

static void the_data_window_lies_anywhere_in_the_display_window(void) {
    exr_file f = colors(EXR_PIXEL_FLOAT);
    for (f.tile = 0; f.tile <= 16; f.tile += 16) {
        f.display = (exr_attr_box2i_t)WINDOW(-4, -2, 40, 22);
        f.data = (exr_attr_box2i_t)WINDOW(3, 1, 20, 18);
        check_pixels(&f, REVERSED, 0.0, "");
        f.data = (exr_attr_box2i_t)WINDOW(-10, -7, 60, 9); /* more than is seen, on three sides */
        check_pixels(&f, REVERSED, 0.0, "");
    }
}

static void luminance_alone_is_grey(void) {
    exr_file f = colors(EXR_PIXEL_HALF);
    f.channels[0] = "Y", f.channels[1] = "Z", f.channels[2] = NULL;
    check_pixels(&f, (int[3]){ 0, 0, 0 }, 0.0, "");
}

static void the_layer_without_a_name_comes_first(void) {
    exr_file f = { .channels = { "G", "b", "diffuse.B", "diffuse.G", "diffuse.R", "r" }, .value = smooth };
    for (int i = 0; i < 6; i++) f.types[i] = EXR_PIXEL_HALF;
    f.data = f.display = (exr_attr_box2i_t)WINDOW(0, 0, WIDTH - 1, HEIGHT - 1);
    check_pixels(&f, (int[3]){ 5, 0, 1 }, 0.0, "it has 2 sets of colours; the one without a name is read");
    f.channels[0] = "a.G", f.channels[1] = "a.R"; /* no blue */
    f.channels[5] = NULL;
    check_pixels(&f, (int[3]){ 4, 3, 2 }, 0.0, "layer \"diffuse\" is read");
    f.channels[0] = "View.Combined.Y", f.channels[1] = "View.Combined.Z";
    check_pixels(&f, (int[3]){ 0, 0, 0 }, 0.0, "it has 2 sets of colours; layer \"View.Combined\" is read");
}

static double all_halves(int channel, int x, int y) {
    int bits = 256 * y + x, exponent = bits >> 10 & 31, mantissa = bits & 1023;
    double size = exponent == 31  ? (mantissa ? NAN : INFINITY)
                  : exponent == 0 ? ldexp(mantissa, -24)
                                  : ldexp(1024 + mantissa, exponent - 25);
    (void)channel;
    return bits & 0x8000 ? -size : size;
}

/* Of 65536 halves 31745 are light, +0 and -0 among them; infinities, numbers below 0 and what is no number are not. */
static void halves_are_exact_and_what_is_no_light_is_0(void) {
    exr_file f = { .channels = { "Y" }, .types = { EXR_PIXEL_HALF }, .value = all_halves };
    char note[EXR_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    int wrong = 0;
    f.data = f.display = (exr_attr_box2i_t)WINDOW(0, 0, 255, 255);
    CHECK_EQUAL(decode(&f, &image, note, message), HEMI_OK);
    for (int i = 0; image.rgb && i < 65536; i++) {
        double value = all_halves(0, i % 256, i / 256);
        wrong += (double)image.rgb[3 * i] != (value >= 0.0 && isfinite(value) ? value : 0.0);
    }
    CHECK_EQUAL(wrong, 0);
    /* 31744 below infinity, and -0 is 0. Of each value three colours are made. */
    CHECK_TEXT(note, "101373 of its values are negative or not finite, and taken as 0");
    hdr_image_free(&image);
}

static void other_primaries_are_told(void) {
    static const exr_attr_chromaticities_t rec709 = { 0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f };
    static const exr_attr_chromaticities_t aces = { 0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f };
    exr_file f = colors(EXR_PIXEL_HALF);
    f.primaries = &rec709;
    check_pixels(&f, REVERSED, 0.0, "");
    f.primaries = &aces;
    check_pixels(&f, REVERSED, 0.0, "its primaries are not those of Rec. 709, and its numbers are not converted");
}

static void refuse(const exr_file *f, hemi_result expected, const char *says) {
    char note[EXR_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    CHECK_EQUAL(decode(f, &image, note, message), expected);
    CHECK_TEXT(message, says);
    CHECK_TEXT(note, "");
    CHECK(image.rgb == NULL);
}

static void what_is_no_panorama_is_refused(void) {
    exr_file f = colors(EXR_PIXEL_HALF);
    f.is_cube = true;
    refuse(&f, HEMI_ERROR_UNSUPPORTED, "it is a cube map; write it by longitude and latitude");
    f = colors(EXR_PIXEL_HALF);
    f.channels[2] = "X";
    refuse(&f, HEMI_ERROR_DATA, "it has no channels R, G and B, and no Y");
    f.channels[0] = "BY", f.channels[1] = "RY", f.channels[2] = "Y";
    refuse(&f, HEMI_ERROR_UNSUPPORTED,
           "it has luminance and chroma, or colours at a part of its pixels; write it as R, G and B");
    f = colors(EXR_PIXEL_HALF);
    f.display = (exr_attr_box2i_t)WINDOW(WIDTH, 0, 2 * WIDTH, HEIGHT);
    refuse(&f, HEMI_ERROR_DATA, "its data window is outside of its display window");
    f.display = (exr_attr_box2i_t)WINDOW(0, 0, 65536, HEIGHT);
    refuse(&f, HEMI_ERROR_LIMIT, "it has more than 2^27 pixels, or a side above 65536");
    f.display = (exr_attr_box2i_t)WINDOW(0, 0, 16383, 8192);
    refuse(&f, HEMI_ERROR_LIMIT, "it has more than 2^27 pixels, or a side above 65536");
}

/* They lose what the eye does not see. */
static void what_the_core_does_not_decompress_is_read_too(void) {
    exr_file f = colors(EXR_PIXEL_FLOAT);
    f.data = (exr_attr_box2i_t)WINDOW(-3, 2, WIDTH + 4, HEIGHT - 3);
    for (f.tile = 0; f.tile <= 16; f.tile += 16)
        for (int by = EXR_COMPRESSION_DWAA; by <= EXR_COMPRESSION_DWAB; by++) {
            f.compression = (exr_compression_t)by;
            f.channels[0] = "B", f.channels[1] = "G", f.channels[2] = "R";
            check_pixels(&f, REVERSED, 0.02, "");
            f.channels[0] = "Y", f.channels[1] = f.channels[2] = NULL;
            check_pixels(&f, (const int[3]){ 0, 0, 0 }, 0.02, "");
        }
}

/* What says that it is DWAA and is not is malformed. */
static void compressions_that_are_not_decoded_are_named(void) {
    static const uint8_t by[] = { EXR_COMPRESSION_DWAA, EXR_COMPRESSION_DWAB, EXR_COMPRESSION_LAST_TYPE, 200 };
    static const char *const names[] = { "DWAA", "DWAB", "what is newer than it", "what is newer than it" };
    char note[EXR_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE], says[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    exr_file f = colors(EXR_PIXEL_HALF);
    for (int i = 0; i < 4; i++) {
        exr_bytes file = exr_file_write(&f);
        *compression_of(file) = by[i];
        hemi_result result = exr_decode(file.bytes, file.size, &image, note, message);
        snprintf(says, sizeof says, "this OpenEXR does not decode its compression, %s; write it as ZIP or PIZ",
                 names[i]);
        if (i < 2 && result == HEMI_ERROR_DATA) snprintf(says, sizeof says, "%s", message);
        CHECK(result == HEMI_ERROR_UNSUPPORTED || (i < 2 && result == HEMI_ERROR_DATA));
        CHECK_TEXT(message, says);
        CHECK(image.rgb == NULL);
        free(file.bytes);
    }
}

static void whatever_is_cut_off_is_refused(void) {
    char note[EXR_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE];
    hdr_image image;
    exr_file f = colors(EXR_PIXEL_HALF);
    for (f.tile = 0; f.tile <= 16; f.tile += 16)
        for (int by = EXR_COMPRESSION_NONE; by <= EXR_COMPRESSION_DWAB; by++) {
            f.compression = (exr_compression_t)by;
            exr_bytes file = write_file(&f);
            int read = 0;
            for (size_t kept = 0; kept < file.size; kept++) {
                read += exr_decode(file.bytes, kept, &image, note, message) == HEMI_OK;
                read += image.rgb != NULL || message[0] == 0;
            }
            CHECK_EQUAL(read, 0);
            free(file.bytes);
        }
}

int main(void) {
    RUN(each_compression_gives_what_went_in);
    RUN(what_the_core_does_not_decompress_is_read_too);
    RUN(what_b44_stores_as_it_is_is_read);
    RUN(other_channels_are_passed_over);
    RUN(tiles_are_put_together);
    RUN(the_data_window_lies_anywhere_in_the_display_window);
    RUN(luminance_alone_is_grey);
    RUN(the_layer_without_a_name_comes_first);
    RUN(halves_are_exact_and_what_is_no_light_is_0);
    RUN(other_primaries_are_told);
    RUN(what_is_no_panorama_is_refused);
    RUN(compressions_that_are_not_decoded_are_named);
    RUN(whatever_is_cut_off_is_refused);
    return check_end();
}
