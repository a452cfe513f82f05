/* SPDX-License-Identifier: MIT
 * What of a line lies inside an outline, and along which lines does light fade under what hangs over a surface?
 */
#ifndef HEMIBAKE_CORE_SCENE_CONTACT_LINE_H
#define HEMIBAKE_CORE_SCENE_CONTACT_LINE_H

#include <stdbool.h>

/* Both ends lie in the plane of the surface, and inside its outline. Light may come through under what only hangs over
 * it: gap is how far that is from the surface, m, at least; INFINITY: light goes on across the line as if it were not
 * there. */
typedef struct contact_line {
    double from[3], to[3], gap;
} contact_line;

/* A flat convex outline, counter-clockwise around a normal. */
typedef struct contact_outline {
    const double (*corner)[3];
    const bool *ends; /* ends[k]: what it is of ends at the edge from corner k */
    const double *normal;
    int count;
} contact_outline;

enum { CONTACT_FADES = 2, CONTACT_FADES_MAX = 4 * CONTACT_FADES };

/* The part of a line, from *low to *high of its length, that is inside a convex outline, counter-clockwise around the
 * normal; false if none is. */
bool contact_line_clip(const contact_line *line, const double (*corner)[3], int count, const double normal[3],
                       double *low, double *high);

/* Between two surfaces that are a gap apart, m, light from outside fades within a few gaps from where one of them ends.
 * The lines beside the ends of one outline, as far as they are inside the other, which is seen along its own normal, in
 * the plane of the former; returns how many. */
int contact_line_fades(const contact_outline *of, const contact_outline *other, double gap,
                       contact_line out[CONTACT_FADES_MAX]);

#endif
