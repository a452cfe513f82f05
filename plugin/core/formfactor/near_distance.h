/* SPDX-License-Identifier: MIT
 * How far must a receiver be from a shooter for the hemi-cube's form factor to be good enough? The computation behind
 * [Baum89, fig. 4]: a square shooter, a hemi-cube on its centre, and a small element seen through one of three pixels
 * in one of three orientations. The hemi-cube's factor (the limit of eq. 7 and 8 for small pixels)
 *
 *     F = cos_e cos_s A_s / (pi r^2)
 *
 * takes the whole shooter to be at its centre; the true one is eq. 9. Distances are in diameters, by which the paper
 * means the edge of the square: with it the worst case falls below 2.5 % at five diameters, as the paper says.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_NEAR_DISTANCE_H
#define HEMIBAKE_CORE_FORMFACTOR_NEAR_DISTANCE_H

/* The middle of the top, its corner, and the middle of the lowest row of a side. */
typedef enum near_distance_pixel {
    NEAR_DISTANCE_CENTER,
    NEAR_DISTANCE_CORNER,
    NEAR_DISTANCE_SIDE,
    NEAR_DISTANCE_PIXEL_COUNT
} near_distance_pixel;

/* The element faces the shooter's plane, is at a right angle to it, or faces the shooter's centre. */
typedef enum near_distance_normal {
    NEAR_DISTANCE_PARALLEL,
    NEAR_DISTANCE_PERPENDICULAR,
    NEAR_DISTANCE_RADIAL,
    NEAR_DISTANCE_NORMAL_COUNT
} near_distance_normal;

/* (hemi-cube - true) / true at a distance in diameters. Straight above the centre and at a right angle the hemi-cube
 * sees the element edge-on, its factor is 0 at any distance, and the error -1. */
double near_distance_error(near_distance_pixel pixel, near_distance_normal normal, double distance);

/* The distance in diameters beyond which |error| <= bound in every geometry but that one. bound > 0. */
double near_distance(double bound);

#endif
