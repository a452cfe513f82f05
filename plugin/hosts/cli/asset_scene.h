/* SPDX-License-Identifier: MIT
 * How does an asset get into a scene? Material by material, mesh by mesh, in order: mesh i of the asset is mesh i of
 * the scene.
 */
#ifndef HEMIBAKE_CLI_ASSET_SCENE_H
#define HEMIBAKE_CLI_ASSET_SCENE_H

#include "asset_colors.h"
#include "console.h"
#include "gltf_asset.h"
#include "light_names.h"
#include "lights_from.h"

/* from: whose lights light it; groups: of these, if they are asked for. EXIT_DONE and *out, or an exit status with its
 * line printed. */
int asset_scene_create(hemi_context *context, lights_from *from, const asset_colors *colors, const options *o,
                       light_names *groups, console *c, hemi_scene **out);

/* Of so many seconds, so many of which are over, what a bake may take so that the asset is written by then, about; 0
 * stays. */
double asset_scene_time_left(const gltf_asset *asset, double limit_s, double spent_s, double read_s);

#endif
