/* SPDX-License-Identifier: MIT
 * What are an asset's colours in the space that is solved in? Keeps what OpenColorIO gives back possible as light. */
#include "color_input.h"

#include "ocio_shim.h"

#include <math.h>

/* A matrix to other primaries and back leaves a zero this far off: three products of floats. */
static const float ROUNDING = 1e-6f;

/* A colour with a band that is not finite becomes black; true if it did. */
static bool make_finite(float rgb[3]) {
    if (isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2])) return false;
    rgb[0] = rgb[1] = rgb[2] = 0.0f;
    return true;
}

/* Negative bands become 0; true if one was more than rounding. */
static bool make_positive(float rgb[3]) {
    float largest = fmaxf(fabsf(rgb[0]), fmaxf(fabsf(rgb[1]), fabsf(rgb[2])));
    bool outside = false;
    for (int c = 0; c < 3; c++) {
        outside = outside || rgb[c] < -ROUNDING * largest;
        rgb[c] = fmaxf(rgb[c], 0.0f);
    }
    return outside;
}

hemi_result color_input_apply(const color_input *input, float *rgb, size_t count, size_t *outside) {
    size_t found = 0;
    for (size_t i = 0; i < count; i++) found += make_finite(rgb + 3 * i);
    hemi_result result = ocio_input_apply(input, rgb, count);
    for (size_t i = 0; i < count; i++) found += make_finite(rgb + 3 * i) || make_positive(rgb + 3 * i);
    if (outside) *outside = found;
    return result;
}
