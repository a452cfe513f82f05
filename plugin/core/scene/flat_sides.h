/* SPDX-License-Identifier: MIT
 * Which surfaces are one flat side of a thing, where does it end, and does the rest of the thing lie all on one side of
 * it? Then a thing can stand on it.
 *
 *        +--------+
 *       /|       /|     The lower side of a box is a foot: all that adjoins it lies behind it. A wall that goes on to
 *      +--------+ |     both sides, or has nothing at its edges, is none.
 *      | +------|-+
 *      |/       |/
 *      +--------+
 */
#ifndef HEMIBAKE_CORE_SCENE_FLAT_SIDES_H
#define HEMIBAKE_CORE_SCENE_FLAT_SIDES_H

#include "scene/scene.h"

/* The cosine between the normals of surfaces that lie in each other rather than cross (2.5 degrees). */
#define FLAT_SIDES_PARALLEL 0.999

typedef struct flat_sides {
    bool *ends; /* ends[4*i+k]: surface i does not go on in its plane past the edge from its corner k */
    uint32_t
        *side;    /* side[i]: the first surface of the flat side that surface i is in; of two twins the sheet has one */
    double *area; /* area[side[i]], m2 */
    double *outline; /* outline[side[i]]: length of the edges at which it ends, m */
    bool *
        open[2]; /* open[b][side[i]]: at some edge nothing adjoins it that lies behind it (b = 0), in front of it (1) */
} flat_sides;

/* places: of vertices. False when out of memory. */
bool flat_sides_find(const scene *s, const uint32_t *places, flat_sides *out);
void flat_sides_free(flat_sides *f);

/* Can a thing stand on the flat side that a sheet is in, with its front or its back down? */
static inline bool flat_sides_is_foot(const flat_sides *f, uint32_t sheet, bool front) {
    return !f->open[front ? 0 : 1][f->side[sheet]];
}

static inline double flat_sides_area(const flat_sides *f, uint32_t sheet) {
    return f->area[f->side[sheet]];
}

static inline double flat_sides_outline(const flat_sides *f, uint32_t sheet) {
    return f->outline[f->side[sheet]];
}

/* Between its two long edges, m: of a strip, however many edges each is made of, area over half the outline is hardly
 * less. */
static inline double flat_sides_width(const flat_sides *f, uint32_t sheet) {
    double outline = flat_sides_outline(f, sheet);
    return outline > 0.0 ? 2.0 * flat_sides_area(f, sheet) / outline : INFINITY;
}

#endif
