/* SPDX-License-Identifier: MIT
 * Which surfaces are one flat face? Neighbours with common vertices that lie in one plane and over which every
 * attribute is affine: what the input cut them to is not needed.
 */
#ifndef HEMIBAKE_API_FLAT_FACES_H
#define HEMIBAKE_API_FLAT_FACES_H

#include "build_scene.h"

/* first[s]: the first surface of the face that surface s is a part of. False when out of memory. */
bool flat_faces_join(const bake_scene *f, uint32_t *first);

#endif
