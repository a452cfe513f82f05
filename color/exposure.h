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
 *
 * A mean alone burns what is much brighter than the rest. Of points that are known to be seen, from several places
 * (seen_points.h), EV is the mean over the places of what each asks for, but no more than any place bears:
 *
 *     2^EV x (the luminance that all but 1.5 % stay below) <= white,
 *     2^EV x (the light that all but 5 % stay below) <= white,
 *     2^EV x (median luminance) <= 0.4,
 *
 * white being what the view shows as all but white (color_transform_white): 1 where it clips, more where it rolls
 * highlights off. Light is what a colour carries where a texture multiplies it. Where that leaves the middle of all
 * places darker than code value 39 of 255 the bound on light gives way; then, for the middle of the area that is seen,
 * all give way but that no more than 1.5 % of it burns; and below code value 24 that one too.
 */
#ifndef HEMIBAKE_COLOR_EXPOSURE_H
#define HEMIBAKE_COLOR_EXPOSURE_H

#include "seen_points.h"

#include <stddef.h>

#define EXPOSURE_MIDDLE_GREY 0.18

/* Twelve stops under the bright parts nothing shows on an 8-bit display (2^-12 of white is 0.8 of its first code). */
#define EXPOSURE_DARK_STOPS 12

/* Of the area, trimmed off each end: twice the share that lamps and their halos take in a furnished room. */
#define EXPOSURE_TRIM 0.05

/* EV stays within +-this: from a sunlit desert in nits (-17) to starlight in W/m2/sr is less. */
#define EXPOSURE_EV_MAX 24.0

/* Of what is seen and does not emit, the shares that may be burnt to white: of what is shown, and of light that a
 * texture makes darker again, where all that is lost is shape. */
#define EXPOSURE_BURNT       0.015
#define EXPOSURE_BURNT_LIGHT 0.05

/* Luminances between which the median comes to lie: code values 24, 39 and 170 of 255. */
#define EXPOSURE_MEDIAN_MIN 0.0085
#define EXPOSURE_MEDIAN_DIM 0.02
#define EXPOSURE_MEDIAN_MAX 0.4

/* EV for points that are seen, shown by a view whose white is given. What emits counts only where nothing else has
 * light; what is not finite or has no weight is passed over. 0 if there is no light. Sums run in index order. */
double exposure_meter(const seen_point *points, size_t count, double white);

/* rgb[3*i+c] times 2^ev, in place. */
void exposure_apply(float *rgb, size_t count, double ev);

#endif
