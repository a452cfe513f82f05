/* SPDX-License-Identifier: MIT
 * Which pixels does a KTX2 file hold, as they are or supercompressed (Basis Universal, Zstandard)? (libktx, where the
 * build found it)
 */
#ifndef HEMIBAKE_IMAGE_KTX2_DECODE_H
#define HEMIBAKE_IMAGE_KTX2_DECODE_H

#include "image_decode.h"

/* As image_decode. HEMI_ERROR_UNSUPPORTED: it is whole, but no picture of eight bits in rgb or rgba. */
hemi_result ktx2_decode(const uint8_t *bytes, size_t size, uint64_t most, image_pixels *out,
                        char message[IMAGE_MESSAGE_SIZE]);

#endif
