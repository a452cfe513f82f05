/* SPDX-License-Identifier: MIT
 * Which meshes are denser than the light on them needs, and what stands in for them? A mesh with many triangles much
 * smaller than an element is solved on a simplified one (converters/simplify). Afterwards every vertex of the dense
 * mesh gets the light of the nearest point of the stand-in, so that the host reads back all that it gave.
 */
#ifndef HEMIBAKE_API_STAND_IN_H
#define HEMIBAKE_API_STAND_IN_H

#include "freeze.h"

/* Puts stand-ins into f->meshes for the meshes that need them. desc has been resolved. */
hemi_result stand_ins_make(const hemi_scene *in, const hemi_bake_desc *desc, frozen *f);

/* What was solved on the stand-in of a mesh becomes the dense mesh with the same light. Does nothing for others. Adds
 * to the statistics of stand-ins. */
hemi_result stand_in_give_back(const hemi_scene *in, const frozen *f, size_t mesh_index, solved_mesh *solved,
                               hemi_statistics *statistics);

/* Is a mesh of f->meshes a stand-in? */
bool stand_in_stands(const frozen *f, size_t mesh_index);

void stand_ins_free(frozen *f);

#endif
