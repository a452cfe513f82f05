/* SPDX-License-Identifier: MIT
 * Which OpenColorIO processors bring colours into the space that is solved in, and out of it to a display? C border of
 * the two files that see OpenColorIO; no exception passes it. Private to this folder. It also makes the transforms and
 * inputs of color_transform.h and color_input.h.
 */
#ifndef HEMIBAKE_COLOR_OCIO_SHIM_H
#define HEMIBAKE_COLOR_OCIO_SHIM_H

#include "color_input.h"
#include "color_transform.h"

HEMI_C_BEGIN

/* Code values of the display; these decoded from sRGB to linear; or, without a view, scene-linear Rec.709. */
typedef enum ocio_target { OCIO_TARGET_DISPLAY, OCIO_TARGET_LINEAR, OCIO_TARGET_REC709, OCIO_TARGET_COUNT } ocio_target;

/* rgb[3*i+c] finite; in place. HEMI_ERROR_UNSUPPORTED: the configuration has no way to Rec.709. */
hemi_result ocio_apply(const color_transform *transform, ocio_target target, float *rgb, size_t count);
hemi_result ocio_input_apply(const color_input *input, float *rgb, size_t count);

HEMI_C_END
#endif
