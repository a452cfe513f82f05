/* SPDX-License-Identifier: MIT
 * What does a viewer multiply the colours of a surface by? The base colour's factor and picture, as linear rgb, at the
 * level whose texels are as large as what is looked at.
 */
#include "gltf_guarded.h"
#include "gltf_texture.h"

#include <algorithm>
#include <cmath>

/* One picture serves all meshes of a material; white where it cannot be read. */
static gltf_sampler read_shown(gltf_asset &asset, const gltf_instance &instance) {
    const tinygltf::Material &material = gltf_find_material(asset, instance.material);
    return gltf_read_sampler(asset, *instance.geometry, gltf_diffuse_texture(material), texel_color);
}

hemi_result gltf_asset_read_shown(gltf_asset *asset, char message[GLTF_MESSAGE_SIZE]) {
    return gltf_guarded(message, "read the images", "the images cannot be read", [&] {
        if (!asset->shadings) asset->shadings = std::make_unique<gltf_shadings>();
        for (const gltf_instance &instance : asset->instances)
            asset->shadings->shown.push_back(read_shown(*asset, instance));
        for (const gltf_instance &instance : asset->instances)
            asset->shadings->shown_mask.push_back(gltf_read_shown_mask(*asset, *instance.geometry, instance.material));
        gltf_gather_notes(*asset);
    });
}

const hemi_alpha_mask *gltf_asset_mesh_mask(const gltf_asset *asset, uint32_t mesh) {
    return asset->shadings && mesh < asset->shadings->shown_mask.size() ? asset->shadings->shown_mask[mesh] : nullptr;
}

void gltf_asset_mesh_shown(const gltf_asset *asset, uint32_t mesh, const uint32_t corner[3], const double weights[3],
                           double share, float rgb[3]) {
    if (mesh >= asset->instances.size()) return;
    const gltf_instance &instance = asset->instances[mesh];
    const tinygltf::Material &material = gltf_find_material(*asset, instance.material);
    for (size_t c = 0; c < 3; c++) rgb[c] *= float(std::clamp(gltf_base_factor(material, c), 0.0, 1.0));
    if (!asset->shadings || mesh >= asset->shadings->shown.size() || !asset->shadings->shown[mesh].mips) return;
    const gltf_sampler &sampler = asset->shadings->shown[mesh];
    const gltf_geometry &geometry = *instance.geometry;
    double uv[3][2], at[2] = { 0, 0 };
    for (size_t i = 0; i < 3; i++) {
        const float *from = &geometry.attributes[size_t(corner[i]) * geometry.attribute_count + sampler.attribute];
        for (size_t k = 0; k < 2; k++)
            uv[i][k] = sampler.row[k][0] * double(from[0]) + sampler.row[k][1] * double(from[1]) + sampler.row[k][2];
        for (size_t k = 0; k < 2; k++) at[k] += weights[i] * uv[i][k];
    }
    double area =
        0.5 * std::fabs((uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]));
    const float *texel = gltf_texel(sampler, gltf_level_for(sampler, area * share), at);
    for (size_t c = 0; c < 3; c++) rgb[c] *= texel[c];
}
