/* SPDX-License-Identifier: MIT
 * How much of an extended shooter does a receiver see, weighted by form factor, and how far off may that be?
 *
 *     fraction = F with blockers / F without,   F from the receiver to the shooter
 *
 * At a point both are exact: blockers are cut out of the shooter (visible_part.h) and the closed form is taken of what
 * is left. Over an element the exact values at points are integrated adaptively (shadow_integral.h), so all error is
 * that of the outer integral, whose integrand has kinks along the borders of umbra and penumbra and no jumps, except
 * along the foot of what stands on the receiver. Tried and left: hemi-cubes on n x n parts of the shooter, as column.c
 * does for speed: at a point in half shadow they are off by up to 0.4 / n, where this is exact.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_VISIBLE_FRACTION_H
#define HEMIBAKE_CORE_FORMFACTOR_VISIBLE_FRACTION_H

#include "geometry/polygon.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct visible_fraction {
    double fraction, error; /* 0 and 0 when the receiver would see nothing of an unblocked shooter; error: absolute */
    double factor, factor_error; /* F with blockers */
    double unoccluded;           /* F without */
    uint64_t evaluations;        /* receiving points */
    bool converged;              /* error <= tolerance */
} visible_fraction;

typedef struct visible_effort {
    double tolerance;          /* of the fraction */
    uint64_t evaluation_limit; /* receiving points; reached, it stops with what is there */
} visible_effort;

/* shooter: convex, planar, seen from its front; it and the receiver may lie on surfaces of the scene, which do not
 * block their own light. Surfaces block from both sides. False when out of memory. */
bool visible_fraction_at_point(const scene *s, const polygon *shooter, const double point[3], const double normal[3],
                               visible_fraction *out);

/* The same if nothing but count surfaces can stand between. */
bool visible_fraction_among(const scene *s, const uint32_t *surfaces, size_t count, const polygon *shooter,
                            const double point[3], const double normal[3], visible_fraction *out);

/* element: convex, planar; its front receives. The factor is its mean over the whole element. */
bool visible_fraction_of_element(const scene *s, const polygon *shooter, const polygon *element,
                                 const visible_effort *effort, visible_fraction *out);

#endif
