/* SPDX-License-Identifier: MIT
 * Which meshes lie in the place of an earlier one, corner for corner? Exporters write a primitive once for each of its
 * materials. The first is what others see and what is solved; the copies get the light that arrives there, and make of
 * it what their own materials do. Cages and what is cut out are taken as they are.
 */
#ifndef HEMIBAKE_API_DUPLICATE_MESHES_H
#define HEMIBAKE_API_DUPLICATE_MESHES_H

#include "build_scene.h"

/* Sets f->copy_of, and leaves copies without triangles. False when out of memory. */
bool duplicate_meshes_find(const hemi_scene *in, bake_scene *f);

#endif
