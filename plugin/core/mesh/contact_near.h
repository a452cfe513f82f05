/* SPDX-License-Identifier: MIT
 * Which contact lines run by a patch, and which of these by one of its elements? Others are not looked at: a patch in a
 * tangle has thousands, each of its elements a few.
 */
#ifndef HEMIBAKE_CORE_MESH_CONTACT_NEAR_H
#define HEMIBAKE_CORE_MESH_CONTACT_NEAR_H

#include "scene/contact_lines.h"

typedef struct contact_near {
    const contact_line **patch, **element; /* longest first */
    size_t patch_count, element_count;
    double corner[4][3], low[3], high[3]; /* of the element, and the box of it and of what is beside it */
    int corner_count;
} contact_near;

/* With room for the lines of any surface. False when out of memory. */
bool contact_near_open(allocator *memory, const contact_lines *lines, size_t surface_count, contact_near *out);
void contact_near_close(contact_near *n);

/* Those of a surface that run by a patch of it, in these corners or no further from their box than this share of its
 * diagonal. */
void contact_near_patch(contact_near *n, const contact_lines *lines, uint32_t sheet, const double (*corner)[3],
                        int count, double share);

/* The same of these by an element; returns the diagonal. */
double contact_near_element(contact_near *n, const double (*corner)[3], int count, double share);

/* Does any other line run by the element? */
bool contact_near_has(const contact_near *n, const contact_line *l);

/* How many of those by the element run through it. */
size_t contact_near_through(const contact_near *n, const double normal[3]);

/* Is an edge of it along one whose gap is less than this, no further from it than reach? */
bool contact_near_has_edge(const contact_near *n, const double from[3], const double to[3], double gap, double reach);

#endif
