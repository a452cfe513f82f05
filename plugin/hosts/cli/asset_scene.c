/* SPDX-License-Identifier: MIT
 * See asset_scene.h.
 */
#include "asset_scene.h"

#include "asset_lights.h"

#include <string.h>

static hemi_result add_materials(hemi_scene *scene, const gltf_asset *asset, const asset_colors *colors, console *c) {
    hemi_result result = HEMI_OK;
    for (uint32_t i = 0; result == HEMI_OK && i < gltf_asset_material_count(asset); i++) {
        hemi_material_desc material;
        result = asset_colors_material(colors, asset, i, c, &material);
        if (result == HEMI_OK) result = hemi_scene_add_material(scene, &material, NULL);
    }
    return result;
}

/* What an asset asks for itself goes before what is asked for all; --subdivide 0 takes every mesh as it is. Either way
 * the asset says which polygons the triangles were. */
static void set_subdivision(hemi_mesh_desc *mesh, const options *o, hemi_subdivision_desc *own) {
    const hemi_subdivision_desc *asked = mesh->subdivision;
    if (o->subdivide < 0) mesh->subdivision = NULL;
    if (o->subdivide <= 0 || (asked && asked->scheme != HEMI_SUBDIVISION_NONE)) return;
    *own = asked ? *asked : (hemi_subdivision_desc){ .struct_size = sizeof *own };
    own->scheme = (hemi_subdivision_scheme)o->subdivision;
    own->level = (uint32_t)o->subdivide;
    own->tessellation = o->subdivide_adaptive ? HEMI_TESSELLATION_ADAPTIVE : HEMI_TESSELLATION_UNIFORM;
    mesh->subdivision = own;
}

static hemi_result add_meshes(hemi_scene *scene, const gltf_asset *asset, const options *o) {
    hemi_result result = HEMI_OK;
    for (uint32_t i = 0; result == HEMI_OK && i < gltf_asset_mesh_count(asset); i++) {
        hemi_mesh_desc mesh;
        hemi_subdivision_desc subdivision;
        gltf_asset_mesh(asset, i, &mesh);
        gltf_asset_texture(asset, i, &mesh);
        if (gltf_asset_mesh_is_unlit(asset, i)) mesh.triangle_count = 0;
        set_subdivision(&mesh, o, &subdivision);
        result = hemi_scene_add_mesh(scene, &mesh, NULL);
    }
    return result;
}

static bool any_lit(const gltf_asset *asset) {
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++)
        if (!gltf_asset_mesh_is_unlit(asset, i)) return true;
    return false;
}

int asset_scene_create(hemi_context *context, const gltf_asset *asset, const asset_colors *colors, const options *o,
                       console *c, hemi_scene **out) {
    for (size_t i = 0; i < gltf_asset_skipped_count(asset); i++) console_note(c, "%s", gltf_asset_skipped(asset, i));
    if (!any_lit(asset)) {
        const char *first = NULL;
        for (size_t i = 0; !first && i < gltf_asset_skipped_count(asset); i++)
            if (strstr(gltf_asset_skipped(asset, i), "not baked")) first = gltf_asset_skipped(asset, i);
        console_error(c, "it has no triangles that can be baked: %s", first ? first : "its scene shows no mesh");
        return EXIT_BAD_INPUT;
    }
    hemi_result result = hemi_scene_create(context, out);
    if (result == HEMI_OK) result = add_materials(*out, asset, colors, c);
    if (result == HEMI_OK) result = add_meshes(*out, asset, o);
    if (result == HEMI_ERROR_MEMORY) console_error(c, "out of memory");
    return result == HEMI_OK ? asset_lights_add(*out, asset, colors, o, c) : EXIT_BAD_INPUT;
}
