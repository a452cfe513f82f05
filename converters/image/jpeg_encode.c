/* SPDX-License-Identifier: MIT */
#include "jpeg_encode.h"

#include "png_encode.h"

#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

/* Of 100: no ringing is seen beside the edges of a shadow. */
enum { QUALITY = 92 };

hemi_result jpeg_encode(const uint8_t *rgba, uint32_t width, uint32_t height, unsigned char **bytes, size_t *size) {
    if (!bytes || !size) return HEMI_ERROR_ARGUMENT;
    *bytes = NULL;
    *size = 0;
    if (!rgba || width == 0 || height == 0) return HEMI_ERROR_ARGUMENT;
    if (width > PNG_ENCODE_EDGE_MAX || height > PNG_ENCODE_EDGE_MAX) return HEMI_ERROR_LIMIT;
    unsigned char *made = NULL;
    unsigned long length = 0;
    tjhandle handle = tjInitCompress();
    bool ok = handle && tjCompress2(handle, rgba, (int)width, 0, (int)height, TJPF_RGBX, &made, &length, TJSAMP_444,
                                    QUALITY, 0) == 0;
    /* What turbojpeg allocates is its own to free. */
    if (ok) *bytes = malloc(length);
    if (*bytes) {
        memcpy(*bytes, made, length);
        *size = length;
    }
    tjFree(made);
    if (handle) tjDestroy(handle);
    return *bytes ? HEMI_OK : HEMI_ERROR_MEMORY;
}
