/* SPDX-License-Identifier: MIT
 * See image_decode.h.
 */
#include "image_decode.h"

#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static hemi_result fail(hemi_result result, const char *text, char *message) {
    snprintf(message, IMAGE_MESSAGE_SIZE, "%s", text);
    return result;
}

/* Room for the pixels, whose size the header gave. */
static hemi_result allocate(uint64_t width, uint64_t height, uint64_t most, image_pixels *out, char *message) {
    if (width == 0 || height == 0) return fail(HEMI_ERROR_DATA, "it has no pixels", message);
    if (width > most / height) {
        snprintf(message, IMAGE_MESSAGE_SIZE,
                 "it has %llu x %llu pixels; more than %llu are read with --max-pixels only", (unsigned long long)width,
                 (unsigned long long)height, (unsigned long long)most);
        return HEMI_ERROR_LIMIT;
    }
    *out = (image_pixels){ malloc(4 * (size_t)(width * height)), (uint32_t)width, (uint32_t)height };
    return out->rgba ? HEMI_OK : fail(HEMI_ERROR_MEMORY, "out of memory", message);
}

static hemi_result decode_png(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out, char *message) {
    png_image image = { .version = PNG_IMAGE_VERSION };
    if (!png_image_begin_read_from_memory(&image, bytes, size)) return fail(HEMI_ERROR_DATA, image.message, message);
    hemi_result result = allocate(image.width, image.height, most, out, message);
    image.format = PNG_FORMAT_RGBA;
    if (result == HEMI_OK && !png_image_finish_read(&image, NULL, out->rgba, 0, NULL))
        result = fail(HEMI_ERROR_DATA, image.message, message);
    png_image_free(&image);
    return result;
}

static hemi_result decode_jpeg(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out, char *message) {
    int width = 0, height = 0, sampling, space;
    tjhandle decoder = tjInitDecompress();
    hemi_result result = decoder ? HEMI_OK : fail(HEMI_ERROR_MEMORY, "out of memory", message);
    if (result == HEMI_OK &&
        tjDecompressHeader3(decoder, bytes, (unsigned long)size, &width, &height, &sampling, &space) != 0)
        result = fail(HEMI_ERROR_DATA, tjGetErrorStr2(decoder), message);
    if (result == HEMI_OK) result = allocate((uint64_t)width, (uint64_t)height, most, out, message);
    /* Progressive scans without end are stopped as well as files that are cut short. */
    if (result == HEMI_OK && tjDecompress2(decoder, bytes, (unsigned long)size, out->rgba, width, 0, height, TJPF_RGBA,
                                           TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS | TJFLAG_ACCURATEDCT) != 0)
        result = fail(HEMI_ERROR_DATA, tjGetErrorStr2(decoder), message);
    if (decoder) tjDestroy(decoder);
    return result;
}

static hemi_result decode_webp(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out, char *message) {
    int width = 0, height = 0;
    if (!WebPGetInfo(bytes, size, &width, &height)) return fail(HEMI_ERROR_DATA, "its header is malformed", message);
    hemi_result result = allocate((uint64_t)width, (uint64_t)height, most, out, message);
    size_t room = 4 * (size_t)width * (size_t)height;
    if (result == HEMI_OK && !WebPDecodeRGBAInto(bytes, size, out->rgba, room, 4 * width))
        result = fail(HEMI_ERROR_DATA, "its pixels are malformed or cut short", message);
    return result;
}

hemi_result image_decode(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out,
                         char message[IMAGE_MESSAGE_SIZE]) {
    hemi_result result;
    memset(out, 0, sizeof *out);
    message[0] = 0;
    if (size >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0)
        result = decode_png(bytes, size, most, out, message);
    else if (size >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0)
        result = decode_jpeg(bytes, size, most, out, message);
    else if (size >= 16 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0)
        result = decode_webp(bytes, size, most, out, message);
    else
        return fail(HEMI_ERROR_UNSUPPORTED, "it is no PNG, JPEG or WebP", message);
    if (result != HEMI_OK) image_pixels_free(out);
    return result;
}

void image_pixels_free(image_pixels *pixels) {
    free(pixels->rgba);
    memset(pixels, 0, sizeof *pixels);
}
