/* SPDX-License-Identifier: MIT
 * Is a shooter too large, and how is it cut? All criteria by which shooters are subdivided, each into quarters:
 *
 *     of              method     criterion                                        source
 *     emitters        hybrid     the quarters disagree on what they see           [Baum89, sec. 5B]
 *     other patches   hybrid     it gives away more than its hemi-cube sees       [Baum89, eq. 10]
 *                                something stands on it, or hangs low over it     ours
 *     any patch       pr         its radiosity has a large gradient               [Cohen88; Baum89, sec. 4B]
 *                                an element-to-patch form factor is above 1       [Cohen88; Baum89, sec. 4B]
 *
 * Subpatches of the hybrid are in one column, and shoot the radiosity of the whole; those of pr are shooters of their
 * own. A cluster is not subdivided: where it would have to be, it is dissolved (column.crowded). What is near a shooter
 * needs no subdivision: there the closed form is taken (formfactor/near_distance.h).
 */
#ifndef HEMIBAKE_CORE_SOLVER_SUBDIVISION_H
#define HEMIBAKE_CORE_SOLVER_SUBDIVISION_H

#include "solver/shooters.h"

/* For column_setup.shoot: fills w->sum, the patches reached and w->statistics with what a shooter gives through one
 * hemi-cube or those of its quarters. */
void subdivision_shoot(column_worker *w, const subpatch *from);

/* Brightest minus darkest element over their mean. At 1 the edge of a shooter differs from its middle by half. The
 * paper gives no number; this one is ours. */
#define SUBDIVISION_GRADIENT 1.0

/* Quarterings of a patch by pr. */
enum { SUBDIVISION_DEPTH = 2 };

/* Can it be quartered once more? Not below the size of an element. */
bool subdivision_is_possible(const shooters *s, uint32_t index);

/* B[3*k+c]: of sample k of the shooter's patch. */
bool subdivision_by_gradient(const shooters *s, uint32_t index, const double *B);
bool subdivision_by_factor(const column *c);

/* Cuts a shooter into four shooters. radiosity[3*k+c]: of sample k of its patch; each quarter gets the share of the
 * unshot radiosity that its samples have of it. False when out of memory. */
bool subdivision_quarter(shooters *s, uint32_t index, const double *radiosity);

#endif
