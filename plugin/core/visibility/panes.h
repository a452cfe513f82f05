/* SPDX-License-Identifier: MIT
 * Through which surfaces does light pass between two points, and what is left of it? Panes are surfaces that let light
 * straight through, wholly or in part: glass, and what covers less than all of its outline. Nothing that asks what
 * blocks light knows them (occlusion.h, item buffers, rays); what they take from it is a product over those that a path
 * crosses, in any order:
 *
 *     T = product over crossed panes of transmittance     per rgb band
 *
 * Each element of a pane has a transmittance of its own, so that pictures count element by element.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_PANES_H
#define HEMIBAKE_CORE_VISIBILITY_PANES_H

#include "mesh/mesh.h"

typedef struct panes panes;

/* Marks the surfaces that are panes (surface.pane), by the materials of their elements; how many. */
size_t panes_mark(scene *s, const mesh *m);

/* Of surfaces that are marked; keeps nothing of the mesh. NULL when out of memory. */
panes *panes_create(const scene *s, const mesh *m);
void panes_destroy(panes *p); /* NULL is fine */

typedef struct pane_crossing {
    double t;                    /* share of the way */
    const double *transmittance; /* of the three bands */
    uint32_t element;            /* of the mesh of panes_create, whose front is crossed; NO_INDEX: a back without one */
    const double *normal;
    bool on_edge;
} pane_crossing;

/* Memory of one thread. */
typedef struct pane_crossings {
    pane_crossing *all;
    size_t count, capacity;
} pane_crossings;

/* Lists what a path crosses from one point to another, the nearest first; own: the sheet (surface_sheet) that it begins
 * on. False when out of memory. */
bool panes_list(const panes *p, uint32_t own, const double from[3], const double to[3], pane_crossings *out);

/* T of the path. False when out of memory. */
bool panes_transmit(const panes *p, uint32_t own, const double from[3], const double to[3], pane_crossings *scratch,
                    double T[3]);

/* The mean of T over what a point of a surface sees of a polygon that shines on it; weighted by cosines and distance,
 * past what blocks. False when out of memory. */
bool panes_transmit_polygon(const panes *p, uint32_t surface_index, const polygon *shape, const double point[3],
                            pane_crossings *scratch, double T[3]);

#endif
