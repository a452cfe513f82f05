/* SPDX-License-Identifier: MIT
 * Which meshes, colours and radiance go into the asset that a bake writes? As glTF, or as what USD is made of.
 */
#ifndef HEMIBAKE_CLI_BAKED_GLB_H
#define HEMIBAKE_CLI_BAKED_GLB_H

#include "baked_colors.h"
#include "light_names.h"

typedef struct baked_glb {
    const options *o;
    const gltf_asset *asset;
    const baked_colors *colors;
    const char *bin_path; /* NULL: one .glb */
    const char *extras;   /* what asset.extras.hemibake says */
    bool for_usd;         /* plain floats, and what is seen instead of what a texture is multiplied by */
    bool is_stage;        /* the input is one: its lights go */
    const light_names *groups;
} baked_glb;

/* Is it a lamp's body, which is not shown unless --keep-lamps? */
bool baked_glb_hides(const gltf_asset *asset, const options *o, uint32_t mesh);

/* An exit status, with its line printed. */
int baked_glb_make(const baked_glb *glb, console *c, gltf_output *out);

#endif
