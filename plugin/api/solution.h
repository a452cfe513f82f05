/* SPDX-License-Identifier: MIT
 * What does a bake say of itself?
 */
#ifndef HEMIBAKE_API_SOLUTION_H
#define HEMIBAKE_API_SOLUTION_H

#include "build_scene.h"

#include "bake/bake.h"

/* What a desc asks for, NULL for all defaults; a code, with a line to the context's log, where there is no such thing.
 * As the core takes it; and a method of the core as hosts call it. In desc_size.c. */
hemi_result bake_desc_take(const hemi_context *context, const hemi_bake_desc *given, hemi_bake_desc *out);
bake_options bake_desc_options(const hemi_bake_desc *desc);
hemi_method bake_desc_method(solver_method method);

/* Fills the statistics, the curve and the shooters of a solution whose meshes are there. HEMI_ERROR_MEMORY. */
hemi_result statistics_fill(const bake_setup *setup, const bake_scene *f, const bake_result *found, hemi_solution *out);

#endif
