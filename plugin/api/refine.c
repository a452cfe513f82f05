/* SPDX-License-Identifier: MIT
 * Which meshes are control cages? Those that name a subdivision scheme; what is baked is their limit surface.
 */
#include "freeze.h"

#include <stdlib.h>

hemi_result freeze_refine(const hemi_scene *in, frozen *f) {
    f->mesh_count = in->mesh_count;
    f->meshes = calloc(in->mesh_count + 1, sizeof *f->meshes);
    f->refined = calloc(in->mesh_count + 1, sizeof *f->refined);
    if (!f->meshes || !f->refined) return HEMI_ERROR_MEMORY;
    for (size_t i = 0; i < in->mesh_count; i++) f->meshes[i] = in->meshes[i].desc;
    return HEMI_OK;
}
