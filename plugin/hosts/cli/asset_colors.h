/* SPDX-License-Identifier: MIT
 * Which spaces do an asset's colours come from, are added up in, and go to? What --ocio and the options beside it ask
 * for, looked at before any work is done.
 */
#ifndef HEMIBAKE_CLI_ASSET_COLORS_H
#define HEMIBAKE_CLI_ASSET_COLORS_H

#include "color_input.h"
#include "console.h"
#include "gltf_asset.h"

typedef struct asset_colors {
    color_transform *transform; /* out: working space to display */
    color_input *factors;       /* in: colour factors to working space */
    const char *input_space;    /* of --input-space, or NULL */
} asset_colors;

/* The configuration is that of --ocio, else of $OCIO, else the one inside. EXIT_DONE or an exit status with its line
 * printed. */
int asset_colors_load(const options *o, console *c, asset_colors *out);
void asset_colors_free(asset_colors *colors);

/* A material of the asset in the working space; notes what that space cannot hold. */
hemi_result asset_colors_material(const asset_colors *colors, const gltf_asset *asset, uint32_t material, console *c,
                                  hemi_material_desc *out);

/* A light's colour times its intensity (intensity: the largest band) in the working space. */
hemi_result asset_colors_light(const asset_colors *colors, double intensity, double rgb[3]);

/* The pixels of a panorama, rgb[3*i+c], in the working space. They are linear, as colour factors are. */
hemi_result asset_colors_panorama(const asset_colors *colors, float *rgb, size_t count);

/* A gltf_convert_fn; user is the asset_colors. */
hemi_result asset_colors_convert(void *user, bool texels, const char *file, float *rgb, size_t count);

#endif
