/* SPDX-License-Identifier: MIT
 * What is the form factor from a point to a lamp, past what stands between? Exact while few surfaces do
 * (visible_fraction.h), by rays to a grid of the lamp's points where they are many or
 * have holes.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_LAMP_SIGHT_H
#define HEMIBAKE_CORE_FORMFACTOR_LAMP_SIGHT_H

#include "formfactor/polygon.h"
#include "scene/scene.h"

typedef struct lamp_sight {
    const scene *scene;
    const uint32_t *candidates; /* surfaces that may hide lamps; NULL: any of the scene may */
    size_t candidate_count;
    uint32_t *blockers; /* room for as many as there are candidates */
} lamp_sight;

/* Lists the surfaces that may hide a lamp from points in a ball; out: room for as many as the scene has. */
size_t lamp_sight_candidates(const scene *s, const polygon *lamp, const double center[3], double radius, uint32_t *out);

/* How many surfaces may hide a part of a lamp from a point; lists them in sight->blockers. */
size_t lamp_sight_list(const lamp_sight *sight, const polygon *lamp, const double point[3]);

/* Has any of the first so many of sight->blockers holes? They are no polygons: what is past them is told by rays. */
bool lamp_sight_has_holes(const lamp_sight *sight, size_t blockers);

/* lamp: a triangle or a convex quad whose front the point sees. False when out of memory. */
bool lamp_sight_factor(const lamp_sight *sight, const polygon *lamp, const double point[3], const double normal[3],
                       double *factor);

#endif
