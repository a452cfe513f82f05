/* SPDX-License-Identifier: MIT
 * Which meshes are levels of detail that are seen from afar only? They stand where the nearest level does, so they
 * would block its light; what arrives there is what they show.
 */
#ifndef HEMIBAKE_API_DETAIL_LEVELS_H
#define HEMIBAKE_API_DETAIL_LEVELS_H

#include "build_scene.h"

#include "reconstruct/vertex_colors.h"

/* Leaves the levels but the nearest without triangles; one whose group has no nearest level stays a mesh as any. False
 * when out of memory. */
bool detail_levels_find(bake_scene *f);

/* Makes the mesh of a level that was left out. HEMI_ERROR_MEMORY. */
hemi_result detail_levels_output(const hemi_scene *in, const bake_scene *f, const vertex_colors *colors,
                                 const double *errors, size_t index, solved_mesh *out);

#endif
