/* SPDX-License-Identifier: MIT
 * Which vertex colour shows a radiance on a display? Keeps what goes into OpenColorIO and what comes out of it in range
 * and counts what was not; the colour science is behind ocio_shim.h. */
#include "color_transform.h"

#include "ocio_shim.h"

#include <stdlib.h>
#include <string.h>

/* Colours that OpenColorIO sees at a time: 12 KiB, so that the three passes stay in the first-level cache. */
enum { CHUNK = 1024 };

struct color_transform {
    ocio_view *view;
};

hemi_result color_transform_create(const color_transform_desc *desc, color_transform **out,
                                   char message[COLOR_MESSAGE_SIZE]) {
    const color_transform_desc defaults = { 0 };
    *out = NULL;
    message[0] = '\0';
    color_transform *transform = malloc(sizeof *transform);
    if (!transform) return HEMI_ERROR_MEMORY;
    hemi_result result = ocio_view_create(desc ? desc : &defaults, &transform->view, message);
    if (result == HEMI_OK)
        *out = transform;
    else
        free(transform);
    return result;
}

void color_transform_destroy(color_transform *transform) {
    if (!transform) return;
    ocio_view_destroy(transform->view);
    free(transform);
}

const char *color_transform_config(const color_transform *t) {
    return ocio_view_name(t->view, OCIO_VIEW_CONFIG);
}
const char *color_transform_display(const color_transform *t) {
    return ocio_view_name(t->view, OCIO_VIEW_DISPLAY);
}
const char *color_transform_view(const color_transform *t) {
    return ocio_view_name(t->view, OCIO_VIEW_VIEW);
}
const char *color_transform_look(const color_transform *t) {
    return ocio_view_name(t->view, OCIO_VIEW_LOOK);
}
const char *color_transform_working_space(const color_transform *t) {
    return ocio_view_name(t->view, OCIO_VIEW_WORKING_SPACE);
}
const ocio_view *color_transform_shim(const color_transform *t) {
    return t->view;
}

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

static hemi_result apply_chunk(const ocio_view *view, ocio_target target, float *rgb, size_t count, size_t *clipped) {
    unsigned char flags[CHUNK] = { 0 };
    force_colors(rgb, count, COLOR_RADIANCE_MAX, 0.0f, flags);
    hemi_result result = ocio_view_apply(view, target, rgb, count);
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
        result = apply_chunk(transform->view, target, rgb + 3 * begin, chunk, &clipped_count);
    }
    if (clipped) *clipped = clipped_count;
    return result;
}

hemi_result color_transform_apply(const color_transform *transform, float *rgb, size_t count, size_t *clipped) {
    return apply(transform, OCIO_TARGET_LINEAR, rgb, count, clipped);
}

hemi_result color_transform_apply_display(const color_transform *transform, float *rgb, size_t count, size_t *clipped) {
    return apply(transform, OCIO_TARGET_DISPLAY, rgb, count, clipped);
}

hemi_result color_transform_apply_rec709(const color_transform *transform, float *rgb, size_t count) {
    return ocio_view_apply(transform->view, OCIO_TARGET_REC709, rgb, count);
}
