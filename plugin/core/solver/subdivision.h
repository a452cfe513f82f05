/* SPDX-License-Identifier: MIT
 * Is a shooter too large? The two criteria of the original progressive refinement [Cohen88], as [Baum89, sec. 4B] tells
 * them: "a large intensity gradient across the patch", and an element-to-patch form factor above 1. The paper gives no
 * number for the first; SUBDIVISION_GRADIENT is ours.
 */
#ifndef HEMIBAKE_CORE_SOLVER_SUBDIVISION_H
#define HEMIBAKE_CORE_SOLVER_SUBDIVISION_H

#include "solver/shooters.h"

/* Brightest minus darkest element over their mean. At 1 the edge of a shooter differs from its middle by half. */
#define SUBDIVISION_GRADIENT 1.0

/* Quarterings of a patch. */
enum { SUBDIVISION_DEPTH = 2 };

/* Can it be quartered once more? Not below the size of an element. */
bool subdivision_is_possible(const shooters *s, uint32_t index);

/* B[3*k+c]: of sample k of the shooter's patch. */
bool subdivision_by_gradient(const shooters *s, uint32_t index, const double *B);
bool subdivision_by_factor(const column *c);

#endif
