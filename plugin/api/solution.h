/* SPDX-License-Identifier: MIT
 * What does a bake say of itself?
 */
#ifndef HEMIBAKE_API_SOLUTION_H
#define HEMIBAKE_API_SOLUTION_H

#include "build_scene.h"

#include "bake/bake.h"

/* Fills the statistics, the curve and the shooters of a solution whose meshes are there. HEMI_ERROR_MEMORY. */
hemi_result statistics_fill(const bake_setup *setup, const bake_scene *f, const bake_result *found, hemi_solution *out);

#endif
