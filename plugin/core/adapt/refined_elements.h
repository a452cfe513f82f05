/* SPDX-License-Identifier: MIT
 * Which coarse elements have fine ones, and how exactly must these know what they receive?
 */
#ifndef HEMIBAKE_CORE_ADAPT_REFINED_ELEMENTS_H
#define HEMIBAKE_CORE_ADAPT_REFINED_ELEMENTS_H

#include "formfactor/column.h"

/* Where a fine element lies on its coarse one, in reference coordinates (mesh/triangulation.h): its corner 0 and the
 * length of its edges; negative where it is turned by half a turn. */
typedef struct fine_place {
    uint32_t coarse; /* element */
    float u, v, size;
} fine_place;

/* Weights of the coarse element's samples, linear between and beyond them, at sample k of a fine one of its kind. */
void fine_place_weights(const fine_place *place, int corners, int k, double w[4]);

/* A coarse element that has fine ones. */
typedef struct refined_element {
    uint32_t coarse, first_fine, first_sample, sample_count; /* samples: of the fine mesh */
    double size;                                             /* of an edge, m */
    double irradiance;                                       /* what it is taken to be, all bands */
    bool in_contact;                                         /* something stands on the surface at one of its corners */
    column_receiver receiver;
} refined_element;

typedef struct refined_elements {
    refined_element *all;
    size_t count;
} refined_elements;

/* irradiance[3*s+c] and row_sum[s] (sum of form factors) of the coarse samples; places: of the fine elements, those of
 * one coarse element beside each other. False when out of memory. */
bool refined_elements_find(const mesh *coarse, const double *irradiance, const double *row_sum, const mesh *fine,
                           const fine_place *places, refined_elements *out);
void refined_elements_free(refined_elements *e);

#endif
