/* SPDX-License-Identifier: MIT
 * Which surfaces would reflect more than they may? Materials of reflectance 1, glTF's default, where nothing darkens
 * them, and elements that textures make as bright.
 */
#include "build_scene.h"

#include "base/block.h"

/* Marks materials that a mesh shows as they are. */
static void mark_plain(const bake_scene *f, bool *plain) {
    for (size_t i = 0; i < f->mesh_count; i++)
        if (f->meshes[i].triangle_count > 0 && !mesh_desc_is_textured(&f->meshes[i]))
            plain[f->meshes[i].material] = true;
}

void say_clamped(hemi_scene *in, bake_scene *f) {
    bool *plain = block_zeroed(f->memory.memory, in->material_count + 1, sizeof *plain);
    const char *first = NULL;
    f->clamped_materials = 0;
    if (!plain) return; /* it is only said */
    mark_plain(f, plain);
    for (size_t i = 0; i < in->material_count; i++) {
        if (!plain[i] || !in->materials[i].name) continue;
        if (f->clamped_materials++ == 0) first = in->materials[i].name;
    }
    block_free(plain);
    if (in->clamped_said) return;
    in->clamped_said = true;
    if (f->clamped_materials == 1)
        context_log(in->context, HEMI_LOG_WARNING, "material '%s': reflectance clamped to %g", first,
                    HEMI_REFLECTANCE_MAX);
    else if (f->clamped_materials > 1)
        context_log(in->context, HEMI_LOG_WARNING, "material '%s' and %u more: reflectance clamped to %g", first,
                    f->clamped_materials - 1, HEMI_REFLECTANCE_MAX);
    if (f->clamped_elements > 0)
        context_log(in->context, HEMI_LOG_WARNING, "textures: reflectance clamped to %g at %u of %zu elements",
                    HEMI_REFLECTANCE_MAX, f->clamped_elements, f->mesh.element_count);
}
