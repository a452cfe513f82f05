/* SPDX-License-Identifier: MIT */
#include "panorama_decode.h"

#include "exr_decode.h"
#include "pfm_decode.h"

_Static_assert(PANORAMA_NOTE_SIZE >= EXR_NOTE_SIZE, "what is said of an OpenEXR picture has room");

hemi_result panorama_decode(const uint8_t *bytes, size_t size, hdr_image *out, char note[PANORAMA_NOTE_SIZE],
                            char message[IMAGE_MESSAGE_SIZE]) {
    note[0] = message[0] = 0;
    if (exr_is_it(bytes, size)) return exr_decode(bytes, size, out, note, message);
    if (pfm_is_it(bytes, size)) return pfm_decode(bytes, size, out, message);
    return hdr_decode(bytes, size, out, message);
}
