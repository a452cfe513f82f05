/* SPDX-License-Identifier: MIT
 * What do rays of rows hit on their way through panes (visibility/panes.h), and what leaves by the other side of a
 * sheet? A ray that crosses panes hits several elements, each with what the panes before it transmit of the light:
 *
 *     E_s += 1/N sum over crossings k of T_k B_k,     T_k = product of the transmittance of the panes before k
 *
 * Such terms are kept beside the one element that a ray has elsewhere.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_PANES_H
#define HEMIBAKE_CORE_SOLVER_ROW_PANES_H

#include "visibility/panes.h"

/* A term of a row: an element that a ray hits past panes, or what panes transmit of the sky for it. */
typedef struct row_pane_term {
    uint32_t ray, element; /* ray: its number in the row; element NO_INDEX: the sky */
    float T[3];
} row_pane_term;

typedef struct row_pane_terms {
    row_pane_term *all;
    size_t count, capacity;
} row_pane_terms;

typedef struct row_panes {
    const scene *scene;
    const mesh *mesh, *hit;    /* hit: whose elements panes are, and rays meet */
    row_pane_terms *of_sample; /* of_sample[s]; NULL: there are no panes */
    uint32_t *other_side; /* other_side[s]: the sample on the other side of a sheet that transmits diffusely, NO_INDEX
                             elsewhere; NULL: nothing does */
    atomic_bool failed;   /* out of memory */
} row_panes;

/* Of the samples of a mesh, past panes of the elements of hit. The other sides of sheets are looked for where the two
 * are one: parts of elements need not be divided alike on both. False when out of memory. */
bool row_panes_create(const scene *s, const mesh *m, const mesh *hit, row_panes *out);
void row_panes_free(row_panes *p);

/* What a ray hits at its end. */
typedef enum row_pane_end { ROW_PANE_ELEMENT, ROW_PANE_SKY, ROW_PANE_BACK } row_pane_end;

/* A ray of a sample that goes from a point along a direction and ends at a distance. Adds the terms of the panes that
 * it crosses; true where they transmit less than all of the light: then its end is a term too. */
bool row_panes_trace(row_panes *p, pane_crossings *scratch, size_t sample, uint32_t ray, const double from[3],
                     const double direction[3], double distance, row_pane_end end, uint32_t element);

/* Forgets the terms of a sample's rays from a number on. */
void row_panes_truncate(row_panes *p, size_t sample, uint32_t first_ray);

/* What a ray brings of what elements have each, luminance[e]. */
double row_panes_luminance(const row_panes *p, size_t sample, uint32_t ray, const double *luminance);

/* T of a ray that hit the sky; rays are asked for in their order, *cursor begins as 0. */
void row_panes_sky(const row_panes *p, size_t sample, uint32_t ray, size_t *cursor, double T[3]);

/* E[c] += what the terms from begin to end bring, each with the weight of its ray; B[3*e+c] of element e. */
void row_panes_gather(const row_pane_term *begin, const row_pane_term *end, const float *weight, const double *B,
                      double E[3]);

/* The same of all terms of a sample, if there are any. */
void row_panes_gather_all(const row_panes *p, size_t sample, const float *weight, const double *B, double E[3]);

/* What an element reflects more by what comes to its other side: rho E -> (rho - tau) E + tau E_other,
 * tau the diffuse transmittance. */
void row_panes_reflect(const row_panes *p, size_t element_index, const double *irradiance, double B[3]);

/* Makes the irradiance of samples on such sheets what their reflectance has to be multiplied with. False when out of
 * memory. */
bool row_panes_combine_sides(const row_panes *p, double *irradiance);

#endif
