/* SPDX-License-Identifier: MIT
 * Along which lines of a surface do others stand on it, cross it, or end on it? On one side of such a line there is
 * light and on the other often none, since it is inside of something or under it [Baum91].
 */
#ifndef HEMIBAKE_CORE_SCENE_CONTACT_LINES_H
#define HEMIBAKE_CORE_SCENE_CONTACT_LINES_H

#include "scene/scene.h"

/* Both ends lie in the plane of the surface, and inside its outline. */
typedef struct contact_line {
    double from[3], to[3];
} contact_line;

typedef struct contact_lines {
    contact_line *lines;
    size_t *first; /* lines[first[s]] to lines[first[s+1]-1] are those of surface s; of two twins the sheet has them */
    size_t count;
} contact_lines;

/* Of all surfaces, which have been measured; longest first. False when out of memory. */
bool contact_lines_find(const scene *s, contact_lines *out);
void contact_lines_free(contact_lines *l);

/* The part of a line, from *low to *high of its length, that is inside a convex outline, counter-clockwise around the
 * normal; false if none is. */
bool contact_line_clip(const contact_line *line, const double (*corner)[3], int count, const double normal[3],
                       double *low, double *high);

#endif
