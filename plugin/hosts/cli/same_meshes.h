/* SPDX-License-Identifier: MIT
 * Which mesh of one asset is which of another? Those whose triangles lie in the same place, corner by corner.
 */
#ifndef HEMIBAKE_CLI_SAME_MESHES_H
#define HEMIBAKE_CLI_SAME_MESHES_H

#include "gltf_asset.h"

typedef struct same_meshes {
    bool has_stranger; /* a mesh of either has no counterpart ... */
    bool stranger_is_of_first;
    uint32_t stranger; /* ... the first of the first asset, else of the second */
} same_meshes;

/* mesh_of[i]: of the second asset, which is mesh i of the first; from malloc, NULL when out of memory. apart: how far
 * corners may be from each other along each axis, m. Of several in one place the one of the same name, else the first.
 */
uint32_t *same_meshes_find(const gltf_asset *first, const gltf_asset *second, double apart, same_meshes *out);

/* Have two meshes that are one the same attributes at each corner? */
bool same_attributes(const hemi_mesh_desc *a, const hemi_mesh_desc *b);

#endif
