/* SPDX-License-Identifier: MIT
 * How does irradiance at samples become the meshes that a host reads? Fitted to vertices and cut to triangles.
 */
#ifndef HEMIBAKE_API_OUTPUT_MESH_H
#define HEMIBAKE_API_OUTPUT_MESH_H

#include "build_scene.h"

#include "light/direct_light.h"
#include "solver/progressive.h"

/* Fills out->meshes, and the statistics of vertices, triangles, of what the fit leaves over, and of how far what is
 * shown is from the radiosity equation. desc has been resolved. */
hemi_result output_mesh(const hemi_scene *in, const hemi_bake_desc *desc, const bake_scene *f,
                        const direct_light *arriving, progressive_result *light, hemi_solution *out);

#endif
