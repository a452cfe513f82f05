/* SPDX-License-Identifier: MIT
 * Whose lights light an asset? Its own, or with --lights-from those of another asset of the same geometry: its punctual
 * lights, its sky, and what its materials emit, mesh by mesh. Shapes, reflectances and all else that is written are the
 * input's.
 *
 * Two meshes are one where each corner of each triangle lies in the same place, to within a share of the size of the
 * input that leaves room for packed positions; names and numbers do not count.
 */
#ifndef HEMIBAKE_CLI_LIGHTS_FROM_H
#define HEMIBAKE_CLI_LIGHTS_FROM_H

#include "asset_input.h"

typedef struct lights_from {
    const gltf_asset *input, *asset; /* asset: whose lights they are, the input itself where no other is named */
    gltf_asset *other;               /* NULL: there is none */
    uint32_t *mesh_of;               /* mesh_of[i]: of the other asset, which is mesh i of the input */
    usd_files usd;
    struct mixed_texture *textures;   /* of meshes of the input that have one */
    struct mixed_material *materials; /* of the scene, beyond those of the input */
    uint32_t *first_material;         /* first_material[m]: of those that mix material m of the input */
    uint32_t material_count;
} lights_from;

/* Reads the asset that o names and finds its meshes in the input; the textures of both are read then. as_read: the sky
 * of the other asset takes the place of that of a stage. EXIT_DONE or an exit status with its line printed; either way
 * l is to be closed. */
int lights_from_open(lights_from *l, const options *o, const gltf_asset *input, const asset_colors *colors,
                     options *as_read, console *c);
void lights_from_close(lights_from *l);

/* Does mesh i of the input emit? *of: the mesh of l->asset that says so. */
bool lights_from_emits(const lights_from *l, uint32_t mesh, uint32_t *of);

/* What its material emits, without pictures; all 0: nothing. */
void lights_from_emission(const lights_from *l, uint32_t mesh, double emission[3]);

/* Has a mesh of the input, as the input says it, emit what the other asset says, by a material of the scene that is
 * added if there is none like it. Without another asset it stays as it is. */
hemi_result lights_from_set(lights_from *l, const asset_colors *colors, uint32_t mesh, hemi_scene *scene, console *c,
                            hemi_mesh_desc *desc);

#endif
