/* SPDX-License-Identifier: MIT
 * Along which lines of a surface do others stand on it, cross it, or end on it? On one side of such a line there is
 * light and on the other often none, since it is inside of something or under it [Baum91].
 */
#ifndef HEMIBAKE_CORE_SCENE_CONTACT_LINES_H
#define HEMIBAKE_CORE_SCENE_CONTACT_LINES_H

#include "base/deadline.h"
#include "base/jobs.h"
#include "scene/contact_line.h"
#include "scene/flat_sides.h"

/* A surface that lies in the plane of another or hangs over it, on its front or, where the height is negative, on its
 * back. Height 0: up to rounding. */
typedef struct contact_cover {
    uint32_t surface; /* a sheet */
    float height;     /* m */
} contact_cover;

/* Heights, m, of what hangs over a surface under which light fades along lines of its own, and goes to and fro. */
typedef struct contact_gaps {
    double least, most;
    double parts; /* m: what hangs no higher parts what is on either side of it; 0: only what nearly touches does */
    double parts_width, parts_outline; /* m: but only if it is no wider than this, and as long around as that */
} contact_gaps;

typedef struct contact_lines {
    contact_line *lines;
    size_t *first; /* lines[first[s]] to lines[first[s+1]-1] are those of surface s; of two twins the sheet has them */
    size_t count;
    contact_cover *covers;
    size_t *first_cover; /* the same of covers */
    size_t cover_count;
    flat_sides sides;
    double hidden; /* m: what hangs lower hides what is under it */
} contact_lines;

/* What is around a point on the front of a surface, of two twins either? */
typedef enum contact_kind {
    CONTACT_OPEN,
    CONTACT_COPY,   /* it lies in a surface that faces the same way, and others see that one (scene_shows_before) */
    CONTACT_HIDDEN, /* something hangs over it, lower than light fades under it: contact_gaps */
    CONTACT_FOOT    /* a thing stands on it, in the plane of something larger: no light gets there */
} contact_kind;

contact_kind contact_lines_kind(const scene *s, const contact_lines *l, uint32_t surface_index, const double point[3]);

/* Of all surfaces, which have been measured; longest first. Those that no worker came to in time have none. Jobs may be
 * NULL. False when out of memory. */
bool contact_lines_find(const scene *s, const contact_gaps *gaps, const deadline *latest, jobs *j, contact_lines *out);
void contact_lines_free(contact_lines *l);

#endif
