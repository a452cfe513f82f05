/* SPDX-License-Identifier: MIT
 * What is the form factor from a point to an emitter, past what stands between? Exact while few surfaces do: they are
 * cut out of the emitter (visibility/visible_part.h) and the closed form is taken of what is left. By rays to a grid of
 * the emitter's points where they are many or have holes.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_EMITTER_VISIBILITY_H
#define HEMIBAKE_CORE_FORMFACTOR_EMITTER_VISIBILITY_H

#include "geometry/polygon.h"
#include "scene/scene.h"

typedef struct emitter_visibility {
    const scene *scene;
    const uint32_t *candidates; /* surfaces that may hide emitters; NULL: any of the scene may */
    size_t candidate_count;
    uint32_t *blockers; /* room for as many as there are candidates */
} emitter_visibility;

/* Lists the surfaces that may hide an emitter from points in a ball; out: room for as many as the scene has. */
size_t emitter_visibility_candidates(const scene *s, const polygon *emitter, const double center[3], double radius,
                                     uint32_t *out);

/* How many surfaces may hide a part of an emitter from a point; lists them in sight->blockers. */
size_t emitter_visibility_list(const emitter_visibility *sight, const polygon *emitter, const double point[3]);

/* Has any of the first so many of sight->blockers holes? They are no polygons: what is past them is told by rays. */
bool emitter_visibility_has_holes(const emitter_visibility *sight, size_t blockers);

/* Does one of the first so many of sight->blockers hide all corners of an emitter from a point? Then it hides all of it,
 * since both are convex. */
bool emitter_visibility_is_behind_one(const emitter_visibility *sight, size_t blockers, const polygon *emitter,
                                      const double point[3]);

/* Are so many blockers few enough for emitter_visibility_factor to be exact? */
bool emitter_visibility_is_exact(const emitter_visibility *sight, size_t blockers);

/* emitter: a triangle or a convex quad whose front the point sees. False when out of memory. */
bool emitter_visibility_factor(const emitter_visibility *sight, const polygon *emitter, const double point[3],
                               const double normal[3], double *factor);

/* The same, exactly, if nothing but count surfaces can stand between; surfaces NULL: any of the scene. */
bool emitter_visibility_exact(const scene *s, const uint32_t *surfaces, size_t count, const polygon *emitter,
                              const double point[3], const double normal[3], double *factor);

#endif
