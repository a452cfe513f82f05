/* SPDX-License-Identifier: MIT
 * Which surfaces are one flat face? Neighbours with common vertices that lie in one plane and over which every
 * attribute is affine: what the input divided them to is not needed.
 */
#ifndef HEMIBAKE_CORE_MESH_FLAT_FACES_H
#define HEMIBAKE_CORE_MESH_FLAT_FACES_H

#include "mesh/mesh_vertices.h"
#include "scene/scene.h"

/* first[s]: the first surface of the face that surface s is a part of. The scene's neighbours are known; sources: of
 * each of its meshes. False when out of memory. */
bool flat_faces_join(const scene *s, const mesh_vertices *vertices, const source_mesh *sources, uint32_t *first);

#endif
