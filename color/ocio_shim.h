/* SPDX-License-Identifier: MIT
 * Which OpenColorIO processors bring colours into the space that is solved in, and out of it to a display? C border of
 * the one file that sees OpenColorIO; no exception passes it. Private to this folder; what the functions promise is in
 * color_transform.h and color_input.h.
 */
#ifndef HEMIBAKE_COLOR_OCIO_SHIM_H
#define HEMIBAKE_COLOR_OCIO_SHIM_H

#include "color_input.h"
#include "color_transform.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ocio_view ocio_view;
typedef struct ocio_input ocio_input;

/* Code values of the display; these decoded from sRGB to linear; or, without a view, scene-linear Rec.709. */
typedef enum ocio_target { OCIO_TARGET_DISPLAY, OCIO_TARGET_LINEAR, OCIO_TARGET_REC709, OCIO_TARGET_COUNT } ocio_target;

typedef enum ocio_view_part {
    OCIO_VIEW_CONFIG,
    OCIO_VIEW_DISPLAY,
    OCIO_VIEW_VIEW,
    OCIO_VIEW_LOOK,
    OCIO_VIEW_WORKING_SPACE,
    OCIO_VIEW_PART_COUNT
} ocio_view_part;

hemi_result ocio_view_create(const color_transform_desc *desc, ocio_view **out, char message[COLOR_MESSAGE_SIZE]);
void ocio_view_destroy(ocio_view *view);
const char *ocio_view_name(const ocio_view *view, ocio_view_part part);

/* What a transform stands on; color_transform.c has it. */
const ocio_view *color_transform_shim(const color_transform *transform);

/* rgb[3*i+c] finite; in place. HEMI_ERROR_UNSUPPORTED: the configuration has no way to Rec.709. */
hemi_result ocio_view_apply(const ocio_view *view, ocio_target target, float *rgb, size_t count);

/* An input may outlive its view. */
hemi_result ocio_input_create(const ocio_view *view, const color_input_desc *desc, ocio_input **out,
                              char message[COLOR_MESSAGE_SIZE]);
void ocio_input_destroy(ocio_input *input);
const char *ocio_input_space(const ocio_input *input);
bool ocio_input_is_identity(const ocio_input *input);
hemi_result ocio_input_apply(const ocio_input *input, float *rgb, size_t count);

#ifdef __cplusplus
}
#endif
#endif
