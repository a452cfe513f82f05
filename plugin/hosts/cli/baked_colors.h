/* SPDX-License-Identifier: MIT
 * Which colours does the baked asset carry? Radiance through exposure and view transform, or, scene-linear, as it is.
 */
#ifndef HEMIBAKE_CLI_BAKED_COLORS_H
#define HEMIBAKE_CLI_BAKED_COLORS_H

#include "blackness.h"
#include "color_transform.h"
#include "console.h"
#include "gltf_asset.h"

typedef struct baked_colors {
    hemi_mesh_view *views; /* of each mesh; radiance is linear Rec.709, whatever space it was solved in */
    float **lights;        /* lights[mesh][3*(v+g*count)+c]: radiance by each group of lights, as that of views */
    float **radiance;      /* what views point to where that is another; else NULL */
    float **means;         /* light of meshes that share theirs (--keep-instances), or NULL */
    float **shown_means;   /* the same of light that multiplies a texture */
    float **colors;        /* colors[mesh][3*v+c]: linear values for COLOR_0, in [0,1]; where a texture stays on the
                              surface, of the light that it multiplies */
    float **seen;          /* the same with the means of textures in them; colors[mesh] itself where there are none */
    uint32_t mesh_count;
    double exposure_ev, clipped_fraction; /* of vertices */
    shut_in shut;
    blackness black;
} baked_colors;

/* Of the input of `from`, by what that lights it with; through the view of the transform, or under --scene-linear as
 * radiance in [0,1]. EXIT_DONE or an exit status with its line printed. */
int baked_colors_make(const hemi_solution *solution, const lights_from *from, const color_transform *transform,
                      const options *o, console *c, baked_colors *out);
void baked_colors_free(baked_colors *b);

/* A mesh of the asset as the bake has cut it. */
void baked_colors_mesh(const baked_colors *b, const gltf_asset *asset, uint32_t index, hemi_mesh_desc *out);

#endif
