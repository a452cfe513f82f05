/* SPDX-License-Identifier: MIT
 * What are an asset's colours in the space that is solved in?
 *
 *     factor or texel -> [its curve undone] -> primaries converted -> linear, working space
 *
 * Without a space glTF's own rule holds: factors are linear Rec.709, colour textures are sRGB. One input is made for
 * the factors of an asset and one for each of its images; all of them may be applied from many threads.
 */
#ifndef HEMIBAKE_COLOR_COLOR_INPUT_H
#define HEMIBAKE_COLOR_COLOR_INPUT_H

#include "color_transform.h"

HEMI_C_BEGIN

/* As a space: the file rules of the configuration choose one by the file's name. */
#define COLOR_INPUT_FILE_RULES "file-rules"

typedef enum color_origin { COLOR_ORIGIN_FACTOR, COLOR_ORIGIN_TEXTURE } color_origin;

typedef struct color_input_desc {
    color_origin origin;
    const char *space; /* of the configuration: name, alias or role; COLOR_INPUT_FILE_RULES; NULL: glTF's rule */
    const char *file;  /* for file rules: the image's, or the asset's for factors; may be NULL */
} color_input_desc;

typedef struct color_input color_input;

/* HEMI_ERROR_ARGUMENT: there is no such space; HEMI_ERROR_DATA: the configuration does not know Rec.709 and desc names
 * no space; as color_transform_create otherwise. message gets one line then; *out is NULL. */
hemi_result color_input_create(const color_transform *transform, const color_input_desc *desc, color_input **out,
                               char message[COLOR_MESSAGE_SIZE]);
void color_input_destroy(color_input *input); /* NULL is fine */

/* The space that was chosen; valid as long as the input. */
const char *color_input_space(const color_input *input);

/* Colours come out as they go in, bit for bit: whoever has them in double need not round them to float. */
bool color_input_is_identity(const color_input *input);

/* rgb[3*i+c], in place. A colour outside the working space's primaries has a negative band, which no surface can
 * reflect or emit: the band becomes 0. A colour that is not finite becomes black. *outside (may be NULL) is how many of
 * either there were. HEMI_ERROR_BACKEND: OpenColorIO failed; rgb is then undefined. */
hemi_result color_input_apply(const color_input *input, float *rgb, size_t count, size_t *outside);

HEMI_C_END
#endif
