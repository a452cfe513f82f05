/* SPDX-License-Identifier: MIT
 * Where is a bake off? Its meshes in false colour, black where it is right and light where it is off.
 */
#ifndef HEMIBAKE_CLI_HEATMAP_H
#define HEMIBAKE_CLI_HEATMAP_H

#include "console.h"
#include "gltf_asset.h"
#include "match.h"

/* Draws meshes[i], which is mesh of_asset[i] of the asset, into the file of --heatmap. *full: the error that is drawn
 * lightest, a share of what is there. EXIT_DONE or an exit status with its line printed. */
int heatmap_write(const gltf_asset *asset, const match_mesh *meshes, const uint32_t *of_asset, size_t count,
                  const probe_set *probes, const match_result *match, const options *o, console *c, double *full);

#endif
