/* SPDX-License-Identifier: MIT
 * Which lights without a surface are in the scene? Those of the asset, and what --sun and --environment add.
 */
#ifndef HEMIBAKE_CLI_ASSET_LIGHTS_H
#define HEMIBAKE_CLI_ASSET_LIGHTS_H

#include "asset_colors.h"
#include "light_names.h"

/* EXIT_DONE or an exit status with its line printed. */
int asset_lights_add(hemi_scene *scene, const gltf_asset *asset, const asset_colors *colors, const options *o,
                     light_names *groups, console *c);

/* Where nothing lights the scene, it may be for want of what was left out: names that. */
void asset_lights_name_lost(const gltf_asset *asset, console *c);

#endif
