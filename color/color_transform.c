/* SPDX-License-Identifier: MIT
 * Which vertex colour shows a radiance on a display? Keeps what goes into OpenColorIO and what comes out of it in range
 * and counts what was not; the colour science is behind ocio_shim.h. */
#include "color_transform.h"

#include "ocio_shim.h"

#include <math.h>

/* Colours that OpenColorIO sees at a time: 12 KiB, so that the three passes stay in the first-level cache. */
enum { CHUNK = 1024 };

/* Forces x into [0, most], NaN to 0; true if it was outside by more than slack. */
static bool force_range(float *x, float most, float slack) {
    bool outside = !(*x >= -slack && *x <= most + slack);
    if (!(*x > 0.0f))
        *x = 0.0f;
    else if (*x > most)
        *x = most;
    return outside;
}

static void force_colors(float *rgb, size_t count, float most, float slack, unsigned char *clipped) {
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) clipped[i] |= (unsigned char)force_range(&rgb[3 * i + (size_t)c], most, slack);
}

static hemi_result apply_chunk(const color_transform *transform, ocio_target target, float *rgb, size_t count,
                               size_t *clipped) {
    unsigned char flags[CHUNK] = { 0 };
    force_colors(rgb, count, COLOR_RADIANCE_MAX, 0.0f, flags);
    hemi_result result = ocio_apply(transform, target, rgb, count);
    force_colors(rgb, count, 1.0f, COLOR_CLIP_SLACK, flags);
    for (size_t i = 0; i < count; i++) *clipped += flags[i];
    return result;
}

static hemi_result apply(const color_transform *transform, ocio_target target, float *rgb, size_t count,
                         size_t *clipped) {
    size_t clipped_count = 0;
    hemi_result result = HEMI_OK;
    for (size_t begin = 0; begin < count && result == HEMI_OK; begin += CHUNK) {
        size_t chunk = count - begin < CHUNK ? count - begin : CHUNK;
        result = apply_chunk(transform, target, rgb + 3 * begin, chunk, &clipped_count);
    }
    if (clipped) *clipped = clipped_count;
    return result;
}

hemi_result color_transform_apply(const color_transform *transform, float *rgb, size_t count, size_t *clipped) {
    return apply(transform, OCIO_TARGET_LINEAR, rgb, count, clipped);
}

double color_transform_white(const color_transform *transform) {
    enum { STEPS = 24, A_STOP = 8 };
    static const float BRIGHT = 0.8714f; /* of code value 240, linear */
    float rgb[3 * (STEPS + 1)];
    for (int i = 0; i < 3 * (STEPS + 1); i++) rgb[i] = (float)exp2(i / 3 / (double)A_STOP);
    if (color_transform_apply(transform, rgb, STEPS + 1, NULL) != HEMI_OK) return 1.0;
    int i = 0;
    while (i < STEPS && fminf(rgb[3 * i], fminf(rgb[3 * i + 1], rgb[3 * i + 2])) < BRIGHT) i++;
    return exp2(i / (double)A_STOP);
}

hemi_result color_transform_apply_display(const color_transform *transform, float *rgb, size_t count, size_t *clipped) {
    return apply(transform, OCIO_TARGET_DISPLAY, rgb, count, clipped);
}

hemi_result color_transform_apply_rec709(const color_transform *transform, float *rgb, size_t count) {
    return ocio_apply(transform, OCIO_TARGET_REC709, rgb, count);
}
