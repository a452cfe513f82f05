/* SPDX-License-Identifier: MIT
 * How bright is the scene, and by how much must it be scaled to show?
 *
 *     EV = log2( 0.18 / L ),   L = exp2( mean over area of log2 luminance )
 *
 * The area-weighted geometric mean is what a photographer's average reading is, and the key value of [Reinhard02];
 * middle grey is 18 % there too. Two things would spoil it and are kept out:
 *   - surfaces that see no light (outsides, sealed boxes; log2 of 0): points more than 12 stops below the
 *     luminance that 5 % of the lit area exceeds (not below the mean, which one lamp can move);
 *   - lamps and what they graze: the brightest and the darkest 5 % of the area that is left.
 * Emitting surfaces should not be passed in at all, or with weight 0.
 */
#ifndef HEMIBAKE_COLOR_EXPOSURE_H
#define HEMIBAKE_COLOR_EXPOSURE_H

#include <stddef.h>

#define EXPOSURE_MIDDLE_GREY 0.18

/* Twelve stops under the bright parts nothing shows on an 8-bit display (2^-12 of white is 0.8 of its first code). */
#define EXPOSURE_DARK_STOPS 12

/* Of the area, trimmed off each end: twice the share that lamps and their halos take in a furnished room. */
#define EXPOSURE_TRIM 0.05

/* EV stays within +-this: from a sunlit desert in nits (-17) to starlight in W/m2/sr is less. */
#define EXPOSURE_EV_MAX 24.0

/* radiance[3*i+c], linear Rec.709; weights[i] >= 0: the area that point i stands for, or NULL: all alike. Points that
 * are not finite or have no weight are passed over. 0 if there is no light to meter. Sums run in index order. */
double exposure_meter(const float *radiance, const float *weights, size_t count);

/* rgb[3*i+c] times 2^ev, in place. */
void exposure_apply(float *rgb, size_t count, double ev);

#endif
