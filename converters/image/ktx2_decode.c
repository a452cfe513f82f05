/* SPDX-License-Identifier: MIT
 * See ktx2_decode.h. Largest level, first layer and face.
 */
#include "ktx2_decode.h"

#include <ktx.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of Vulkan's formats, those of one byte a band. [Khronos Data Format, VkFormat] */
enum { R8G8B8_UNORM = 23, R8G8B8_SRGB = 29, R8G8B8A8_UNORM = 37, R8G8B8A8_SRGB = 43 };

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

static hemi_result check_size(const ktxTexture2 *t, uint64_t most, char *message) {
    if (t->numDimensions != 2 || t->baseWidth == 0 || t->baseHeight == 0)
        return image_fail(HEMI_ERROR_UNSUPPORTED, "it is KTX2, and no picture of two dimensions", message);
    if (t->baseWidth <= most / t->baseHeight) return HEMI_OK;
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
    hemi_result result = check_size(t, most, message);
    if (result == HEMI_OK) code = ktxTexture_LoadImageData(ktxTexture(t), NULL, 0);
    if (result == HEMI_OK && code == KTX_SUCCESS && ktxTexture2_NeedsTranscoding(t))
        code = ktxTexture2_TranscodeBasis(t, KTX_TTF_RGBA32, 0);
    if (code != KTX_SUCCESS) result = fail_ktx(code, message);
    if (result == HEMI_OK) result = copy_pixels(t, out, message);
    ktxTexture_Destroy(ktxTexture(t));
    return result;
}
