/* SPDX-License-Identifier: MIT
 * What do the rays of a row gather, all of them and by either half?
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROW_GATHER_H
#define HEMIBAKE_CORE_SOLVER_ROW_GATHER_H

#include "base/jobs.h"
#include "scene/contact_lines.h"
#include "solver/row_rays.h"

/* E[c]: irradiance of sample `corner` of element e from the sky, and from elements that reflect B[3*j+c]. */
void row_gather(const row_rays *r, const double *B, size_t e, int corner, double E[3]);

/* irradiance[3*s+c]: the same of all samples of element e, with the direct light there; reflected[c]: by the element.
 */
void row_gather_element(const row_rays *r, const double *B, size_t e, const double *direct, double *irradiance,
                        double reflected[3]);

/* half_difference[3*s+c] += half the difference between what either half of the rays of sample s gathers: an error like
 * that of the irradiance, of which it knows nothing else. False: out of memory, or those who share rows are lost. */
bool row_gather_halves(const row_rays *r, const double *B, jobs *j, double *half_difference);

/* *sum += the square of what element e reflects of an irradiance of samples, or of half_difference, integrated. */
void row_add_squares(const mesh *m, const double *irradiance, size_t e, double *sum);

/* Root mean square of that over that of the irradiance, both of what is reflected. */
double row_noise(const mesh *m, const double *irradiance, const double *half_difference);

/* What arrives on an element that lies in another surface is booked there. */
static inline bool row_gather_is_copy(const mesh *m, size_t e) {
    return mesh_patch_of(m, (uint32_t)e)->contact == CONTACT_COPY;
}

/* What arrives at fronts and stays there, of what samples have beyond before[3*s+c], NULL: beyond nothing; W. */
double row_gather_added(const mesh *m, const double *irradiance, const double *before);

/* Adds up what the sky brings to fronts, what these absorb, and what is lost of B[3*e+c], which element e reflects; W.
 * False: as above. */
bool row_gather_books(const row_rays *r, const double *irradiance, const double *B, jobs *j, double *sky_w,
                      double *absorbed_w, double *escaped_w);

#endif
