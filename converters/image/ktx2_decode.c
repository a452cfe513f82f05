/* SPDX-License-Identifier: MIT
 * See ktx2_decode.h. The largest level of one picture: arrays and cubes are none.
 */
#include "ktx2_decode.h"

#include <ktx.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of Vulkan's formats, those of one byte a band. [Khronos Data Format, VkFormat] */
enum { R8G8B8_UNORM = 23, R8G8B8_SRGB = 29, R8G8B8A8_UNORM = 37, R8G8B8A8_SRGB = 43 };

/* Where a file says how many levels it has, and where they are listed; offset, length, unpacked length of each. */
enum { LEVEL_COUNT_AT = 40, LEVELS_AT = 80, LEVEL_BYTES = 24 };

/* Four bands of a byte, and smaller levels a third of it: 6; levels below a block of 4 x 4 take a whole one. */
enum { BYTES_OF_A_PIXEL = 6, SMALL_LEVELS = 1024 };

static hemi_result fail_ktx(KTX_error_code code, char *message) {
    if (code == KTX_OUT_OF_MEMORY) return image_fail(HEMI_ERROR_MEMORY, "out of memory", message);
    snprintf(message, IMAGE_MESSAGE_SIZE, "it is KTX2 that libktx refuses: %s", ktxErrorString(code));
    return HEMI_ERROR_DATA;
}

/* Bands of a plain picture; 0: it is none. */
static size_t band_count(const ktxTexture2 *t) {
    if (t->vkFormat == R8G8B8A8_UNORM || t->vkFormat == R8G8B8A8_SRGB) return 4;
    return t->vkFormat == R8G8B8_UNORM || t->vkFormat == R8G8B8_SRGB ? 3 : 0;
}

/* What the levels say that they unpack to, which libktx believes. [KTX 2.0, 3.9 levels] */
static uint64_t unpacked_bytes(const uint8_t *bytes, size_t size) {
    uint32_t levels;
    uint64_t sum = 0;
    memcpy(&levels, bytes + LEVEL_COUNT_AT, sizeof levels);
    if (levels == 0) levels = 1;
    for (size_t at = LEVELS_AT; levels > 0 && at + LEVEL_BYTES <= size; levels--, at += LEVEL_BYTES) {
        uint64_t one;
        memcpy(&one, bytes + at + LEVEL_BYTES - sizeof one, sizeof one);
        if (one > UINT64_MAX - sum) return UINT64_MAX;
        sum += one;
    }
    return sum;
}

static hemi_result check_size(const ktxTexture2 *t, const uint8_t *bytes, size_t size, uint64_t most, char *message) {
    if (t->numDimensions != 2 || t->baseWidth == 0 || t->baseHeight == 0 || t->numLayers > 1 || t->numFaces > 1)
        return image_fail(HEMI_ERROR_UNSUPPORTED, "it is KTX2, and no picture of two dimensions", message);
    if (t->baseWidth <= most / t->baseHeight) {
        uint64_t pixels = (uint64_t)t->baseWidth * t->baseHeight;
        if (unpacked_bytes(bytes, size) / BYTES_OF_A_PIXEL <= pixels + SMALL_LEVELS) return HEMI_OK;
        return image_fail(HEMI_ERROR_UNSUPPORTED, "it is KTX2 that unpacks to more than its pixels of eight bits take",
                          message);
    }
    snprintf(message, IMAGE_MESSAGE_SIZE, "it has %u x %u pixels; more than %llu are read with --max-pixels only",
             t->baseWidth, t->baseHeight, (unsigned long long)most);
    return HEMI_ERROR_LIMIT;
}

static hemi_result copy_pixels(ktxTexture2 *t, image_pixels *out, char *message) {
    const size_t count = (size_t)t->baseWidth * t->baseHeight, bands = band_count(t);
    ktx_size_t at = 0;
    if (bands == 0) return image_fail(HEMI_ERROR_UNSUPPORTED, "it is KTX2 in a format that is not read", message);
    KTX_error_code code = ktxTexture_GetImageOffset(ktxTexture(t), 0, 0, 0, &at);
    if (code != KTX_SUCCESS) return fail_ktx(code, message);
    if (at > t->dataSize || bands * count > t->dataSize - at)
        return image_fail(HEMI_ERROR_DATA, "its pixels are malformed or cut short", message);
    *out = (image_pixels){ malloc(4 * count), t->baseWidth, t->baseHeight };
    if (!out->rgba) return image_fail(HEMI_ERROR_MEMORY, "out of memory", message);
    const uint8_t *from = t->pData + at;
    for (size_t i = 0; i < count; i++) {
        out->rgba[4 * i + 3] = 255;
        memcpy(out->rgba + 4 * i, from + bands * i, bands);
    }
    return HEMI_OK;
}

hemi_result ktx2_decode(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out,
                        char message[IMAGE_MESSAGE_SIZE]) {
    ktxTexture2 *t = NULL;
    /* The size is looked at before anything is unpacked. */
    KTX_error_code code = ktxTexture2_CreateFromMemory(bytes, size, KTX_TEXTURE_CREATE_NO_FLAGS, &t);
    if (code != KTX_SUCCESS) return fail_ktx(code, message);
    hemi_result result = check_size(t, bytes, size, most, message);
    if (result == HEMI_OK) code = ktxTexture_LoadImageData(ktxTexture(t), NULL, 0);
    if (result == HEMI_OK && code == KTX_SUCCESS && ktxTexture2_NeedsTranscoding(t))
        code = ktxTexture2_TranscodeBasis(t, KTX_TTF_RGBA32, 0);
    if (code != KTX_SUCCESS) result = fail_ktx(code, message);
    if (result == HEMI_OK) result = copy_pixels(t, out, message);
    ktxTexture_Destroy(ktxTexture(t));
    return result;
}
