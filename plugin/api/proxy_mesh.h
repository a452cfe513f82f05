/* SPDX-License-Identifier: MIT
 * Which meshes are denser than the light on them needs, and what are they solved on? A mesh with many triangles much
 * smaller than an element is solved on a simplified one (converters/simplify). Afterwards every vertex of the dense
 * mesh gets the light of the nearest point of the proxy, so that the host reads back all that it gave.
 */
#ifndef HEMIBAKE_API_PROXY_MESH_H
#define HEMIBAKE_API_PROXY_MESH_H

#include "build_scene.h"

/* Puts proxies into f->meshes for the meshes that need them. desc has been resolved. */
hemi_result proxy_meshes_make(const hemi_scene *in, const bake_options *options, bake_scene *f);

/* What was solved on the proxy of a mesh becomes the dense mesh with the same light. Does nothing for others. Adds
 * to the statistics of proxies. */
hemi_result proxy_mesh_transfer(const hemi_scene *in, const bake_scene *f, size_t mesh_index, solved_mesh *solved,
                                hemi_statistics *statistics);

/* How many shooters triangles are where elements and patches have these sizes, proxies in the place of what is dense. */
size_t proxy_meshes_shooter_count(const bake_scene *f, double element_size, double patch_size);

/* Is a mesh of f->meshes a proxy? */
bool proxy_mesh_is_used(const bake_scene *f, size_t mesh_index);

void proxy_meshes_free(bake_scene *f);

#endif
