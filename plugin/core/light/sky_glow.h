/* SPDX-License-Identifier: MIT
 * From which directions does what is bright in a panorama come, and how densely are they drawn? Windows, softboxes and
 * lamps of a room are too wide for suns (sky_suns.h) and too small for rays by the cosine: one in fifty meets a
 * softbox. The sphere is cut into cells, rows and columns as a panorama's are; those far brighter than the mean are
 * drawn from by how bright they are, row first, then column, by inversion [Pharr, Humphreys, Physically Based
 * Rendering, 14.2.4].
 */
#ifndef HEMIBAKE_CORE_LIGHT_SKY_GLOW_H
#define HEMIBAKE_CORE_LIGHT_SKY_GLOW_H

#include "light/sky.h"

enum { SKY_GLOW_ROWS = 128, SKY_GLOW_COLUMNS = 256 };

typedef struct sky_glow {
    double rows[SKY_GLOW_ROWS + 1];                      /* what is drawn of the rows before one */
    double columns[SKY_GLOW_ROWS][SKY_GLOW_COLUMNS + 1]; /* the same of a row's columns */
    double pdf[SKY_GLOW_ROWS][SKY_GLOW_COLUMNS];         /* per steradian; 0: not bright */
} sky_glow;

/* *out: a block; NULL where nothing of it is bright. False when out of memory. */
bool sky_glow_find(allocator *memory, const sky_image *image, sky_glow **out);

/* A unit direction for a point of the unit square, and how densely such directions lie. */
void sky_glow_direction(const sky_glow *g, const double point[2], double out[3]);
double sky_glow_pdf(const sky_glow *g, const double direction[3]);

#endif
