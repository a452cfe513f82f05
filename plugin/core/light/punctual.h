/* SPDX-License-Identifier: MIT
 * How much light does a point, spot or directional light give a surface that sees it?
 *
 *     point         E = I cos / r^2
 *     spot          the same, times how far the direction is inside the cone
 *     directional   E = I cos; from a disc of directions if it has an angular diameter, as the sun has
 */
#ifndef HEMIBAKE_CORE_LIGHT_PUNCTUAL_H
#define HEMIBAKE_CORE_LIGHT_PUNCTUAL_H

#include <stdbool.h>
#include <stdint.h>

typedef enum punctual_kind { PUNCTUAL_POINT, PUNCTUAL_SPOT, PUNCTUAL_DIRECTIONAL } punctual_kind;

typedef struct punctual {
    punctual_kind kind;
    double intensity[3];         /* W/sr; directional: W/m2 on what faces it */
    double position[3];          /* not of a directional light */
    double direction[3];         /* unit, the way its light travels; not of a point light */
    double cos_inner, cos_outer; /* of a spot: full inside the one, nothing outside the other */
    double range;                /* m, where its light is faded out; 0: none */
    double angular_diameter;     /* radians, of a directional light; 0: one direction */
    const float *profile;        /* of a point light: what its intensity is multiplied by in each direction; NULL: 1 */
    uint32_t profile_rows, profile_columns; /* at [columns*row+column]: pi row / (rows - 1) from direction, ... */
    double aside[2][3]; /* ... 2 pi column / columns from aside[0] towards aside[1], unit, square to direction */
} punctual;

/* Sets aside of a light whose direction is set, from where the columns of its profile begin. */
void punctual_set_aside(punctual *light, const double axis[3]);

/* Irradiance of a small surface (unit normal), about a square so wide, m, that sees the light: of a spot's cone the
 * mean over it, since a cone narrower than elements would else be met by few samples or none. toward: unit, to the
 * light of a directional one (punctual_toward); ignored otherwise. False: none, since the light is behind, out of its
 * cone or out of range. */
bool punctual_irradiance(const punctual *light, const double toward[3], const double point[3], double width,
                         const double normal[3], double E[3]);

/* How many directions stand for a directional light, of so many that a disc has. */
int punctual_directions(const punctual *light, int of_disc);

/* Direction k of count, unit, to a directional light; equal shares of its disc, on a spiral of golden angles. */
void punctual_toward(const punctual *light, int k, int count, double toward[3]);

#endif
