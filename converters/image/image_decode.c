/* SPDX-License-Identifier: MIT */
#include "image_decode.h"

#ifdef HEMIBAKE_KTX
#include "ktx2_decode.h"
#endif

#include <png.h>
#include <stb/stb_image.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

hemi_result image_fail(hemi_result result, const char *text, char *message) {
    snprintf(message, IMAGE_MESSAGE_SIZE, "%s", text);
    return result;
}

/* Room for the pixels, whose size the header gave. */
static hemi_result allocate(uint64_t width, uint64_t height, uint64_t most, image_pixels *out, char *message) {
    if (width == 0 || height == 0) return image_fail(HEMI_ERROR_DATA, "it has no pixels", message);
    if (width > most / height) {
        snprintf(message, IMAGE_MESSAGE_SIZE,
                 "it has %llu x %llu pixels; more than %llu are read with --max-pixels only", (unsigned long long)width,
                 (unsigned long long)height, (unsigned long long)most);
        return HEMI_ERROR_LIMIT;
    }
    *out = (image_pixels){ malloc(4 * (size_t)(width * height)), (uint32_t)width, (uint32_t)height };
    return out->rgba ? HEMI_OK : image_fail(HEMI_ERROR_MEMORY, "out of memory", message);
}

static hemi_result decode_png(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out, char *message) {
    png_image image = { .version = PNG_IMAGE_VERSION };
    if (!png_image_begin_read_from_memory(&image, bytes, size))
        return image_fail(HEMI_ERROR_DATA, image.message, message);
    hemi_result result = allocate(image.width, image.height, most, out, message);
    image.format = PNG_FORMAT_RGBA;
    /* What says nothing of its curve has the one of its 8-bit kin; libpng would take 16 bits for linear. */
    image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    if (result == HEMI_OK && !png_image_finish_read(&image, NULL, out->rgba, 0, NULL))
        result = image_fail(HEMI_ERROR_DATA, image.message, message);
    png_image_free(&image);
    return result;
}

static hemi_result decode_jpeg(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out, char *message) {
    int width = 0, height = 0, sampling, space;
    tjhandle decoder = tjInitDecompress();
    hemi_result result = decoder ? HEMI_OK : image_fail(HEMI_ERROR_MEMORY, "out of memory", message);
    if (result == HEMI_OK &&
        tjDecompressHeader3(decoder, bytes, (unsigned long)size, &width, &height, &sampling, &space) != 0)
        result = image_fail(HEMI_ERROR_DATA, tjGetErrorStr2(decoder), message);
    if (result == HEMI_OK) result = allocate((uint64_t)width, (uint64_t)height, most, out, message);
    /* Progressive scans without end are stopped as well as files that are cut short. */
    if (result == HEMI_OK && tjDecompress2(decoder, bytes, (unsigned long)size, out->rgba, width, 0, height, TJPF_RGBA,
                                           TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS | TJFLAG_ACCURATEDCT) != 0)
        result = image_fail(HEMI_ERROR_DATA, tjGetErrorStr2(decoder), message);
    if (decoder) tjDestroy(decoder);
    return result;
}

static hemi_result decode_webp(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out, char *message) {
    int width = 0, height = 0;
    if (!WebPGetInfo(bytes, size, &width, &height))
        return image_fail(HEMI_ERROR_DATA, "its header is malformed", message);
    hemi_result result = allocate((uint64_t)width, (uint64_t)height, most, out, message);
    size_t room = 4 * (size_t)width * (size_t)height;
    if (result == HEMI_OK && !WebPDecodeRGBAInto(bytes, size, out->rgba, room, 4 * width))
        result = image_fail(HEMI_ERROR_DATA, "its pixels are malformed or cut short", message);
    return result;
}

static bool is_ktx2(const uint8_t *bytes, size_t size) {
    return size >= 12 && memcmp(bytes, "\xabKTX 20\xbb\r\n\x1a\n", 12) == 0;
}

#ifndef HEMIBAKE_KTX
static hemi_result ktx2_decode(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out, char *message) {
    (void)bytes, (void)size, (void)most, (void)out;
    return image_fail(HEMI_ERROR_UNSUPPORTED, "it is KTX2, which this build does not decode", message);
}
#endif

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
    else if (is_ktx2(bytes, size))
        result = ktx2_decode(bytes, size, most, out, message);
    else
        return image_fail(HEMI_ERROR_UNSUPPORTED, "it is no PNG, JPEG or WebP", message);
    if (result != HEMI_OK) image_pixels_free(out);
    return result;
}

