/* SPDX-License-Identifier: MIT
 * Which light does a mesh show that stands in several places and may have only one? The mean over all of them.
 */
#ifndef HEMIBAKE_CLI_INSTANCE_MEAN_H
#define HEMIBAKE_CLI_INSTANCE_MEAN_H

#include "gltf_asset.h"

/* Gives views[i].radiance, where mesh i is the first of several with the same geometry, the mean of them all. means[i]
 * holds the numbers, malloc'ed, or is NULL. False without memory. */
bool instance_mean(const gltf_asset *asset, hemi_mesh_view *views, uint32_t count, float **means);

#endif
