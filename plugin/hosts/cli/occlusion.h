/* SPDX-License-Identifier: MIT
 * What is ambient occlusion? The share of an even sky that is seen from a surface, weighted by the cosine, where only
 * what is near stands in the way. It is what direct light alone makes of a scene that reflects half of a sky of
 * radiance 2.
 */
#ifndef HEMIBAKE_CLI_OCCLUSION_H
#define HEMIBAKE_CLI_OCCLUSION_H

#include "gltf_asset.h"
#include "options.h"

/* What --ao asks for besides, of options that are those of the command. */
void occlusion_options(options *o);

/* How far is near, unless the options say: a share of the diagonal of what is baked, m. */
double occlusion_distance(const gltf_asset *asset);

void occlusion_material(hemi_material_desc *material);

/* EXIT_DONE, or an exit status. */
int occlusion_sky(hemi_scene *scene);

#endif
