/* SPDX-License-Identifier: MIT
 * How far is a bake from path-traced probes, or from another bake, and where?
 */
#ifndef HEMIBAKE_CLI_COMPARISON_H
#define HEMIBAKE_CLI_COMPARISON_H

#include "reference.h"

/* A bake that was read back, against the second input; prints to stdout, and draws the heatmap. */
int comparison_make(const gltf_asset *asset, const options *o, console *c);

#endif
