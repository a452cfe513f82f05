/* SPDX-License-Identifier: MIT
 * How bright is a measured lamp in each direction? Reads photometric files of IES LM-63 (1986 to 2019) and samples them
 * on an even grid of directions, with the angles between those of the file interpolated, symmetries unfolded, and
 * nothing where nothing was measured.
 *
 *     intensity in direction (theta, phi), candela, at [row * columns + column]:
 *     theta = pi row / (rows - 1) from where the lamp aims, phi = 2 pi column / columns about it
 *
 * Type C has phi as its horizontal angle. Of types A and B, whose two angles are up and aside of the aim, phi 0 is up
 * and a quarter turn is to the left, seen along the aim.
 */
#ifndef HEMIBAKE_IES_PROFILE_H
#define HEMIBAKE_IES_PROFILE_H

#include <hemibake/hemibake.h>

HEMI_C_BEGIN

#define IES_MESSAGE_SIZE 160

typedef struct ies_profile {
    uint32_t rows, columns; /* columns: 1 where the lamp is the same all round */
    float *candela;         /* of malloc */
} ies_profile;

/* bytes need no zero at their end. HEMI_ERROR_DATA: message says what is wrong and where, in one line. */
hemi_result ies_profile_read(const uint8_t *bytes, size_t size, ies_profile *out, char message[IES_MESSAGE_SIZE]);
void ies_profile_free(ies_profile *profile); /* NULL and empty are fine */

HEMI_C_END

#endif
