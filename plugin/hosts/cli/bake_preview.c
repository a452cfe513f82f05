/* SPDX-License-Identifier: MIT
 * See bake_preview.h.
 */
#include "bake_preview.h"

#include "baked_glb.h"
#include "preview.h"

#include <stdlib.h>

int bake_preview(hemi_context *context, const gltf_asset *asset, const baked_colors *colors, const options *o,
                 console *c, unsigned char **bytes, size_t *size) {
    uint32_t count = colors->mesh_count;
    preview_mesh *meshes = calloc(count + 1, sizeof *meshes);
    hemi_mesh_desc *descs = calloc(count + 1, sizeof *descs);
    int status = meshes && descs ? EXIT_DONE : EXIT_BAD_INPUT;
    for (uint32_t i = 0; status == EXIT_DONE && i < count; i++) {
        const hemi_mesh_view *v = &colors->views[i];
        gltf_asset_mesh(asset, i, &descs[i]);
        if (baked_glb_hides(asset, o, i)) continue;
        meshes[i] = (preview_mesh){ v->positions,    colors->seen[i],   v->indices,
                                    v->vertex_count, v->triangle_count, descs[i].transform };
    }
    if (status == EXIT_DONE) status = preview_draw(context, asset, meshes, count, o, c, bytes, size);
    free(meshes);
    free(descs);
    return status;
}