void image_pixels_free(image_pixels *pixels) {
    free(pixels->rgba);
    memset(pixels, 0, sizeof *pixels);
}

/* ---- Radiance pictures ------------------------------------------------------------------------------------------- */

static bool is_radiance(const uint8_t *bytes, size_t size) {
    static const char *const starts[] = { "#?RADIANCE\n", "#?RGBE\n" };
    for (int i = 0; i < 2; i++)
        if (size > strlen(starts[i]) && memcmp(bytes, starts[i], strlen(starts[i])) == 0) return true;
    return false;
}

/* Where pixels begin: after an empty line and the line of the resolution. 0: nowhere. */
static size_t pixels_start(const uint8_t *bytes, size_t size) {
    for (size_t i = 1; i < size; i++) {
        if (bytes[i] != '\n' || bytes[i - 1] != '\n') continue;
        const uint8_t *end = memchr(bytes + i + 1, '\n', size - i - 1);
        return end ? (size_t)(end - bytes) + 1 : 0;
    }
    return 0;
}

/* Is a whole row there? *at moves past it. A run-length coded row begins with 2 2 and its length; of each of its four
 * bands come runs, a count above 128 and the value, and copies, a count and the values. */
static bool skip_row(const uint8_t *bytes, size_t size, size_t width, size_t *at) {
    bool coded = width >= 8 && width < 32768 && size - *at >= 4 && bytes[*at] == 2 && bytes[*at + 1] == 2 &&
                 bytes[*at + 2] < 128;
    size_t done = 0;
    if (!coded) return 4 * width <= size - *at && (*at += 4 * width);
    for (*at += 4; done < 4 * width;) {
        if (*at >= size) return false;
        size_t count = bytes[*at];
        *at += count > 128 ? 2 : count + 1;
        done += count > 128 ? count - 128 : count;
        if (count == 0) return false;
    }
    return *at <= size;
}

/* stb_image fills what a file lacks with what it read before, so a file that is cut short is found here. */
static bool is_whole(const uint8_t *bytes, size_t size, size_t width, size_t height) {
    size_t at = pixels_start(bytes, size);
    if (at == 0) return false;
    for (size_t row = 0; row < height; row++)
        if (!skip_row(bytes, size, width, &at)) return false;
    return true;
}

hemi_result hdr_decode(const uint8_t *bytes, size_t size, hdr_image *out, char message[IMAGE_MESSAGE_SIZE]) {
    int width = 0, height = 0, channels = 0;
    memset(out, 0, sizeof *out);
    message[0] = 0;
    if (!is_radiance(bytes, size)) return image_fail(HEMI_ERROR_DATA, "it is no Radiance picture (.hdr)", message);
    if (size > INT_MAX) return image_fail(HEMI_ERROR_LIMIT, "it is longer than 2 GiB", message);
    if (!stbi_info_from_memory(bytes, (int)size, &width, &height, &channels) || width <= 0 || height <= 0)
        return image_fail(HEMI_ERROR_DATA, "its header says no size that can be read", message);
    if ((uint64_t)width * (uint64_t)height > HDR_PIXELS_MAX || width > 65536 || height > 65536)
        return image_fail(HEMI_ERROR_LIMIT, "it has more than 2^27 pixels, or a side above 65536", message);
    if (!is_whole(bytes, size, (size_t)width, (size_t)height))
        return image_fail(HEMI_ERROR_DATA, "it ends before its last row", message);
    float *rgb = stbi_loadf_from_memory(bytes, (int)size, &width, &height, &channels, 3);
    if (!rgb) return image_fail(HEMI_ERROR_DATA, "its pixels are malformed", message);
    *out =
        (hdr_image){ malloc(3 * (size_t)width * (size_t)height * sizeof *out->rgb), (uint32_t)width, (uint32_t)height };
    for (size_t i = 0; out->rgb && i < 3 * (size_t)width * (size_t)height; i++)
        out->rgb[i] = isfinite(rgb[i]) ? fmaxf(rgb[i], 0.0f) : 0.0f;
    stbi_image_free(rgb);
    return out->rgb ? HEMI_OK : image_fail(HEMI_ERROR_MEMORY, "out of memory", message);
}

void hdr_image_free(hdr_image *image) {
    free(image->rgb);
    memset(image, 0, sizeof *image);
}
