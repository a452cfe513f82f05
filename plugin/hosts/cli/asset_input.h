/* SPDX-License-Identifier: MIT
 * What does the command read before it works: an asset, or a stage of USD as one, with its textures?
 */
#ifndef HEMIBAKE_CLI_ASSET_INPUT_H
#define HEMIBAKE_CLI_ASSET_INPUT_H

#include "asset_colors.h"
#include "console.h"
#include "gltf_asset.h"
#include "usd_files.h"

/* as_read: o, and what a stage says itself. EXIT_DONE or an exit status with its line printed; either way usd and asset
 * are the caller's to close and destroy. */
int asset_input_read(const options *o, console *c, usd_files *usd, options *as_read, gltf_asset **asset);

/* An asset that is only looked at, within --root and with --scene. EXIT_DONE or an exit status with its line printed.
 */
int asset_input_open(const char *path, const options *o, console *c, gltf_asset **asset);

/* Its textures, in the space that is solved in, and what metals are taken as. */
int asset_input_textures(const options *o, const asset_colors *spaces, console *c, gltf_asset *asset);

#endif
