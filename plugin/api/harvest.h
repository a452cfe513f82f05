/* SPDX-License-Identifier: MIT
 * How does irradiance at samples become the meshes that a host reads? Fitted to vertices and cut to triangles.
 */
#ifndef HEMIBAKE_API_HARVEST_H
#define HEMIBAKE_API_HARVEST_H

#include "freeze.h"

#include "light/arrival.h"
#include "solver/progressive.h"

/* Fills out->meshes, and the statistics of vertices, triangles, of what the fit leaves over, and of how far what is
 * shown is from the radiosity equation. desc has been resolved. */
hemi_result harvest(const hemi_scene *in, const hemi_bake_desc *desc, const frozen *f, const arrival *arriving,
                    progressive_result *light, hemi_solution *out);

#endif
