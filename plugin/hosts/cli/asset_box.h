/* SPDX-License-Identifier: MIT
 * How large is what an asset shows, and where is its middle?
 */
#ifndef HEMIBAKE_CLI_ASSET_BOX_H
#define HEMIBAKE_CLI_ASSET_BOX_H

#include "gltf_asset.h"

/* Of all meshes but backdrops, world, m. Returns the diagonal; 0 where nothing is. */
double asset_box(const gltf_asset *asset, double middle[3]);

#endif
