/* SPDX-License-Identifier: MIT
 * Which channels of an OpenEXR picture are its colour? R, G and B without a layer's name, else Y, else those of the
 * first layer, of the first part that has such and is not deep.
 */
#ifndef HEMIBAKE_IMAGE_EXR_CHANNELS_H
#define HEMIBAKE_IMAGE_EXR_CHANNELS_H

#include "image_decode.h"

#include <openexr.h>

typedef struct exr_channels {
    int part, channel[3]; /* all the same one where there is Y alone */
    size_t layer_length;  /* of the name of channel[0]: as far as its last dot; 0: no layer */
    int choices;          /* sets of colours in the file */
    bool has_deep, has_chroma;
} exr_channels;

/* *out: empty before. HEMI_ERROR_UNSUPPORTED: deep, or luminance and chroma; HEMI_ERROR_DATA: no colour. */
hemi_result exr_channels_choose(exr_const_context_t file, exr_channels *out, char message[IMAGE_MESSAGE_SIZE]);

#endif
