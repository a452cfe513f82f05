/* SPDX-License-Identifier: MIT
 * What does a bake look like that has no file yet?
 */
#ifndef HEMIBAKE_CLI_BAKE_PREVIEW_H
#define HEMIBAKE_CLI_BAKE_PREVIEW_H

#include "baked_colors.h"
#include "console.h"

/* The picture that --preview asks for, which is what preview_draw_asset draws of what the bake writes; bytes from
 * malloc. EXIT_DONE or an exit status with its line printed. */
int bake_preview(hemi_context *context, const gltf_asset *asset, const baked_colors *colors, const options *o,
                 console *c, unsigned char **bytes, size_t *size);

/* The same in false colour: where the estimated error lies (hemi_mesh_view.errors, which are there). *full: the error
 * that is drawn lightest, which 95 of 100 vertices stay below. */
int bake_preview_errors(hemi_context *context, const gltf_asset *asset, const baked_colors *colors, const options *o,
                        console *c, unsigned char **bytes, size_t *size, double *full);

/* The same of the asset as it came, without its light: colours of materials, darker where they face away. */
int bake_preview_before(hemi_context *context, const gltf_asset *asset, const options *o, console *c,
                        unsigned char **bytes, size_t *size);

#endif
