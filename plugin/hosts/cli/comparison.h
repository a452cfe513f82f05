/* SPDX-License-Identifier: MIT
 * How far is a bake from path-traced probes, or from another bake, and where?
 */
#ifndef HEMIBAKE_CLI_COMPARISON_H
#define HEMIBAKE_CLI_COMPARISON_H

#include "reference.h"

/* A bake that was read back, against the second input; prints to stdout, and draws the heatmap. */
int comparison_make(const gltf_asset *asset, const options *o, console *c);

/* Where it is off from what --reference names: values[0] is the error that is drawn lightest, then x, y, z, a unit
 * normal and the error of each point, as shares. values is from malloc. */
int comparison_points(const gltf_asset *asset, const options *o, console *c, float **values, size_t *count);

#endif
