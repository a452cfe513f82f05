/* SPDX-License-Identifier: MIT
 * What will a viewer show? Vertex colours drawn from a camera, encoded to sRGB, as PNG bytes.
 */
#ifndef HEMIBAKE_CLI_PREVIEW_H
#define HEMIBAKE_CLI_PREVIEW_H

#include "console.h"
#include "gltf_asset.h"

typedef struct preview_mesh {
    hemi_mesh_desc shape;        /* its positions, indices and transform count; without any it is not shown */
    const float *colors;         /* colors[3*v+c], linear; NULL: white */
    const hemi_alpha_mask *mask; /* what is cut out of it, or NULL; its coordinates are among the asset's attributes */
    const hemi_mesh_view *view;  /* of a bake: where its vertices are on the asset's mesh; NULL: they are its own */
    const uint32_t *corners;     /* corners[3*t+k]: of the asset's mesh, where each triangle has vertices of its own */
    float glow[3];               /* linear; with textures: no darker than this is shown, whatever they multiply */
} preview_mesh;

/* Is the camera that --camera asks for in the asset? EXIT_DONE or an exit status with its line printed. */
int preview_check_camera(const gltf_asset *asset, const options *o, console *c);

/* shows_textures: meshes are those of the asset, and are shown with the pictures of their materials
 * (gltf_asset_read_shown). bytes is from malloc. EXIT_DONE or an exit status with its line printed. */
int preview_draw(hemi_context *context, const gltf_asset *asset, const preview_mesh *meshes, size_t count,
                 bool shows_textures, const options *o, console *c, unsigned char **bytes, size_t *size);

/* The same of a whole asset: its own vertex colours times the pictures of its materials. */
int preview_draw_asset(hemi_context *context, const gltf_asset *asset, const options *o, console *c,
                       unsigned char **bytes, size_t *size);

#endif
