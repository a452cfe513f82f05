/* SPDX-License-Identifier: MIT
 * Which OpenColorIO processors make a display and view? C border of the one file that sees OpenColorIO; no exception
 * passes it. Private to this folder; what the functions promise is in color_transform.h.
 */
#ifndef HEMIBAKE_COLOR_OCIO_SHIM_H
#define HEMIBAKE_COLOR_OCIO_SHIM_H

#include "color_transform.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ocio_view ocio_view;

/* Code values of the display, or these decoded from sRGB to linear. */
typedef enum ocio_target { OCIO_TARGET_DISPLAY, OCIO_TARGET_LINEAR, OCIO_TARGET_COUNT } ocio_target;

typedef enum ocio_view_part {
    OCIO_VIEW_CONFIG,
    OCIO_VIEW_DISPLAY,
    OCIO_VIEW_VIEW,
    OCIO_VIEW_LOOK,
    OCIO_VIEW_SOURCE,
    OCIO_VIEW_PART_COUNT
} ocio_view_part;

hemi_result ocio_view_create(const color_transform_desc *desc, ocio_view **out, char message[COLOR_MESSAGE_SIZE]);
void ocio_view_destroy(ocio_view *view);
const char *ocio_view_name(const ocio_view *view, ocio_view_part part);

/* rgb[3*i+c] finite; in place. */
hemi_result ocio_view_apply(const ocio_view *view, ocio_target target, float *rgb, size_t count);

#ifdef __cplusplus
}
#endif
#endif
