/* SPDX-License-Identifier: MIT
 * By which area are the sizes of patches and elements chosen?
 */
#ifndef HEMIBAKE_API_LIT_SCENE_H
#define HEMIBAKE_API_LIT_SCENE_H

#include "build_scene.h"

/* Of f->meshes, m2: what light can reach (lit_area.h), or all if it reaches nothing; 0 where there is no area. Negative
 * when out of memory. */
double lit_scene_area(const hemi_scene *in, const bake_scene *f, const lights *l);

#endif
